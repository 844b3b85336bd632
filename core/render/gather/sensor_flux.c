#include "render/gather/sensor_flux.h"

#include <stdlib.h>

#include "scene/material/scatter.h"

enum { WIDTHS = 8, TASK = 8192, FIRST_ROUND = ORL_SENSOR_FLUX_FIRST_ROUND, TASKS_A_ROUND = 64 };

/* Radius of the widest disc: in radii of a search among caustic photons, and the most as a share of
 * the scene's radius. */
static const double wider = 4, widest_of_scene = 0.1;
/*
 * Without a search radius: the widest disc's radius as a share of the distance to the surroundings.
 * above: the disc's height above a surface that the sensor may lie on, as a share of the disc's
 * radius.
 */
static const double widest_of_distance = 0.2, above = 1e-3;
enum { LOOKS = 64 };

/* Rounds end when this share of the sensors has an error small beside that of their other light, or
 * beside all of their light. */
static const double beside_rest = 0.5, beside_light = 0.01, almost_all = 0.95;

/* A difference of more standard errors than this is no scatter. */
static const double certain = 3.5;

/* Light changes a sensor if it exceeds this many of the sensor's standard errors, its own error
 * included. */
static const double felt = 2;

/* Flux through one ring of a disc, between the next narrower width and its own. */
struct ring {
    struct orl_rgb flux;
    float luma[ORL_MAP_BATCHES], lamps; /* luma, by batch and of lamps */
};

struct sensor {
    struct orl_estimate rest;
    uint32_t disc; /* index of its disc, or NONE */
};

#define NONE UINT32_MAX

struct orl_sensor_flux {
    const struct orl_lit_scene *lit_scene;
    /* True if it measures what paths find only by chance, at all sensors; false if it measures
     * caustics, at sensors in free space. */
    bool unsampled_only;
    const struct orl_gather *gather; /* of the caustics; set unless unsampled_only */
    size_t n_sensors;
    struct sensor *sensors;
    struct orl_counting_disc *discs; /* one per sensor; after compact_discs the first n_discs */
    size_t n_discs;
    struct ring (*rings)[WIDTHS];
    uint64_t emitted, rays;
    double flux, photons; /* emitted luma, and number of photons emitted */
};

/* ---- Discs ----------------------------------------------------------------------------------- */

int orl_sensor_flux_new(const struct orl_gather *gather, size_t sensors,
                        struct orl_sensor_flux **ret_flux)
{
    *ret_flux = NULL;
    if (sensors == 0 || !gather->maps[ORL_MAP_CAUSTIC] ||
        !orl_sensor_flux_may_exist(gather->lit_scene))
        return 0;
    const int code = orl_sensor_flux_new_unsampled(gather->lit_scene, sensors, ret_flux);
    if (code < 0)
        return code;
    (*ret_flux)->unsampled_only = false;
    (*ret_flux)->gather = gather;
    return 0;
}

int orl_sensor_flux_new_unsampled(const struct orl_lit_scene *lit_scene, size_t sensors,
                                  struct orl_sensor_flux **ret_flux)
{
    struct orl_sensor_flux *sensor_flux = calloc(1, sizeof *sensor_flux);
    *ret_flux = NULL;
    if (!sensor_flux)
        return ORL_ERR_NOMEM;
    sensor_flux->lit_scene = lit_scene;
    sensor_flux->unsampled_only = true;
    sensor_flux->n_sensors = sensors;
    sensor_flux->sensors = calloc(sensors, sizeof *sensor_flux->sensors);
    sensor_flux->discs = calloc(sensors, sizeof *sensor_flux->discs);
    if (!sensor_flux->sensors || !sensor_flux->discs) {
        orl_sensor_flux_free(sensor_flux);
        return ORL_ERR_NOMEM;
    }
    *ret_flux = sensor_flux;
    return 0;
}

void orl_sensor_flux_free(struct orl_sensor_flux *sensor_flux)
{
    if (!sensor_flux)
        return;
    free(sensor_flux->sensors);
    free(sensor_flux->discs);
    free(sensor_flux->rings);
    free(sensor_flux);
}

/* Returns the median distance of surfaces on the lit side. */
static double distance_about(const struct orl_geometry *g, const struct orl_shading_point *place)
{
    double met[LOOKS];
    int n = 0;
    for (int i = 0; i < LOOKS; i++) {
        const double u = (i + 0.5) / LOOKS, v = i * 0.6180339887498949;
        const struct orl_vec3 out = orl_hemisphere_about(place->normal, u, v - floor(v));
        struct orl_hit hit;
        int at = n;
        if (!orl_geometry_intersect(g, place->point, out, INFINITY, &hit))
            continue;
        for (; at > 0 && met[at - 1] > hit.distance; at--)
            met[at] = met[at - 1];
        met[at] = hit.distance;
        n++;
    }
    return n > 0 ? met[n / 2] : INFINITY;
}

/* Returns true if light close to it may vary more than discs can resolve: a lens or curved
 * mirror. */
static bool may_focus(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit)
{
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    const enum orl_surface_kind kind = orl_facet_kind(lit_scene->geometry, hit->facet);
    return orl_material_deviates(m) ||
           (!orl_surface_kind_is_flat(kind) && orl_material_is_mirror(m));
}

/* Makes the disc of a place. Objects that stand in its plane reduce the reach of its sectors. */
static void make_disc(const struct orl_sensor_flux *sensor_flux,
                      const struct orl_shading_point *place, struct orl_counting_disc *ret_disc)
{
    const struct orl_geometry *g = sensor_flux->lit_scene->geometry;
    const double by_itself = sensor_flux->unsampled_only
                                 ? widest_of_distance * distance_about(g, place)
                                 : wider * sensor_flux->gather->max_radius[ORL_MAP_CAUSTIC];
    const double radius = fmin(by_itself, widest_of_scene * g->radius);
    *ret_disc = (struct orl_counting_disc){
        .center =
            orl_madd(place->point, place->normal, sensor_flux->unsampled_only ? above * radius : 0),
        .frame = orl_frame_about(place->normal),
        .radius = radius,
        .curved_distance = INFINITY};
    for (int i = 0; i < ORL_COUNTING_DISC_SECTORS; i++) {
        const double phi = 2 * ORL_PI * (i + 0.5) / ORL_COUNTING_DISC_SECTORS;
        const struct orl_vec3 out =
            orl_add(orl_scale(ret_disc->frame.u, cos(phi)), orl_scale(ret_disc->frame.v, sin(phi)));
        struct orl_hit hit;
        const bool ends = orl_geometry_intersect(g, ret_disc->center, out, radius, &hit);
        const double reach = ends ? fmin(hit.distance, radius) : radius;
        ret_disc->reach2[i] = (float)(reach * reach);
        if (ends && may_focus(sensor_flux->lit_scene, &hit))
            ret_disc->curved_distance = fminf(ret_disc->curved_distance, (float)hit.distance);
    }
}

void orl_sensor_flux_set_sensor(struct orl_sensor_flux *sensor_flux, size_t sensor,
                                const struct orl_shading_point *place,
                                const struct orl_estimate *rest)
{
    sensor_flux->sensors[sensor] = (struct sensor){.rest = *rest, .disc = NONE};
    if (!sensor_flux->unsampled_only && !orl_gather_has_free_caustics(sensor_flux->gather, place))
        return;
    sensor_flux->sensors[sensor].disc = (uint32_t)sensor;
    make_disc(sensor_flux, place, &sensor_flux->discs[sensor]);
}

bool orl_sensor_flux_is_needed(const struct orl_sensor_flux *sensor_flux)
{
    for (size_t i = 0; sensor_flux && i < sensor_flux->n_sensors; i++)
        if (sensor_flux->sensors[i].disc != NONE)
            return true;
    return false;
}

/* Moves the discs that exist to the front and allocates their rings. */
static int compact_discs(struct orl_sensor_flux *sensor_flux)
{
    sensor_flux->n_discs = 0;
    for (size_t i = 0; i < sensor_flux->n_sensors; i++) {
        if (sensor_flux->sensors[i].disc == NONE)
            continue;
        sensor_flux->discs[sensor_flux->n_discs] = sensor_flux->discs[i];
        sensor_flux->sensors[i].disc = (uint32_t)sensor_flux->n_discs++;
    }
    sensor_flux->rings = calloc(sensor_flux->n_discs + 1, sizeof *sensor_flux->rings);
    return sensor_flux->rings ? 0 : ORL_ERR_NOMEM;
}

/* ---- Photons --------------------------------------------------------------------------------- */

struct round {
    const struct orl_shoot_env *env;
    uint64_t first, end;
    struct orl_deposits deposits[TASKS_A_ROUND];
};

static void trace_task(void *arg, size_t index, uint32_t member)
{
    struct round *round = arg;
    const uint64_t first = round->first + index * TASK;
    const uint64_t end = first + TASK < round->end ? first + TASK : round->end;
    (void)member;
    for (uint64_t photon = first; photon < end && !orl_is_cancelled(round->env->cancel);)
        photon += orl_shoot_chunk(round->env, ORL_MAP_CAUSTIC, photon, end - photon,
                                  &round->deposits[index]);
}

/* Returns the squared width as a share of the disc's. Each width has twice the area of the one
 * before. */
static double width2(int width)
{
    return 1.0 / (1 << (WIDTHS - 1 - width));
}

static void add_pass(struct orl_sensor_flux *sensor_flux, const struct orl_disc_crossing *crossing)
{
    const double radius = sensor_flux->discs[crossing->disc].radius;
    const struct orl_rgb flux = {(double)crossing->flux[0], (double)crossing->flux[1],
                                 (double)crossing->flux[2]};
    int width = 0;
    while (width < WIDTHS - 1 && (double)crossing->distance2 >= width2(width) * radius * radius)
        width++;
    struct ring *ring = &sensor_flux->rings[crossing->disc][width];
    ring->flux = orl_rgb_add(ring->flux, flux);
    ring->luma[crossing->batch] += (float)orl_luma(flux);
    ring->lamps += crossing->lamp ? (float)orl_luma(flux) : 0;
}

/* Traces a round. Tasks are added in order, so that sums do not depend on the number of threads. */
static int trace_round(struct orl_sensor_flux *sensor_flux, struct round *round,
                       const struct orl_counting_discs *discs, struct orl_health *health)
{
    const size_t tasks = (round->end - round->first + TASK - 1) / TASK;
    int code = 0;
    for (size_t i = 0; i < tasks; i++)
        round->deposits[i] =
            (struct orl_deposits){.discs = discs, .unsampled_only = sensor_flux->unsampled_only};
    orl_parallel_for(round->env->pool, tasks, trace_task, round);
    if (orl_is_cancelled(round->env->cancel))
        code = ORL_ERR_CANCELLED;
    for (size_t i = 0; i < tasks; i++) {
        struct orl_deposits *deposits = &round->deposits[i];
        const struct orl_health counted = deposits->health;
        health->photons += counted.photons;
        health->rays += counted.rays;
        health->paths += counted.paths;
        sensor_flux->rays += counted.rays;
        sensor_flux->flux += orl_sum_value(&deposits->flux);
        sensor_flux->photons += (double)counted.photons;
        if (deposits->crossings.out_of_memory)
            code = ORL_ERR_NOMEM;
        for (size_t k = 0; k < deposits->crossings.count && code == 0; k++)
            add_pass(sensor_flux, &deposits->crossings.crossings[k]);
        free(deposits->crossings.crossings);
        free(deposits->photons);
    }
    sensor_flux->emitted = code == 0 ? round->end : sensor_flux->emitted;
    return code;
}

/* ---- Estimates ------------------------------------------------------------------------------- */

/* Flux through a whole width. */
struct disc_reading {
    struct orl_rgb irradiance;
    struct orl_batches parts;
    double area, variance, bias;
    double lamps; /* luma of the lamps' part */
};

static double area_of(const struct orl_counting_disc *disc, int width)
{
    const double most = width2(width) * disc->radius * disc->radius;
    double sum = 0;
    for (int i = 0; i < ORL_COUNTING_DISC_SECTORS; i++)
        sum += fmin((double)disc->reach2[i], most) * ORL_PI / ORL_COUNTING_DISC_SECTORS;
    return sum;
}

static void read_widths(const struct orl_sensor_flux *sensor_flux, uint32_t disc,
                        struct disc_reading ret[WIDTHS])
{
    struct orl_rgb flux = orl_gray(0);
    double luma[ORL_MAP_BATCHES] = {0}, lamps = 0;
    const double one_more = sensor_flux->photons > 0 ? sensor_flux->flux / sensor_flux->photons : 0;
    for (int w = 0; w < WIDTHS; w++) {
        const struct ring *ring = &sensor_flux->rings[disc][w];
        const double area = area_of(&sensor_flux->discs[disc], w),
                     per = 1 / (area * (double)sensor_flux->emitted);
        flux = orl_rgb_add(flux, ring->flux);
        lamps += (double)ring->lamps;
        ret[w] = (struct disc_reading){
            .irradiance = orl_rgb_scale(flux, per), .area = area, .lamps = lamps * per};
        for (int b = 0; b < ORL_MAP_BATCHES; b++) {
            luma[b] += (double)ring->luma[b];
            ret[w].parts.luma[b] = luma[b] * per;
        }
        ret[w].variance = orl_batches_variance(&ret[w].parts) + one_more * per * one_more * per;
    }
}

static struct orl_batches difference(const struct disc_reading *a, const struct disc_reading *b)
{
    struct orl_batches parts = a->parts;
    orl_batches_add(&parts, &b->parts, -1);
    return parts;
}

static double luma_of(const struct orl_batches *parts)
{
    double sum = 0;
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        sum += parts->luma[b];
    return sum;
}

/*
 * Estimates each width's bias: the change from the next area beyond its scatter, in proportion to
 * the area. It is at least the significant difference to any narrower width, because the widest
 * discs do not resolve a focus.
 */
static void find_biases(struct disc_reading readings[WIDTHS])
{
    for (int w = 0; w < WIDTHS; w++) {
        struct disc_reading *here = &readings[w];
        const struct disc_reading *narrow = w < WIDTHS - 1 ? here : here - 1, *wide = narrow + 1;
        const struct orl_batches more = difference(wide, narrow);
        if (wide->area > narrow->area * (1 + 1e-6))
            here->bias = orl_batches_shrink(&more) * here->area / (wide->area - narrow->area);
        for (int k = 0; k < w; k++) {
            const struct orl_batches off = difference(here, &readings[k]);
            const double luma = luma_of(&off);
            if (luma * luma > certain * certain * orl_batches_variance(&off) &&
                fabs(luma) > fabs(here->bias))
                here->bias = luma;
        }
    }
}

/*
 * Returns the expected squared error of a width, to choose by. A width that few photons crossed has
 * little scatter, and choosing by that would miss light. Scatter therefore is at least the widest
 * width's, scaled by area.
 */
static double expected_square(const struct disc_reading readings[WIDTHS], int width)
{
    const struct disc_reading *r = &readings[width], *widest = &readings[WIDTHS - 1];
    return fmax(r->variance, widest->variance * widest->area / r->area) + r->bias * r->bias;
}

/* Returns the widest width that may be chosen. Beside a lens illuminance varies over about the
 * distance to the lens, and the mean over a wider disc is biased. */
static int widest_of(const struct orl_counting_disc *disc)
{
    int w = WIDTHS - 1;
    while (w > 0 && sqrt(width2(w)) * disc->radius > (double)disc->curved_distance)
        w--;
    return w;
}

static struct disc_reading read_disc(const struct orl_sensor_flux *sensor_flux, uint32_t disc)
{
    const struct orl_counting_disc *d = &sensor_flux->discs[disc];
    struct disc_reading readings[WIDTHS];
    int best = widest_of(d);
    read_widths(sensor_flux, disc, readings);
    find_biases(readings);
    for (int w = best; w >= 0; w--)
        if (expected_square(readings, w) < expected_square(readings, best))
            best = w;
    const double luma = orl_luma(readings[best].irradiance);
    /* Light beside a lens is known only as its mean over a disc wider than the distance to the
     * lens. */
    if ((double)d->curved_distance < sqrt(width2(best)) * d->radius &&
        luma > fabs(readings[best].bias))
        readings[best].bias = copysign(luma, readings[best].bias);
    return readings[best];
}

static struct orl_estimate estimate_of(const struct disc_reading *disc_reading)
{
    return (struct orl_estimate){.value = disc_reading->irradiance,
                                 .standard_error = sqrt(disc_reading->variance),
                                 .degrees_of_freedom = ORL_MAP_BATCHES - 1,
                                 .bias = disc_reading->bias};
}

struct orl_estimate orl_sensor_flux_estimate(const struct orl_sensor_flux *sensor_flux,
                                             size_t sensor)
{
    const struct sensor *s = &sensor_flux->sensors[sensor];
    if (s->disc == NONE || sensor_flux->emitted == 0)
        return s->rest;
    const struct disc_reading disc_reading = read_disc(sensor_flux, s->disc);
    return orl_estimate_add(s->rest, estimate_of(&disc_reading));
}

struct orl_estimate orl_sensor_flux_caustics(const struct orl_sensor_flux *sensor_flux,
                                             size_t sensor, double *ret_lamps)
{
    const struct disc_reading disc_reading =
        read_disc(sensor_flux, sensor_flux->sensors[sensor].disc);
    *ret_lamps = disc_reading.lamps;
    return estimate_of(&disc_reading);
}

/* Returns true if the light through the sensor's disc is known well enough. *ret_felt: it changes
 * the sensor's estimate. */
static bool is_accurate(const struct sensor *s, const struct disc_reading *more, bool *ret_felt)
{
    const double luma = orl_luma(more->irradiance), scatter = sqrt(more->variance);
    *ret_felt = luma > felt * hypot(s->rest.standard_error, scatter);
    return scatter <= fmax(beside_rest * s->rest.standard_error,
                           beside_light * (orl_luma(s->rest.value) + luma));
}

/* Returns true if no further round is needed: almost all sensors are known well enough. Beyond
 * rays_not_felt it also suffices that no sensor with a large error is changed by the light. */
static bool rounds_suffice(const struct orl_sensor_flux *sensor_flux, double negligible_rays)
{
    size_t content = 0, feeling = 0;
    for (size_t i = 0; i < sensor_flux->n_sensors; i++) {
        const struct sensor *s = &sensor_flux->sensors[i];
        bool feels;
        if (s->disc == NONE)
            continue;
        const struct disc_reading more = read_disc(sensor_flux, s->disc);
        const bool is = is_accurate(s, &more, &feels);
        content += is;
        feeling += feels && !is;
    }
    return (double)content >= almost_all * (double)sensor_flux->n_discs ||
           (feeling == 0 && 2 * (double)sensor_flux->rays > negligible_rays);
}

int orl_sensor_flux_collect(struct orl_sensor_flux *sensor_flux, const struct orl_shoot_env *env,
                            const struct orl_sensor_flux_limits *bounds, struct orl_health *health)
{
    struct orl_counting_discs *discs = NULL;
    struct round *round = malloc(sizeof *round);
    int code = round ? compact_discs(sensor_flux) : ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_counting_discs_new(sensor_flux->discs, sensor_flux->n_discs, &discs);
    const uint64_t most = bounds->emissions - bounds->emissions % ORL_MAP_BATCHES;
    uint64_t wanted = FIRST_ROUND < most ? FIRST_ROUND : most;
    while (code == 0 && sensor_flux->emitted < most && env->emission->has_caustics) {
        const uint64_t largest = sensor_flux->emitted + (uint64_t)TASK * TASKS_A_ROUND;
        round->env = env;
        round->first = sensor_flux->emitted;
        round->end = wanted < largest ? wanted : largest;
        code = trace_round(sensor_flux, round, discs, health);
        if (code == 0 && sensor_flux->emitted == wanted) {
            if (rounds_suffice(sensor_flux, bounds->negligible_rays))
                break;
            wanted = 2 * wanted < most ? 2 * wanted : most;
        }
    }
    orl_counting_discs_free(discs);
    free(round);
    return code;
}
