#include "annual/panes/bsdf_panes.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/reservoir.h"
#include "light/direct.h"
#include "light/path.h"

enum { PARTS = ORL_PANEL_PARTS, DRAWS = ORL_PANEL_DRAWS, GROUPS = ORL_PANEL_GROUPS };
enum { BLOCKS_A_SIDE = ORL_PANEL_SIDE / 2, POINTS = BLOCKS_A_SIDE * BLOCKS_A_SIDE / 2 };
enum { MOST_PANES = 64 };
/* Points of the sun's disc for each point of a pane, if the disc spans several cells of a BSDF. */
enum { DISC_POINTS = 4 };

/* ---- The panes ------------------------------------------------------------------------------- */

/* Returns true if two materials are copies of one. Parts of the windows have their own copies. */
static bool are_copies(const struct orl_world *world, const struct orl_material *a,
                       const struct orl_material *b)
{
    const struct orl_material *all = world->materials;
    return a->texture == b->texture && orl_material_origin(a, (uint32_t)(a - all)) ==
                                           orl_material_origin(b, (uint32_t)(b - all));
}

static int kind_of(struct orl_panels *panels, const struct orl_material *m, struct orl_vec3 normal,
                   struct orl_vec3 inward)
{
    for (size_t i = 0; i < panels->n_kinds; i++)
        if (are_copies(panels->world, panels->kinds[i].material, m) &&
            orl_dot(panels->kinds[i].normal, normal) > 1 - 1e-9)
            return (int)i;
    if (panels->n_kinds == ORL_PANEL_MOST_KINDS)
        return ORL_ERR_LIMIT;
    panels->kinds[panels->n_kinds] =
        (struct orl_panel_kind){.material = m,
                                .normal = normal,
                                .inward = inward,
                                .frame = orl_bsdf_frame(m, normal),
                                .data_alone = orl_panel_is_data_alone(m)};
    return (int)panels->n_kinds++;
}

static int find_panes(struct orl_panels *panels, const struct orl_annual_scene *scene)
{
    const struct orl_world *world = panels->world;
    int code = 0;
    panels->at = calloc(world->n_ports + 1, sizeof *panels->at);
    if (!panels->at)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < world->n_ports && code == 0; i++) {
        const struct orl_port *port = &world->ports[i];
        struct orl_facet own;
        const struct orl_facet *facet = orl_facet_own(world->geometry, port->facet, &own);
        const struct orl_material *m = &world->materials[facet->material];
        if (m->kind != ORL_MATERIAL_BSDF)
            continue;
        const struct orl_vec3 inward = orl_neg(port->outward);
        const int kind = kind_of(panels, m, facet->normal, inward);
        code = kind < 0 ? kind : 0;
        panels->at[panels->count++] =
            (struct orl_panel){.window = orl_window_of(world->geometry, port->facet),
                               .inward = inward,
                               .kind = (uint32_t)kind,
                               .part = orl_annual_part_of(scene, (int32_t)i),
                               .area = facet->area};
    }
    return code;
}

/* ---- Data shared by all sensors -------------------------------------------------------------- */

struct maker {
    struct orl_panels *panels;
    const struct orl_sobol *sobol;
    uint64_t seed;
};

/* Returns the share of the light of a point of the sun's disc that comes to a point of a pane. */
static double share_there(const struct orl_panels *panels, const struct orl_panel *panel,
                          struct orl_vec3 towards, struct orl_vec3 point)
{
    const struct orl_world *world = panels->world;
    if (!(orl_dot(towards, panel->inward) < 0))
        return 0;
    const struct orl_vec3 start =
        orl_facet_leave(world->geometry, panel->window.facet, point, panel->window.normal, towards);
    return orl_luma(orl_transmittance(world, start, towards, INFINITY, true));
}

/* Returns a jittered point in one part of a pane. */
static struct orl_vec3 point_of_part(const struct orl_world *world, const struct orl_panel *panel,
                                     uint32_t part, struct orl_random *random)
{
    const uint32_t row = part / ORL_PANEL_SIDE, column = part % ORL_PANEL_SIDE;
    const double x = orl_random_uniform(random), y = orl_random_uniform(random);
    const double u[2] = {(column + x) / ORL_PANEL_SIDE, (row + y) / ORL_PANEL_SIDE};
    struct orl_vec3 point, normal;
    orl_facet_sample(world->geometry, panel->window.facet, u, &point, &normal);
    return point;
}

static const double alike_share = 1e-6;

enum { MIXED = -1, NOT_PROBED = -2 };

/* Returns the share of a sun's light that comes to all points of a pane, or MIXED. */
static float probe_pane(const struct orl_panels *panels, size_t pane, size_t which)
{
    const struct orl_panel *panel = &panels->at[pane];
    const struct orl_sun disc = orl_panel_disc(&panels->suns->at[which]);
    struct orl_random random =
        orl_random_stream(panels->seed, ORL_PURPOSE_ANNUAL, ~(pane * ORL_HOURS_MOST + which));
    double first = 0;
    for (uint32_t i = 0; i < PARTS; i++) {
        /* Parts far from each other come first, so that most shadows are found early. */
        const struct orl_vec3 point = point_of_part(panels->world, panel, i * 29 % PARTS, &random);
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        const double share = share_there(panels, panel, orl_sun_sample(&disc, u), point);
        if (i == 0)
            first = share;
        if (fabs(share - first) > alike_share)
            return MIXED;
    }
    return (float)first;
}

/* Returns the result of probe_pane, which is called once for all sensors. */
static float sunlight_everywhere(const struct orl_panels *panels, size_t pane, size_t which)
{
    if (!panels->sunlit)
        return MIXED;
    _Atomic float *known = &panels->sunlit[pane * panels->suns->count + which];
    float share = atomic_load_explicit(known, memory_order_relaxed);
    if (share <= NOT_PROBED) {
        share = probe_pane(panels, pane, which);
        atomic_store_explicit(known, share, memory_order_relaxed);
    }
    return share;
}

static void draw_sun(void *arg, size_t which, uint32_t member)
{
    const struct maker *maker = arg;
    const struct orl_panels *panels = maker->panels;
    const struct orl_hour_sun *sun = &panels->suns->at[which];
    (void)member;
    if (!sun->wanted)
        return;
    for (uint32_t kind = 0; kind < panels->n_kinds; kind++)
        if (orl_dot(sun->towards, panels->kinds[kind].inward) < 0)
            orl_panel_draws_make(
                &panels->kinds[kind], sun, maker->sobol,
                orl_mix64(maker->seed ^ orl_mix64(which * ORL_PANEL_MOST_KINDS + kind)),
                &panels->draws[(size_t)kind * panels->suns->count + which]);
}

static int make_room_for_probes(struct orl_panels *panels)
{
    const size_t n = panels->count * panels->suns->count;
    panels->sunlit = malloc((n + 1) * sizeof *panels->sunlit);
    for (size_t i = 0; panels->sunlit && i < n; i++)
        atomic_init(&panels->sunlit[i], NOT_PROBED);
    return panels->sunlit ? 0 : ORL_ERR_NOMEM;
}

int orl_panels_init(struct orl_panels *panels, const struct orl_annual_scene *scene,
                    const struct orl_year_suns *suns, size_t n_sensors, uint64_t seed,
                    struct orl_crew *crew)
{
    struct maker maker = {panels, &scene->sobol, seed};
    *panels = (struct orl_panels){.world = scene->world, .suns = suns, .seed = seed};
    if (scene->world->open || scene->world->n_ports == 0)
        return 0;
    int code = find_panes(panels, scene);
    if (code < 0 || panels->count == 0)
        return code;
    panels->draws = malloc(panels->n_kinds * suns->count * sizeof *panels->draws);
    if (!panels->draws)
        return ORL_ERR_NOMEM;
    if (n_sensors >= ORL_PANEL_PROBING_SENSORS)
        code = make_room_for_probes(panels);
    return code < 0 ? code : orl_crew_try(crew, suns->count, draw_sun, &maker);
}

void orl_panels_done(struct orl_panels *panels)
{
    free(panels->at);
    free(panels->draws);
    free(panels->sunlit);
    *panels = (struct orl_panels){.at = NULL};
}

/* ---- A sensor -------------------------------------------------------------------------------- */

/* A point of a pane as seen from the sensor. */
struct seen {
    struct orl_vec3 point;
    struct orl_vec3 towards; /* from the pane to the sensor */
    /* Luma of the transmittance in between, times both cosines over squared distance. */
    double worth;
    double density;                /* pdf of a uniform point of the pane, per steradian */
    struct orl_bsdf_direction out; /* BSDF direction of `towards`, if the kind has data alone */
};

/* A pane as seen from a sensor. */
struct before {
    const struct orl_panels *panels;
    const struct orl_panel *panel;
    const struct orl_place *place;
    size_t pane;
    uint64_t name;               /* number of the sensor */
    float axis[3], least_cosine; /* cone of directions from the sensor to the pane */
    struct seen seen[PARTS];
    bool any;
    double sight; /* transmittance to all points of the pane; -1: points differ */
};

static void look_at_points(struct before *b, uint64_t name)
{
    enum { LEAST_AHEAD = PARTS / 2 };
    const struct orl_world *world = b->panels->world;
    const struct orl_panel *panel = b->panel;
    const struct orl_panel_kind *k = &b->panels->kinds[panel->kind];
    const double offset = orl_facet_offset(world->geometry, panel->window.facet);
    struct orl_random random = orl_random_stream(name, ORL_PURPOSE_ANNUAL, ~b->pane);
    double least = INFINITY, most = 0;
    uint32_t ahead = 0;
    for (uint32_t i = 0; i < PARTS; i++) {
        const struct orl_vec3 point = point_of_part(world, panel, i, &random);
        const struct orl_vec3 way = orl_sub(point, b->place->point);
        const double distance = orl_length(way);
        const struct orl_vec3 there = orl_scale(way, 1 / distance);
        const double here = orl_dot(there, b->place->normal);
        const double leaving = -orl_dot(there, panel->inward);
        b->seen[i] = (struct seen){.point = point};
        if (!(here > 0)) /* no sample comes from there */
            continue;
        ahead++;
        if (!(leaving > 1e-6) || !(distance > 4 * offset)) {
            least = 0;
            continue;
        }
        const double share =
            orl_luma(orl_transmittance(world, b->place->point, there, distance - 2 * offset, true));
        b->seen[i] = (struct seen){.point = point,
                                   .towards = orl_neg(there),
                                   .worth = share * here * leaving / (distance * distance),
                                   .density = distance * distance / (leaving * panel->area)};
        if (k->data_alone)
            b->seen[i].out =
                orl_bsdf_place(k->material->bsdf, orl_to_local(&k->frame, orl_neg(there)));
        b->any = b->any || share > 0;
        least = fmin(least, share);
        most = fmax(most, share);
    }
    b->sight = ahead >= LEAST_AHEAD && most - least <= alike_share ? most : -1;
}

/* Returns the share of the sun's light that reaches a point of the pane. */
static double sun_at(const struct before *b, size_t which, struct orl_vec3 from,
                     struct orl_vec3 point)
{
    const struct orl_panels *panels = b->panels;
    const float everywhere = sunlight_everywhere(panels, b->pane, which);
    return everywhere >= 0 ? (double)everywhere : share_there(panels, b->panel, from, point);
}

/*
 * Returns a point of the sun's disc by its index in a low-discrepancy sequence (Roberts 2018,
 * powers of the plastic number) with a random shift. Such a set has points even in a sliver of the
 * disc that lies in another cell of the BSDF.
 */
static struct orl_vec3 point_of_disc(const struct orl_sun *disc, uint64_t shift, uint32_t index)
{
    const double x = (double)(uint32_t)shift * 0x1p-32 + index * 0.7548776662466927;
    const double y = (double)(shift >> 32) * 0x1p-32 + index * 0.5698402909980532;
    const double u[2] = {x - floor(x), y - floor(y)};
    return orl_sun_sample(disc, u);
}

/*
 * Returns a random part of a group. A group has eight parts: two blocks of four, which lie half a
 * pane apart in both directions.
 */
static uint32_t part_of_group(uint32_t group, uint64_t bits)
{
    const uint32_t which = (uint32_t)(orl_mix64(bits + group) >> 61);
    const uint32_t half = BLOCKS_A_SIDE / 2, there = which >> 2;
    const uint32_t x = 2 * ((group % BLOCKS_A_SIDE + there * half) % BLOCKS_A_SIDE);
    const uint32_t y = 2 * (group / BLOCKS_A_SIDE + there * half);
    return (y + ((which >> 1) & 1)) * ORL_PANEL_SIDE + x + (which & 1);
}
_Static_assert((int)POINTS == (int)GROUPS, "each group has one point");

/* Returns the BSDF for light from that point of the disc to the sensor; ret_pdf: the pdf of that
 * direction in BSDF sampling. */
static double transmitted_to(const struct orl_panel_kind *k, const struct orl_panel_draws *draws,
                             const struct orl_hit *hit, const struct seen *s, struct orl_vec3 from,
                             double *ret_pdf)
{
    if (k->data_alone) {
        struct orl_bsdf_incidence own;
        const struct orl_bsdf_incidence *in = &draws->middle;
        if (!draws->in_one_cell) {
            own = orl_panel_incidence(k, from);
            in = &own;
        }
        return orl_luma(orl_bsdf_transmit(k->material->bsdf, in, &s->out, ret_pdf));
    }
    const double f = orl_luma(orl_scatter_eval_lobes(k->material, hit, from, s->towards));
    *ret_pdf = f > 0 ? orl_scatter_pdf(k->material, hit, from, ORL_TRANSPORT_LIGHT,
                                       ORL_LOBE_TRANSMITTED, s->towards)
                     : 0;
    return f;
}

/* Returns the unoccluded radiance that a point of the pane sends to the sensor for a point of the
 * disc of radiance 1. It includes the weight of the balance heuristic against BSDF samples. */
static double weighted_radiance(const struct before *b, const struct orl_panel_draws *draws,
                                const struct orl_hit *hit, const struct seen *s,
                                struct orl_vec3 from)
{
    const struct orl_panel_kind *k = &b->panels->kinds[b->panel->kind];
    const double onto = -orl_dot(from, k->inward);
    double pdf;
    if (!(onto > 0))
        return 0;
    const double f = transmitted_to(k, draws, hit, s, from, &pdf);
    return f > 0 ? f * onto * POINTS * s->density / (POINTS * s->density + DRAWS * pdf) : 0;
}

/*
 * Adds light by points of the pane to the groups, for a sun with a normal illuminance of 1. Each
 * point of the pane has its own points of the disc, as each BSDF sample has. If the disc spans two
 * cells of a BSDF, its points send different light. A shadow ray is traced to one of them, sampled
 * in proportion to the light it sends.
 */
static void add_points(const struct before *b, size_t which, const struct orl_sun *disc,
                       uint64_t bits, double groups[GROUPS])
{
    const struct orl_panels *panels = b->panels;
    const struct orl_panel_kind *k = &panels->kinds[b->panel->kind];
    const struct orl_hour_sun *sun = &panels->suns->at[which];
    const struct orl_hit hit = orl_hit_anywhere(k->normal, orl_dot(sun->towards, k->normal) > 0);
    const struct orl_panel_draws *draws =
        panels->draws + (size_t)b->panel->kind * panels->suns->count + which;
    const uint32_t of_disc = draws->spans_cells ? DISC_POINTS : 1;
    const uint64_t shift = orl_mix64(b->name ^ orl_mix64(which << 8));
    for (uint32_t group = 0; group < GROUPS; group++) {
        const struct seen *s = &b->seen[part_of_group(group, bits)];
        struct orl_vec3 chosen = {0, 0, 0};
        struct orl_reservoir sent = orl_reservoir_begin(orl_mix64(bits ^ group));
        if (!(s->worth > 0))
            continue;
        for (uint32_t i = 0; i < of_disc; i++) {
            const struct orl_vec3 from = point_of_disc(disc, shift, group * of_disc + i);
            if (orl_reservoir_add(&sent, weighted_radiance(b, draws, &hit, s, from)))
                chosen = from;
        }
        const double lit = sent.weight_sum > 0 ? sun_at(b, which, chosen, s->point) : 0;
        groups[group] += sent.weight_sum / of_disc * s->worth * b->panel->area * lit;
    }
}

/* Returns the luma of the transmittance from the sensor to the pane along a ray; 0 if it is
 * blocked. */
static double sight_of(const struct before *b, struct orl_vec3 towards)
{
    const struct orl_world *world = b->panels->world;
    struct orl_path path = orl_path_from(b->place->point, towards);
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_path_meet(world, &path, &hit))
            return 0;
        if (hit.facet == b->panel->window.facet)
            return orl_luma(path.weight);
        if (!orl_path_look_through(&path, orl_world_material(world, &hit), &hit))
            return 0;
        orl_path_pass(&path, world, &hit);
    }
    return 0;
}

/* Lists the BSDF samples in the cone around the pane. Most samples miss it by far. This test is
 * cheaper than the pane's own, and slightly wider. Compilers vectorise the first loop. */
static uint32_t list_in_cone(const struct before *b, const struct orl_panel_draws *draws,
                             unsigned char ret_which[DRAWS])
{
    const float *x = draws->towards[0], *y = draws->towards[1], *z = draws->towards[2];
    const float u = b->axis[0], v = b->axis[1], w = b->axis[2];
    float cosines[DRAWS];
    uint32_t n = 0;
    for (uint32_t i = 0; i < DRAWS; i++)
        cosines[i] = -(x[i] * u + y[i] * v + z[i] * w);
    for (uint32_t i = 0; i < DRAWS; i++) {
        ret_which[n] = (unsigned char)i;
        n += cosines[i] >= b->least_cosine;
    }
    return n;
}

static void find_cone(struct before *b)
{
    const struct orl_cone cone = orl_window_cone(&b->panel->window, b->place->point);
    b->axis[0] = (float)cone.axis.x;
    b->axis[1] = (float)cone.axis.y;
    b->axis[2] = (float)cone.axis.z;
    b->least_cosine = (float)cone.cosine - 1e-5F;
}

/* Adds light by BSDF samples: those whose direction leads from the pane to the sensor. */
static void add_draws(const struct before *b, size_t which, const struct orl_sun *disc,
                      double groups[GROUPS])
{
    const struct orl_panels *panels = b->panels;
    const struct orl_panel *panel = b->panel;
    const size_t suns = panels->suns->count;
    const struct orl_panel_draws *draws = panels->draws + (size_t)panel->kind * suns + which;
    unsigned char list[DRAWS];
    const uint32_t n = list_in_cone(b, draws, list);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = list[k];
        const struct orl_panel_draw *d = &draws->at[i];
        double distance;
        if (!(d->light > 0))
            continue;
        const struct orl_vec3 there =
            orl_v3(-(double)draws->towards[0][i], -(double)draws->towards[1][i],
                   -(double)draws->towards[2][i]);
        const double here = orl_dot(there, b->place->normal);
        if (!(here > 0) || !orl_window_passed(&panel->window, b->place->point, there, 0, &distance))
            continue;
        const struct orl_vec3 point = orl_madd(b->place->point, there, distance);
        const double seen = b->sight >= 0 ? b->sight : sight_of(b, there);
        const double of_disc[2] = {(double)d->from[0], (double)d->from[1]};
        const struct orl_vec3 from = orl_sun_sample(disc, of_disc);
        const double share = seen > 0 ? seen * sun_at(b, which, from, point) : 0;
        if (!(share > 0))
            continue;
        const double leaving = -orl_dot(there, panel->inward);
        const double of_points = POINTS * distance * distance / (leaving * panel->area);
        const double of_draws = DRAWS * (double)d->density;
        groups[i % GROUPS] +=
            of_draws / (of_draws + of_points) * (double)d->light * here * share * GROUPS / DRAWS;
    }
}

/* Adds the light of one sun through one pane: the mean of the groups, and its variance. */
static void add_sun(const struct before *b, size_t sun, const struct orl_sun_rows *rows)
{
    const struct orl_sun disc = orl_panel_disc(&b->panels->suns->at[sun]);
    double groups[GROUPS] = {0}, mean = 0, spread = 0;
    add_points(b, sun, &disc, orl_mix64(b->name ^ orl_mix64(sun * 64 + b->pane)), groups);
    add_draws(b, sun, &disc, groups);
    for (int g = 0; g < GROUPS; g++)
        mean += groups[g] / GROUPS;
    for (int g = 0; g < GROUPS; g++)
        spread += (groups[g] - mean) * (groups[g] - mean) / (GROUPS * (GROUPS - 1.0));
    orl_sun_rows_add(rows, b->panel->part, ORL_SUN_DIRECT, sun, mean);
    orl_sun_rows_add(rows, b->panel->part, ORL_SUN_SQUARES, sun, spread);
}

void orl_panels_add(const struct orl_panels *panels, const struct orl_place *place, uint64_t name,
                    const struct orl_crew *crew, const struct orl_sun_rows *rows)
{
    for (size_t pane = 0; pane < panels->count && !orl_crew_cancelled(crew); pane++) {
        struct before b = {.panels = panels,
                           .panel = &panels->at[pane],
                           .place = place,
                           .pane = pane,
                           .name = name};
        const struct orl_vec3 from = orl_sub(place->point, b.panel->window.corner);
        const unsigned char *wanted =
            rows->wanted ? rows->wanted + b.panel->part * panels->suns->count : NULL;
        if (place->outside || !(orl_dot(from, b.panel->inward) > 0))
            continue;
        look_at_points(&b, name);
        find_cone(&b);
        for (size_t c = 0; b.any && c < panels->suns->count; c++)
            if (panels->suns->at[c].wanted && (!wanted || wanted[c]) &&
                orl_dot(panels->suns->at[c].towards, b.panel->inward) < 0 &&
                sunlight_everywhere(panels, pane, c) != 0)
                add_sun(&b, c, rows);
    }
}
