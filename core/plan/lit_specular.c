#include "plan/lit_specular.h"

#include "base/sobol.h"
#include "light/direct.h"
#include "light/path.h"
#include "scene/geometry/placed.h"
#include "scene/material/bounds.h"

enum { MOST_RAYS = 1 << 18, MOST_SAMPLES = 256, LEAST_SAMPLES = 8, MOST_PANES = 64 };
enum { WINDOW_SAMPLES = 1024, IMAGE_SAMPLES = 64, MOST_PLACES = 4096 };

/* Limit of facets times lights; beyond it the search would take seconds. */
static const double most_pairs = 2e5;

struct look {
    const struct orl_world *world;
    struct orl_lit *lit;
    struct orl_sobol sobol;
    const struct orl_crew *crew; /* polled for cancellation */
    uint32_t samples;            /* per side of a facet */
};

static bool is_kind(enum orl_surface_kind shape, const struct orl_material *m,
                    enum orl_lit_kind kind)
{
    const bool flat = !m->texture && orl_surface_kind_is_flat(shape);
    const bool bends = orl_material_bends(m);
    if (kind == ORL_LIT_LOBE)
        return orl_material_has_lobes(m);
    if (kind == ORL_LIT_CURVED)
        return bends || (!flat && orl_material_is_mirror(m));
    return flat && !bends && orl_material_is_mirror(m);
}

/* Returns the share of light at 60 degrees that a side sends on in other directions than
 * straight. */
static double share_sent_on(const struct orl_material *m, bool front, enum orl_lit_kind kind)
{
    if (kind == ORL_LIT_CURVED && orl_material_bends(m))
        return 1;
    return kind == ORL_LIT_LOBE || m->kind == ORL_MATERIAL_BSDF
               ? orl_material_lobes_most(m, front, 0.5)
               : orl_material_mirrored_most(m, front, 0.5);
}

/* Returns true if a lit point of that side matters: in a sealed scene, points outside do not. */
static bool point_matters(const struct look *look, uint32_t facet, bool front,
                          struct orl_vec3 point, enum orl_lit_kind kind)
{
    const struct orl_world *world = look->world;
    const int32_t port = orl_world_port_of(world, facet);
    if (world->open)
        return true;
    if (port == ORL_NO_PORT)
        return !orl_world_is_outside(world, point);
    if (front != world->ports[port].outside_is_front)
        return true;
    const struct orl_material *const m =
        &world->materials[orl_facet_material(world->geometry, facet)];
    return (kind == ORL_LIT_LOBE && orl_material_transmits_lobes(m)) ||
           (kind == ORL_LIT_CURVED && orl_material_bends(m));
}

static bool is_lit(const struct look *look, uint32_t facet, bool front, enum orl_lit_kind kind)
{
    const struct orl_geometry *g = look->world->geometry;
    for (uint32_t i = 0; i < look->samples && !orl_crew_cancelled(look->crew); i++) {
        struct orl_random random = orl_random_stream(facet, ORL_PURPOSE_PILOT, i);
        struct orl_direct_query query = {.through_ports = true};
        struct orl_vec3 point, normal;
        double u[2];
        orl_sobol_point(&look->sobol, i, facet, 2, u);
        orl_facet_sample(g, facet, u, &point, &normal);
        query.normal = front ? normal : orl_neg(normal);
        query.point = orl_facet_leave(g, facet, point, normal, query.normal);
        if (orl_rgb_max(orl_direct_light(look->world, &query, &random)) > 0 &&
            point_matters(look, facet, front, query.point, kind))
            return true;
    }
    return false;
}

static void test_facet(struct look *look, uint32_t facet, enum orl_lit_kind kind)
{
    struct orl_lit_class *class = &look->lit->classes[kind];
    const struct orl_material *const m =
        &look->world->materials[orl_facet_material(look->world->geometry, facet)];
    for (int side = 0; side < 2 && !class->lit; side++)
        if (share_sent_on(m, side == 0, kind) > 0 && is_lit(look, facet, side == 0, kind)) {
            class->lit = true;
            class->facet = facet;
        }
}

/* Checks all placements of a facet. */
static void test_placements(struct look *look, const struct orl_kept_walk *walk,
                            enum orl_lit_kind kind)
{
    const struct orl_geometry *const g = look->world->geometry;
    const uint32_t within = walk->facet - g->placed[walk->part->first_place].first_facet;
    for (size_t i = walk->part->first_place; i < g->n_placed && !orl_crew_cancelled(look->crew);
         i++)
        if (g->placed[i].prototype == walk->part)
            test_facet(look, g->placed[i].first_facet + within, kind);
}

static void test_facets(struct look *look, enum orl_lit_kind kind)
{
    const struct orl_world *const world = look->world;
    const struct orl_lit_class *const class = &look->lit->classes[kind];
    struct orl_kept_walk walk = orl_kept_walk(world->geometry);
    while (!class->lit && !orl_crew_cancelled(look->crew) && orl_kept_next(&walk)) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_of(world->geometry, walk.facet, &room);
        if (!(f->area > 0) || !is_kind(f->kind, &world->materials[f->material], kind))
            continue;
        if (orl_facet_is_placed(world->geometry, walk.facet))
            test_placements(look, &walk, kind);
        else
            test_facet(look, walk.facet, kind);
    }
}

/* Returns the number of placements that matter: in a sealed scene, those outside do not. */
static size_t count_places(const struct orl_world *world, const struct orl_kept_walk *walk)
{
    const struct orl_geometry *const g = world->geometry;
    size_t n = 0;
    if (world->open || !orl_facet_is_placed(g, walk->facet) || walk->places > MOST_PLACES)
        return walk->places;
    for (size_t i = walk->part->first_place; i < g->n_placed; i++) {
        static const double middle[2] = {0.5, 0.5};
        struct orl_vec3 point, normal;
        if (g->placed[i].prototype != walk->part)
            continue;
        orl_facet_sample(g, g->placed[i].first_facet, middle, &point, &normal);
        n += !orl_world_is_outside(world, point);
    }
    return n;
}

static void count_facets(struct look *look)
{
    const struct orl_world *world = look->world;
    const struct orl_geometry *part = NULL;
    size_t places = 0;
    struct orl_kept_walk walk = orl_kept_walk(world->geometry);
    while (!orl_crew_cancelled(look->crew) && orl_kept_next(&walk)) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_of(world->geometry, walk.facet, &room);
        const struct orl_material *m = &world->materials[f->material];
        if (walk.part != part)
            places = count_places(world, &walk);
        part = walk.part;
        for (int kind = 0; kind < ORL_LIT_KINDS && f->area > 0 && places > 0; kind++) {
            struct orl_lit_class *class = &look->lit->classes[kind];
            if (!is_kind(f->kind, m, (enum orl_lit_kind)kind))
                continue;
            class->facets += places;
            for (int side = 0; side < 2; side++)
                class->share =
                    fmax(class->share, share_sent_on(m, side == 0, (enum orl_lit_kind)kind));
        }
    }
}

static void mark_lit(struct look *look, uint32_t facet)
{
    const struct orl_geometry *const g = look->world->geometry;
    const enum orl_surface_kind shape = orl_facet_kind(g, facet);
    const struct orl_material *m = &look->world->materials[orl_facet_material(g, facet)];
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++) {
        struct orl_lit_class *class = &look->lit->classes[kind];
        if (!class->lit && is_kind(shape, m, (enum orl_lit_kind)kind)) {
            class->lit = true;
            class->facet = facet;
        }
    }
}

/* Traces a sun's ray in by a window, straight on to the first surface that is no pane. */
static void trace_sun_in(struct look *look, const struct orl_port *port, const struct orl_sun *sun,
                         uint32_t sample)
{
    const struct orl_geometry *g = look->world->geometry;
    struct orl_vec3 point, normal, direction;
    double u[4];
    orl_sobol_point(&look->sobol, sample, port->facet, 4, u);
    orl_facet_sample(g, port->facet, u, &point, &normal);
    direction = orl_sun_sample(sun, u + 2);
    if (!(orl_dot(direction, port->outward) > 0))
        return;
    const struct orl_vec3 out = orl_facet_leave(g, port->facet, point, normal, direction);
    if (!(orl_rgb_max(orl_transmittance(look->world, out, direction, INFINITY, false)) > 0))
        return;
    direction = orl_neg(direction);
    const struct orl_hit pane = {
        .point = point, .normal = normal, .facet = port->facet, .front = port->outside_is_front};
    if (!(orl_rgb_max(orl_material_straight(orl_world_material(look->world, &pane), &pane,
                                            orl_neg(direction))) > 0))
        return; /* a scattering pane is itself lit, and is found as such */
    struct orl_path path =
        orl_path_from(orl_facet_leave(g, port->facet, point, normal, direction), direction);
    for (int i = 0; i < MOST_PANES; i++) {
        struct orl_hit hit;
        if (!orl_path_meet(look->world, &path, &hit))
            return;
        mark_lit(look, hit.facet);
        if (!orl_path_look_through(&path, orl_world_material(look->world, &hit), &hit))
            return;
        orl_path_pass(&path, look->world, &hit);
    }
}

/* Returns true if a sun's image in flat outdoor mirrors is visible from a window. */
static bool image_reaches(const struct look *look, const struct orl_port *port,
                          const struct orl_image *image, uint32_t sample)
{
    const struct orl_geometry *g = look->world->geometry;
    struct orl_vec3 point, normal;
    double u[4];
    orl_sobol_point(&look->sobol, sample, port->facet + 1, 4, u);
    orl_facet_sample(g, port->facet, u, &point, &normal);
    point = orl_facet_leave(g, port->facet, point, normal, port->outward);
    const struct orl_vec3 from = orl_image_sample(look->world, image, u + 2);
    return orl_dot(from, port->outward) > 0 &&
           orl_rgb_max(orl_image_transmittance(look->world, point, from, image, false)) > 0;
}

static void test_images(struct look *look, const struct orl_port *port)
{
    const struct orl_images *images = &look->world->images;
    struct orl_lit_class *class = &look->lit->classes[ORL_LIT_FLAT];
    if (port->clear || look->world->omit.exterior)
        return;
    for (size_t k = 0; k < images->n_nodes; k++)
        for (uint32_t i = 0; images->nodes[k].shown && i < IMAGE_SAMPLES && !class->lit; i++)
            if (image_reaches(look, port, &images->nodes[k], i)) {
                class->lit = true;
                class->facet = port->facet;
            }
}

static void test_windows(struct look *look)
{
    const struct orl_world *world = look->world;
    const size_t pairs = world->n_ports * world->n_suns + 1;
    const size_t share = MOST_RAYS / pairs;
    const uint32_t samples = (uint32_t)(share < WINDOW_SAMPLES ? share + 1 : WINDOW_SAMPLES);
    for (size_t p = 0; p < world->n_ports && !orl_crew_cancelled(look->crew); p++) {
        for (size_t s = 0; s < world->n_suns && !orl_crew_cancelled(look->crew); s++)
            for (uint32_t i = 0; i < samples; i++)
                trace_sun_in(look, &world->ports[p], &world->suns[s], i);
        test_images(look, &world->ports[p]);
    }
}

/* Marks all existing classes as lit, if there are too many facets to check. */
static void mark_all_lit(struct orl_lit *lit)
{
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        lit->classes[kind].lit = lit->classes[kind].facets > 0;
}

void orl_lit_look(const struct orl_survey *survey, struct orl_lit *ret_lit)
{
    const struct orl_world *world = survey->world;
    struct look look = {.world = world, .lit = ret_lit, .crew = survey->request->crew};
    size_t facets = 1;
    *ret_lit = (struct orl_lit){.lights = world->n_suns};
    for (size_t i = 0; i < world->n_emitters; i++)
        ret_lit->lights += world->emitters[i].direct;
    orl_sobol_init(&look.sobol);
    count_facets(&look);
    if (ret_lit->lights == 0)
        return;
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        facets += ret_lit->classes[kind].facets;
    const size_t share = MOST_RAYS / (2 * facets * ret_lit->lights);
    if ((double)facets * (double)ret_lit->lights > most_pairs) {
        mark_all_lit(ret_lit);
        return;
    }
    look.samples = (uint32_t)(share > MOST_SAMPLES    ? MOST_SAMPLES
                              : share < LEAST_SAMPLES ? LEAST_SAMPLES
                                                      : share);
    ret_lit->rays = 2 * facets * ret_lit->lights * look.samples;
    test_windows(&look);
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        test_facets(&look, (enum orl_lit_kind)kind);
}
