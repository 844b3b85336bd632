#include "plan/decide.h"

#include "base/sampling/sampling.h"
#include "light/direct.h"
#include "light/path.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

enum { MOST_RAYS = 1 << 18, MOST_SAMPLES = 256, LEAST_SAMPLES = 8, MOST_PANES = 64 };
enum { WINDOW_SAMPLES = 1024, IMAGE_SAMPLES = 64, MOST_PLACES = 4096 };

/* Limit of facets times lights; beyond it the search would take seconds. */
static const double most_pairs = 2e5;

struct lit_search {
    const struct orl_lit_scene *lit_scene;
    struct orl_lit_specular *lit;
    struct orl_sobol sobol;
    const struct orl_thread_pool *pool; /* polled for cancellation */
    uint32_t samples;                   /* per side of a facet */
};

static bool is_kind(enum orl_surface_kind shape, const struct orl_material *m,
                    enum orl_lit_specular_kind kind)
{
    const bool flat = !m->texture && orl_surface_kind_is_flat(shape);
    const bool bends = orl_material_deviates(m);
    if (kind == ORL_LIT_LOBE)
        return orl_material_has_lobes(m);
    if (kind == ORL_LIT_CURVED)
        return bends || (!flat && orl_material_is_mirror(m));
    return flat && !bends && orl_material_is_mirror(m);
}

/* Returns the share of light at 60 degrees that a side sends on in other directions than
 * straight. */
static double redirected_share(const struct orl_material *m, bool front,
                               enum orl_lit_specular_kind kind)
{
    if (kind == ORL_LIT_CURVED && orl_material_deviates(m))
        return 1;
    return kind == ORL_LIT_LOBE || m->kind == ORL_MATERIAL_BSDF
               ? orl_material_max_lobes(m, front, 0.5)
               : orl_material_max_mirrored(m, front, 0.5);
}

/* Returns true if a lit point of that side matters: in a sealed scene, points outside do not. */
static bool point_matters(const struct lit_search *lit_search, uint32_t facet, bool front,
                          struct orl_vec3 point, enum orl_lit_specular_kind kind)
{
    const struct orl_lit_scene *lit_scene = lit_search->lit_scene;
    const int32_t port = orl_lit_scene_port_of(lit_scene, facet);
    if (lit_scene->open)
        return true;
    if (port == ORL_NO_PORT)
        return !orl_lit_scene_is_outside(lit_scene, point);
    if (front != lit_scene->ports[port].outside_is_front)
        return true;
    const struct orl_material *const m =
        &lit_scene->materials[orl_facet_material(lit_scene->geometry, facet)];
    return (kind == ORL_LIT_LOBE && orl_material_transmits_lobes(m)) ||
           (kind == ORL_LIT_CURVED && orl_material_deviates(m));
}

static bool is_lit(const struct lit_search *lit_search, uint32_t facet, bool front,
                   enum orl_lit_specular_kind kind)
{
    const struct orl_geometry *g = lit_search->lit_scene->geometry;
    for (uint32_t i = 0; i < lit_search->samples && !orl_thread_pool_cancelled(lit_search->pool);
         i++) {
        struct orl_random random = orl_random_stream(facet, ORL_PURPOSE_PILOT, i);
        struct orl_direct_query query = {.through_ports = true};
        struct orl_vec3 point, normal;
        double u[2];
        orl_sobol_point(&lit_search->sobol, i, facet, 2, u);
        orl_facet_sample(g, facet, u, &point, &normal);
        query.normal = front ? normal : orl_neg(normal);
        query.point = orl_facet_ray_origin(g, facet, point, normal, query.normal);
        if (orl_rgb_max(orl_direct_light(lit_search->lit_scene, &query, &random)) > 0 &&
            point_matters(lit_search, facet, front, query.point, kind))
            return true;
    }
    return false;
}

static void test_facet(struct lit_search *lit_search, uint32_t facet,
                       enum orl_lit_specular_kind kind)
{
    struct orl_lit_specular_class *class = &lit_search->lit->classes[kind];
    const struct orl_material *const m =
        &lit_search->lit_scene
             ->materials[orl_facet_material(lit_search->lit_scene->geometry, facet)];
    for (int side = 0; side < 2 && !class->lit; side++)
        if (redirected_share(m, side == 0, kind) > 0 && is_lit(lit_search, facet, side == 0, kind))
            class->lit = true;
}

/* Checks all placements of a facet. */
static void test_placements(struct lit_search *lit_search, const struct orl_facet_iterator *walk,
                            enum orl_lit_specular_kind kind)
{
    const struct orl_geometry *const g = lit_search->lit_scene->geometry;
    const uint32_t within = walk->facet - g->instance[walk->part->first_use].first_facet;
    for (size_t i = walk->part->first_use;
         i < g->n_instances && !orl_thread_pool_cancelled(lit_search->pool); i++)
        if (g->instance[i].prototype == walk->part)
            test_facet(lit_search, g->instance[i].first_facet + within, kind);
}

static void test_facets(struct lit_search *lit_search, enum orl_lit_specular_kind kind)
{
    const struct orl_lit_scene *const lit_scene = lit_search->lit_scene;
    const struct orl_lit_specular_class *const class = &lit_search->lit->classes[kind];
    struct orl_facet_iterator walk = orl_facet_iterator(lit_scene->geometry);
    while (!class->lit && !orl_thread_pool_cancelled(lit_search->pool) &&
           orl_facet_iterator_next(&walk)) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_get(lit_scene->geometry, walk.facet, &room);
        if (!(f->area > 0) || !is_kind(f->kind, &lit_scene->materials[f->material], kind))
            continue;
        if (orl_facet_is_instanced(lit_scene->geometry, walk.facet))
            test_placements(lit_search, &walk, kind);
        else
            test_facet(lit_search, walk.facet, kind);
    }
}

/* Returns the number of placements that matter: in a sealed scene, those outside do not. */
static size_t count_places(const struct orl_lit_scene *lit_scene,
                           const struct orl_facet_iterator *walk)
{
    const struct orl_geometry *const g = lit_scene->geometry;
    size_t n = 0;
    if (lit_scene->open || !orl_facet_is_instanced(g, walk->facet) || walk->places > MOST_PLACES)
        return walk->places;
    for (size_t i = walk->part->first_use; i < g->n_instances; i++) {
        static const double middle[2] = {0.5, 0.5};
        struct orl_vec3 point, normal;
        if (g->instance[i].prototype != walk->part)
            continue;
        orl_facet_sample(g, g->instance[i].first_facet, middle, &point, &normal);
        n += !orl_lit_scene_is_outside(lit_scene, point);
    }
    return n;
}

static void count_facets(struct lit_search *lit_search)
{
    const struct orl_lit_scene *lit_scene = lit_search->lit_scene;
    const struct orl_geometry *part = NULL;
    size_t places = 0;
    struct orl_facet_iterator walk = orl_facet_iterator(lit_scene->geometry);
    while (!orl_thread_pool_cancelled(lit_search->pool) && orl_facet_iterator_next(&walk)) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_get(lit_scene->geometry, walk.facet, &room);
        const struct orl_material *m = &lit_scene->materials[f->material];
        if (walk.part != part)
            places = count_places(lit_scene, &walk);
        part = walk.part;
        for (int kind = 0; kind < ORL_LIT_KINDS && f->area > 0 && places > 0; kind++) {
            struct orl_lit_specular_class *class = &lit_search->lit->classes[kind];
            if (!is_kind(f->kind, m, (enum orl_lit_specular_kind)kind))
                continue;
            class->facets += places;
            for (int side = 0; side < 2; side++)
                class->share = fmax(
                    class->share, redirected_share(m, side == 0, (enum orl_lit_specular_kind)kind));
        }
    }
}

static void mark_lit(struct lit_search *lit_search, uint32_t facet)
{
    const struct orl_geometry *const g = lit_search->lit_scene->geometry;
    const enum orl_surface_kind shape = orl_facet_kind(g, facet);
    const struct orl_material *m = &lit_search->lit_scene->materials[orl_facet_material(g, facet)];
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        if (is_kind(shape, m, (enum orl_lit_specular_kind)kind))
            lit_search->lit->classes[kind].lit = true;
}

/* Traces a sun's ray in by a window, straight on to the first surface that is no pane. */
static void trace_sun_in(struct lit_search *lit_search, const struct orl_port *port,
                         const struct orl_sun *sun, uint32_t sample)
{
    const struct orl_geometry *g = lit_search->lit_scene->geometry;
    struct orl_vec3 point, normal, direction;
    double u[4];
    orl_sobol_point(&lit_search->sobol, sample, port->facet, 4, u);
    orl_facet_sample(g, port->facet, u, &point, &normal);
    direction = orl_sun_sample(sun, u + 2);
    if (!(orl_dot(direction, port->outward) > 0))
        return;
    const struct orl_vec3 out = orl_facet_ray_origin(g, port->facet, point, normal, direction);
    if (!(orl_rgb_max(orl_transmittance(lit_search->lit_scene, out, direction, INFINITY, false)) >
          0))
        return;
    direction = orl_neg(direction);
    const struct orl_hit pane = {
        .point = point, .normal = normal, .facet = port->facet, .front = port->outside_is_front};
    if (!(orl_rgb_max(orl_material_straight(orl_lit_scene_material(lit_search->lit_scene, &pane),
                                            &pane, orl_neg(direction))) > 0))
        return; /* a scattering pane is itself lit, and is found as such */
    struct orl_path path =
        orl_path_from(orl_facet_ray_origin(g, port->facet, point, normal, direction), direction);
    for (int i = 0; i < MOST_PANES; i++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_search->lit_scene, &path, &hit))
            return;
        mark_lit(lit_search, hit.facet);
        if (!orl_path_transmit_straight(&path, orl_lit_scene_material(lit_search->lit_scene, &hit),
                                        &hit))
            return;
        orl_path_skip_surface(&path, lit_search->lit_scene, &hit);
    }
}

/* Returns true if a sun's image in flat outdoor mirrors is visible from a window. */
static bool image_reaches(const struct lit_search *lit_search, const struct orl_port *port,
                          const struct orl_virtual_sun *image, uint32_t sample)
{
    const struct orl_geometry *g = lit_search->lit_scene->geometry;
    struct orl_vec3 point, normal;
    double u[4];
    orl_sobol_point(&lit_search->sobol, sample, port->facet + 1, 4, u);
    orl_facet_sample(g, port->facet, u, &point, &normal);
    point = orl_facet_ray_origin(g, port->facet, point, normal, port->outward);
    const struct orl_vec3 from = orl_virtual_sun_sample(lit_search->lit_scene, image, u + 2);
    return orl_dot(from, port->outward) > 0 &&
           orl_rgb_max(
               orl_virtual_sun_transmittance(lit_search->lit_scene, point, from, image, false)) > 0;
}

static void test_images(struct lit_search *lit_search, const struct orl_port *port)
{
    const struct orl_virtual_suns *images = &lit_search->lit_scene->images;
    struct orl_lit_specular_class *class = &lit_search->lit->classes[ORL_LIT_FLAT];
    if (port->clear || lit_search->lit_scene->omit.exterior)
        return;
    for (size_t k = 0; k < images->n_nodes; k++)
        for (uint32_t i = 0; images->nodes[k].shown && i < IMAGE_SAMPLES && !class->lit; i++)
            class->lit = image_reaches(lit_search, port, &images->nodes[k], i);
}

static void test_windows(struct lit_search *lit_search)
{
    const struct orl_lit_scene *lit_scene = lit_search->lit_scene;
    const size_t pairs = lit_scene->n_ports * lit_scene->n_suns + 1;
    const size_t share = MOST_RAYS / pairs;
    const uint32_t samples = (uint32_t)(share < WINDOW_SAMPLES ? share + 1 : WINDOW_SAMPLES);
    for (size_t p = 0; p < lit_scene->n_ports && !orl_thread_pool_cancelled(lit_search->pool);
         p++) {
        for (size_t s = 0; s < lit_scene->n_suns && !orl_thread_pool_cancelled(lit_search->pool);
             s++)
            for (uint32_t i = 0; i < samples; i++)
                trace_sun_in(lit_search, &lit_scene->ports[p], &lit_scene->suns[s], i);
        test_images(lit_search, &lit_scene->ports[p]);
    }
}

void orl_lit_specular_find(const struct orl_plan_survey *survey, struct orl_lit_specular *ret_lit)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    struct lit_search lit_search = {
        .lit_scene = lit_scene, .lit = ret_lit, .pool = survey->request->pool};
    size_t facets = 1;
    *ret_lit = (struct orl_lit_specular){.lights = lit_scene->n_suns};
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        ret_lit->lights += lit_scene->emitters[i].direct;
    orl_sobol_init(&lit_search.sobol);
    count_facets(&lit_search);
    if (ret_lit->lights == 0)
        return;
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        facets += ret_lit->classes[kind].facets;
    const size_t share = MOST_RAYS / (2 * facets * ret_lit->lights);
    if ((double)facets * (double)ret_lit->lights > most_pairs) {
        for (int kind = 0; kind < ORL_LIT_KINDS; kind++) /* too many to check */
            ret_lit->classes[kind].lit = ret_lit->classes[kind].facets > 0;
        return;
    }
    lit_search.samples = (uint32_t)(share > MOST_SAMPLES    ? MOST_SAMPLES
                                    : share < LEAST_SAMPLES ? LEAST_SAMPLES
                                                            : share);
    test_windows(&lit_search);
    for (int kind = 0; kind < ORL_LIT_KINDS; kind++)
        test_facets(&lit_search, (enum orl_lit_specular_kind)kind);
}
