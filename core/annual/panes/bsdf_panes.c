#include "annual/panes/bsdf_panes.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "light/direct.h"

enum {
    STRATA = ORL_BSDF_PANE_STRATA,
    SAMPLES = ORL_BSDF_PANE_SAMPLES,
    BATCHES = ORL_BSDF_PANE_BATCHES
};
enum { BLOCKS_A_SIDE = ORL_BSDF_PANE_SIDE / 2, POINTS = BLOCKS_A_SIDE * BLOCKS_A_SIDE / 2 };
/* Points of the sun's disc for each point of a pane, if the disc spans several cells of a BSDF. */
enum { DISC_POINTS = 4 };

/* ---- The panes ------------------------------------------------------------------------------- */

/* Returns true if two materials are copies of one. Window groups have their own copies. */
static bool are_copies(const struct orl_lit_scene *lit_scene, const struct orl_material *a,
                       const struct orl_material *b)
{
    const struct orl_material *all = lit_scene->materials;
    return a->texture == b->texture && orl_material_origin(a, (uint32_t)(a - all)) ==
                                           orl_material_origin(b, (uint32_t)(b - all));
}

static int kind_of(struct orl_bsdf_panes *bsdf_panes, const struct orl_material *m,
                   struct orl_vec3 normal, struct orl_vec3 inward)
{
    for (size_t i = 0; i < bsdf_panes->n_kinds; i++)
        if (are_copies(bsdf_panes->lit_scene, bsdf_panes->kinds[i].material, m) &&
            orl_dot(bsdf_panes->kinds[i].normal, normal) > 1 - 1e-9)
            return (int)i;
    if (bsdf_panes->n_kinds == ORL_BSDF_PANE_MOST_KINDS)
        return ORL_ERR_LIMIT;
    bsdf_panes->kinds[bsdf_panes->n_kinds] =
        (struct orl_bsdf_pane_kind){.material = m,
                                    .normal = normal,
                                    .inward = inward,
                                    .frame = orl_bsdf_frame(m, normal),
                                    .data_alone = orl_bsdf_surface_is_data_only(m)};
    return (int)bsdf_panes->n_kinds++;
}

static int find_panes(struct orl_bsdf_panes *bsdf_panes, const struct orl_annual_scene *scene)
{
    const struct orl_lit_scene *lit_scene = bsdf_panes->lit_scene;
    int code = 0;
    bsdf_panes->at =
        orl_arrays_new(&bsdf_panes->arrays, lit_scene->n_ports, sizeof *bsdf_panes->at);
    if (!bsdf_panes->at)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_ports && code == 0; i++) {
        const struct orl_port *port = &lit_scene->ports[i];
        struct orl_facet own;
        const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, port->facet, &own);
        const struct orl_material *m = &lit_scene->materials[facet->material];
        if (m->kind != ORL_MATERIAL_BSDF)
            continue;
        const struct orl_vec3 inward = orl_neg(port->outward);
        const int kind = kind_of(bsdf_panes, m, facet->normal, inward);
        code = kind < 0 ? kind : 0;
        bsdf_panes->at[bsdf_panes->count++] =
            (struct orl_bsdf_pane){.window = orl_bounding_rect_of(lit_scene->geometry, port->facet),
                                   .inward = inward,
                                   .kind = (uint32_t)kind,
                                   .window_group = orl_annual_window_group_of(scene, (int32_t)i),
                                   .area = facet->area};
    }
    return code;
}

/* ---- Data shared by all sensors -------------------------------------------------------------- */

struct builder {
    struct orl_bsdf_panes *bsdf_panes;
    const struct orl_sobol *sobol;
    uint64_t seed;
};

/* Returns the share of the light of a point of the sun's disc that comes to a point of a pane. */
static double share_there(const struct orl_bsdf_panes *bsdf_panes,
                          const struct orl_bsdf_pane *bsdf_pane, struct orl_vec3 towards,
                          struct orl_vec3 point)
{
    const struct orl_lit_scene *lit_scene = bsdf_panes->lit_scene;
    if (!(orl_dot(towards, bsdf_pane->inward) < 0))
        return 0;
    const struct orl_vec3 start = orl_facet_ray_origin(lit_scene->geometry, bsdf_pane->window.facet,
                                                       point, bsdf_pane->window.normal, towards);
    return orl_luma(orl_transmittance(lit_scene, start, towards, INFINITY, true));
}

/* Returns a jittered point in one stratum of a pane. */
static struct orl_vec3 point_of_stratum(const struct orl_lit_scene *lit_scene,
                                        const struct orl_bsdf_pane *bsdf_pane, uint32_t stratum,
                                        struct orl_random *random)
{
    const uint32_t row = stratum / ORL_BSDF_PANE_SIDE, column = stratum % ORL_BSDF_PANE_SIDE;
    const double x = orl_random_uniform(random), y = orl_random_uniform(random);
    const double u[2] = {(column + x) / ORL_BSDF_PANE_SIDE, (row + y) / ORL_BSDF_PANE_SIDE};
    struct orl_vec3 point, normal;
    orl_facet_sample(lit_scene->geometry, bsdf_pane->window.facet, u, &point, &normal);
    return point;
}

static const double alike_share = 1e-6;

enum { MIXED = -1, NOT_PROBED = -2 };

/* Returns the share of a sun's light that comes to all points of a pane, or MIXED. */
static float probe_pane(const struct orl_bsdf_panes *bsdf_panes, size_t pane, size_t which)
{
    const struct orl_bsdf_pane *bsdf_pane = &bsdf_panes->at[pane];
    const struct orl_sun disc = orl_bsdf_pane_sun_disc(&bsdf_panes->suns->at[which]);
    struct orl_random random =
        orl_random_stream(bsdf_panes->seed, ORL_PURPOSE_ANNUAL, ~(pane * ORL_HOURS_MOST + which));
    double first = 0;
    for (uint32_t i = 0; i < STRATA; i++) {
        /* Strata far from each other come first, so that most shadows are found early. */
        const struct orl_vec3 point =
            point_of_stratum(bsdf_panes->lit_scene, bsdf_pane, i * 29 % STRATA, &random);
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        const double share = share_there(bsdf_panes, bsdf_pane, orl_sun_sample(&disc, u), point);
        if (i == 0)
            first = share;
        if (fabs(share - first) > alike_share)
            return MIXED;
    }
    return (float)first;
}

/* Returns the result of probe_pane, which is called once for all sensors. */
static float sunlight_everywhere(const struct orl_bsdf_panes *bsdf_panes, size_t pane, size_t which)
{
    if (!bsdf_panes->sunlit)
        return MIXED;
    _Atomic float *known = &bsdf_panes->sunlit[pane * bsdf_panes->suns->count + which];
    float share = atomic_load_explicit(known, memory_order_relaxed);
    if (share <= NOT_PROBED) {
        share = probe_pane(bsdf_panes, pane, which);
        atomic_store_explicit(known, share, memory_order_relaxed);
    }
    return share;
}

static void sample_sun(void *arg, size_t which, uint32_t member)
{
    const struct builder *builder = arg;
    const struct orl_bsdf_panes *bsdf_panes = builder->bsdf_panes;
    const struct orl_hour_sun *sun = &bsdf_panes->suns->at[which];
    (void)member;
    if (!sun->wanted)
        return;
    for (uint32_t kind = 0; kind < bsdf_panes->n_kinds; kind++)
        if (orl_dot(sun->towards, bsdf_panes->kinds[kind].inward) < 0)
            orl_bsdf_pane_samples_make(
                &bsdf_panes->kinds[kind], sun, builder->sobol,
                orl_mix64(builder->seed ^ orl_mix64(which * ORL_BSDF_PANE_MOST_KINDS + kind)),
                &bsdf_panes->samples[(size_t)kind * bsdf_panes->suns->count + which]);
}

int orl_bsdf_panes_init(struct orl_bsdf_panes *bsdf_panes, const struct orl_annual_scene *scene,
                        const struct orl_year_suns *suns, size_t n_sensors, uint64_t seed,
                        struct orl_thread_pool *pool)
{
    struct builder builder = {bsdf_panes, &scene->sobol, seed};
    *bsdf_panes =
        (struct orl_bsdf_panes){.lit_scene = scene->lit_scene, .suns = suns, .seed = seed};
    if (scene->lit_scene->open || scene->lit_scene->n_ports == 0)
        return 0;
    const int code = find_panes(bsdf_panes, scene);
    if (code < 0 || bsdf_panes->count == 0)
        return code;
    bsdf_panes->samples = orl_arrays_new(&bsdf_panes->arrays, bsdf_panes->n_kinds * suns->count,
                                         sizeof *bsdf_panes->samples);
    const size_t n =
        n_sensors < ORL_BSDF_PANE_PROBING_SENSORS ? 0 : bsdf_panes->count * suns->count;
    if (n > 0)
        bsdf_panes->sunlit = orl_arrays_new(&bsdf_panes->arrays, n, sizeof *bsdf_panes->sunlit);
    if (bsdf_panes->arrays.failed)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        atomic_init(&bsdf_panes->sunlit[i], NOT_PROBED);
    return orl_parallel_try(pool, suns->count, sample_sun, &builder);
}

/* ---- A sensor -------------------------------------------------------------------------------- */

/* A point of a pane as seen from the sensor. */
struct pane_point {
    struct orl_vec3 point;
    struct orl_vec3 towards; /* from the pane to the sensor */
    /* Luma of the transmittance in between, times both cosines over squared distance. */
    double geometry_term;
    double density;                /* pdf of a uniform point of the pane, per steradian */
    struct orl_bsdf_direction out; /* BSDF direction of `towards`, if the kind has data alone */
};

/* A pane as seen from a sensor. */
struct pane_view {
    const struct orl_bsdf_panes *bsdf_panes;
    const struct orl_bsdf_pane *bsdf_pane;
    const struct orl_shading_point *place;
    size_t pane;
    uint64_t name;               /* number of the sensor */
    float axis[3], least_cosine; /* cone of directions from the sensor to the pane */
    struct pane_point seen[STRATA];
    bool any;
    double sight; /* transmittance to all points of the pane; -1: points differ */
};

static void sample_pane_points(struct pane_view *b, uint64_t name)
{
    enum { LEAST_AHEAD = STRATA / 2 };
    const struct orl_lit_scene *lit_scene = b->bsdf_panes->lit_scene;
    const struct orl_bsdf_pane *bsdf_pane = b->bsdf_pane;
    const struct orl_bsdf_pane_kind *k = &b->bsdf_panes->kinds[bsdf_pane->kind];
    const double offset = orl_facet_offset(lit_scene->geometry, bsdf_pane->window.facet);
    struct orl_random random = orl_random_stream(name, ORL_PURPOSE_ANNUAL, ~b->pane);
    double least = INFINITY, most = 0;
    uint32_t ahead = 0;
    for (uint32_t i = 0; i < STRATA; i++) {
        const struct orl_vec3 point = point_of_stratum(lit_scene, bsdf_pane, i, &random);
        const struct orl_vec3 way = orl_sub(point, b->place->point);
        const double distance = orl_length(way);
        const struct orl_vec3 there = orl_scale(way, 1 / distance);
        const double here = orl_dot(there, b->place->normal);
        const double leaving = -orl_dot(there, bsdf_pane->inward);
        b->seen[i] = (struct pane_point){.point = point};
        if (!(here > 0)) /* no sample comes from there */
            continue;
        ahead++;
        if (!(leaving > 1e-6) || !(distance > 4 * offset)) {
            least = 0;
            continue;
        }
        const double share = orl_luma(
            orl_transmittance(lit_scene, b->place->point, there, distance - 2 * offset, true));
        b->seen[i] =
            (struct pane_point){.point = point,
                                .towards = orl_neg(there),
                                .geometry_term = share * here * leaving / (distance * distance),
                                .density = distance * distance / (leaving * bsdf_pane->area)};
        if (k->data_alone)
            b->seen[i].out = orl_bsdf_locate(orl_material_bsdf(k->material),
                                             orl_to_local(&k->frame, orl_neg(there)));
        b->any = b->any || share > 0;
        least = fmin(least, share);
        most = fmax(most, share);
    }
    b->sight = ahead >= LEAST_AHEAD && most - least <= alike_share ? most : -1;
}

/* Returns the share of the sun's light that reaches a point of the pane. */
static double sun_at(const struct pane_view *b, size_t which, struct orl_vec3 from,
                     struct orl_vec3 point)
{
    const struct orl_bsdf_panes *bsdf_panes = b->bsdf_panes;
    const float everywhere = sunlight_everywhere(bsdf_panes, b->pane, which);
    return everywhere >= 0 ? (double)everywhere
                           : share_there(bsdf_panes, b->bsdf_pane, from, point);
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
 * Returns a random stratum of a batch. A batch has eight strata: two blocks of four, which lie half
 * a pane apart in both directions.
 */
static uint32_t stratum_of_batch(uint32_t batch, uint64_t bits)
{
    const uint32_t which = (uint32_t)(orl_mix64(bits + batch) >> 61);
    const uint32_t half = BLOCKS_A_SIDE / 2, there = which >> 2;
    const uint32_t x = 2 * ((batch % BLOCKS_A_SIDE + there * half) % BLOCKS_A_SIDE);
    const uint32_t y = 2 * (batch / BLOCKS_A_SIDE + there * half);
    return (y + ((which >> 1) & 1)) * ORL_BSDF_PANE_SIDE + x + (which & 1);
}
_Static_assert((int)POINTS == (int)BATCHES, "each group has one point");

/* Returns the BSDF for light from that point of the disc to the sensor; ret_pdf: the pdf of that
 * direction in BSDF sampling. */
static double transmitted_to(const struct orl_bsdf_pane_kind *k,
                             const struct orl_bsdf_pane_samples *samples, const struct orl_hit *hit,
                             const struct pane_point *s, struct orl_vec3 from, double *ret_pdf)
{
    if (k->data_alone) {
        struct orl_bsdf_incidence own;
        const struct orl_bsdf_incidence *in = &samples->middle;
        if (!samples->in_one_cell) {
            own = orl_bsdf_pane_incidence(k, from);
            in = &own;
        }
        return orl_luma(orl_bsdf_transmit(orl_material_bsdf(k->material), in, &s->out, ret_pdf));
    }
    const double f = orl_luma(orl_material_eval_lobes(k->material, hit, from, s->towards));
    *ret_pdf = f > 0 ? orl_material_pdf(k->material, hit, from, ORL_TRANSPORT_LIGHT,
                                        ORL_LOBE_TRANSMITTED, s->towards)
                     : 0;
    return f;
}

/* Returns the unoccluded radiance that a point of the pane sends to the sensor for a point of the
 * disc of radiance 1. It includes the weight of the balance heuristic against BSDF samples. */
static double weighted_radiance(const struct pane_view *b,
                                const struct orl_bsdf_pane_samples *samples,
                                const struct orl_hit *hit, const struct pane_point *s,
                                struct orl_vec3 from)
{
    const struct orl_bsdf_pane_kind *k = &b->bsdf_panes->kinds[b->bsdf_pane->kind];
    const double onto = -orl_dot(from, k->inward);
    double pdf;
    if (!(onto > 0))
        return 0;
    const double f = transmitted_to(k, samples, hit, s, from, &pdf);
    return f > 0 ? f * onto * POINTS * s->density / (POINTS * s->density + SAMPLES * pdf) : 0;
}

/*
 * Adds light by points of the pane to the batches, for a sun with a normal illuminance of 1. Each
 * point of the pane has its own points of the disc, as each BSDF sample has. If the disc spans two
 * cells of a BSDF, its points send different light. A shadow ray is traced to one of them, sampled
 * in proportion to the light it sends.
 */
static void add_points(const struct pane_view *b, size_t which, const struct orl_sun *disc,
                       uint64_t bits, double batches[BATCHES])
{
    const struct orl_bsdf_panes *bsdf_panes = b->bsdf_panes;
    const struct orl_bsdf_pane_kind *k = &bsdf_panes->kinds[b->bsdf_pane->kind];
    const struct orl_hour_sun *sun = &bsdf_panes->suns->at[which];
    const struct orl_hit hit =
        orl_hit_surface_mean(k->normal, orl_dot(sun->towards, k->normal) > 0);
    const struct orl_bsdf_pane_samples *samples =
        bsdf_panes->samples + (size_t)b->bsdf_pane->kind * bsdf_panes->suns->count + which;
    const uint32_t of_disc = samples->spans_cells ? DISC_POINTS : 1;
    const uint64_t shift = orl_mix64(b->name ^ orl_mix64(which << 8));
    for (uint32_t batch = 0; batch < BATCHES; batch++) {
        const struct pane_point *s = &b->seen[stratum_of_batch(batch, bits)];
        struct orl_vec3 chosen = {0, 0, 0};
        struct orl_reservoir sent = orl_reservoir_begin(orl_mix64(bits ^ batch));
        if (!(s->geometry_term > 0))
            continue;
        for (uint32_t i = 0; i < of_disc; i++) {
            const struct orl_vec3 from = point_of_disc(disc, shift, batch * of_disc + i);
            if (orl_reservoir_add(&sent, weighted_radiance(b, samples, &hit, s, from)))
                chosen = from;
        }
        const double lit = sent.weight_sum > 0 ? sun_at(b, which, chosen, s->point) : 0;
        batches[batch] += sent.weight_sum / of_disc * s->geometry_term * b->bsdf_pane->area * lit;
    }
}

/* Lists the BSDF samples in the cone around the pane. Most samples miss it by far. This test is
 * cheaper than the pane's own, and slightly wider. Compilers vectorise the first loop. */
static uint32_t list_in_cone(const struct pane_view *b, const struct orl_bsdf_pane_samples *samples,
                             unsigned char ret_which[SAMPLES])
{
    const float *x = samples->towards[0], *y = samples->towards[1], *z = samples->towards[2];
    const float u = b->axis[0], v = b->axis[1], w = b->axis[2];
    float cosines[SAMPLES];
    uint32_t n = 0;
    for (uint32_t i = 0; i < SAMPLES; i++)
        cosines[i] = -(x[i] * u + y[i] * v + z[i] * w);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        ret_which[n] = (unsigned char)i;
        n += cosines[i] >= b->least_cosine;
    }
    return n;
}

static void find_cone(struct pane_view *b)
{
    const struct orl_cone cone = orl_bounding_rect_cone(&b->bsdf_pane->window, b->place->point);
    b->axis[0] = (float)cone.axis.x;
    b->axis[1] = (float)cone.axis.y;
    b->axis[2] = (float)cone.axis.z;
    b->least_cosine = (float)cone.cosine - 1e-5F;
}

/* Adds light by BSDF samples: those whose direction leads from the pane to the sensor. */
static void add_samples(const struct pane_view *b, size_t which, const struct orl_sun *disc,
                        double batches[BATCHES])
{
    const struct orl_bsdf_panes *bsdf_panes = b->bsdf_panes;
    const struct orl_bsdf_pane *bsdf_pane = b->bsdf_pane;
    const size_t suns = bsdf_panes->suns->count;
    const struct orl_bsdf_pane_samples *samples =
        bsdf_panes->samples + (size_t)bsdf_pane->kind * suns + which;
    unsigned char list[SAMPLES];
    const uint32_t n = list_in_cone(b, samples, list);
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = list[k];
        const struct orl_bsdf_pane_sample *d = &samples->at[i];
        double distance;
        if (!(d->light > 0))
            continue;
        const struct orl_vec3 there =
            orl_v3(-(double)samples->towards[0][i], -(double)samples->towards[1][i],
                   -(double)samples->towards[2][i]);
        const double here = orl_dot(there, b->place->normal);
        if (!(here > 0) ||
            !orl_bounding_rect_passed(&bsdf_pane->window, b->place->point, there, 0, &distance))
            continue;
        const struct orl_vec3 point = orl_madd(b->place->point, there, distance);
        struct orl_hit hit;
        const double seen =
            b->sight >= 0
                ? b->sight
                : orl_luma(orl_transmittance_to_facet(bsdf_panes->lit_scene, b->place->point, there,
                                                      true, bsdf_pane->window.facet, &hit));
        const double of_disc[2] = {(double)d->from[0], (double)d->from[1]};
        const struct orl_vec3 from = orl_sun_sample(disc, of_disc);
        const double share = seen > 0 ? seen * sun_at(b, which, from, point) : 0;
        if (!(share > 0))
            continue;
        const double leaving = -orl_dot(there, bsdf_pane->inward);
        const double of_points = POINTS * distance * distance / (leaving * bsdf_pane->area);
        const double of_samples = SAMPLES * (double)d->density;
        batches[i % BATCHES] += of_samples / (of_samples + of_points) * (double)d->light * here *
                                share * BATCHES / SAMPLES;
    }
}

/* Adds the light of one sun through one pane: the mean of the batches, and its variance. */
static void add_sun(const struct pane_view *b, size_t sun,
                    const struct orl_sensor_sunlight *sunlight)
{
    const struct orl_sun disc = orl_bsdf_pane_sun_disc(&b->bsdf_panes->suns->at[sun]);
    double batches[BATCHES] = {0}, mean = 0, spread = 0;
    add_points(b, sun, &disc, orl_mix64(b->name ^ orl_mix64(sun * 64 + b->pane)), batches);
    add_samples(b, sun, &disc, batches);
    for (int g = 0; g < BATCHES; g++)
        mean += batches[g] / BATCHES;
    for (int g = 0; g < BATCHES; g++)
        spread += (batches[g] - mean) * (batches[g] - mean) / (BATCHES * (BATCHES - 1.0));
    orl_sensor_sunlight_add(sunlight, b->bsdf_pane->window_group, ORL_SUNLIGHT_DIRECT, sun, mean);
    orl_sensor_sunlight_add(sunlight, b->bsdf_pane->window_group, ORL_SUNLIGHT_VARIANCE, sun,
                            spread);
}

void orl_bsdf_panes_add(const struct orl_bsdf_panes *bsdf_panes,
                        const struct orl_shading_point *place, uint64_t name,
                        const struct orl_thread_pool *pool,
                        const struct orl_sensor_sunlight *sunlight)
{
    for (size_t pane = 0; pane < bsdf_panes->count && !orl_thread_pool_cancelled(pool); pane++) {
        struct pane_view b = {.bsdf_panes = bsdf_panes,
                              .bsdf_pane = &bsdf_panes->at[pane],
                              .place = place,
                              .pane = pane,
                              .name = name};
        const struct orl_vec3 from = orl_sub(place->point, b.bsdf_pane->window.corner);
        const unsigned char *wanted =
            sunlight->wanted
                ? sunlight->wanted + b.bsdf_pane->window_group * bsdf_panes->suns->count
                : NULL;
        if (place->outside || !(orl_dot(from, b.bsdf_pane->inward) > 0))
            continue;
        sample_pane_points(&b, name);
        find_cone(&b);
        for (size_t c = 0; b.any && c < bsdf_panes->suns->count; c++)
            if (bsdf_panes->suns->at[c].wanted && (!wanted || wanted[c]) &&
                orl_dot(bsdf_panes->suns->at[c].towards, b.bsdf_pane->inward) < 0 &&
                sunlight_everywhere(bsdf_panes, pane, c) != 0)
                add_sun(&b, c, sunlight);
    }
}
