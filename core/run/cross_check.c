/*
 * A cross-check of sensors by plain path tracing with shadow rays: no photons, no ports, no rays
 * that are aimed, no caches. Sensors are taken in groups of neighbours; a group's sum by paths is
 * compared with the sum that the technique found. Where the two differ by more than both errors,
 * intervals are widened to include both, a warning says so, and an accuracy does not count as met.
 *
 * Nothing is said of groups whose estimate by paths rests on few of them (the effective number of
 * samples, Kish 1965: (sum x)^2 / sum x^2), such as in rooms with one small window. Paths leave out
 * suns by way of curved mirrors and dielectrics, and seldom meet suns and lamps by way of lobes:
 * where there are such, finding less says nothing.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/random.h"
#include "light/exterior.h"
#include "light/eye_path.h"
#include "plan/decide.h"
#include "run/stages.h"
#include "scene/geometry/placed.h"
#include "scene/geometry/stand.h"
#include "scene/material/bounds.h"
#include "scene/material/hemisphere.h"

enum { MOST_GROUPS = 16, MOST_PATHS = 1 << 14, LEAST_PATHS = 1 << 11, SURE_BOUNCES = 2 };
/* Most shadow rays, counting those to all lights at one surface of each path: the more lights there
 * are, the fewer paths are traced. */
enum { MOST_SHADOW_RAYS = 1 << 17, PATHS_OF_USE = 256, LEAST_PATHS_A_SENSOR = 4 };
/* One path for so many samples of the technique: 2 % of its time, or less. */
enum { SAMPLES_A_PATH = 64 };
static const double least_effective = 30; /* samples */
/* A difference counts beyond so many joint standard errors, and such a share of the light. */
static const double differs_in_errors = 5, differs_by = 0.1;
static const double bound_in_errors = 2;

/* ---- One path -------------------------------------------------------------------------------- */

struct trip {
    struct orl_eye_path eye; /* first: what sinks are given */
    struct orl_health *health;
    uint32_t reflections, most_reflections; /* diffuse ones */
};

static struct trip *trip_of(struct orl_eye_path *p)
{
    return (struct trip *)p;
}

static bool come_in(struct orl_eye_path *p)
{
    return orl_exterior_pass(p, trip_of(p)->health);
}

/* Adds what the surface shines, and reflects of suns and lamps. */
static enum orl_lobes shade_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    const struct trip *t = trip_of(p);
    const struct orl_world *world = p->world;
    const struct orl_vec3 eye = orl_path_back(&p->path), normal = orl_hit_facing(&p->hit);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    const bool reflects = t->reflections < t->most_reflections;
    orl_eye_path_see(p, orl_shining(world, &p->hit, eye, &p->chance));
    if (orl_rgb_max(albedo) > 0 && reflects) {
        const struct orl_direct_query query = {.point =
                                                   orl_hit_leave(world->geometry, &p->hit, normal),
                                               .normal = normal,
                                               .through_ports = true,
                                               .mirrored = true};
        orl_eye_path_see(
            p, orl_rgb_scale(orl_rgb_mul(albedo, orl_direct_light(world, &query, p->random)),
                             1 / ORL_PI));
    }
    if (orl_material_has_lobes(m))
        orl_eye_path_see(p, orl_direct_by_lobes(world, &p->hit, m, eye, p->random));
    return reflects ? ORL_LOBE_ALL : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
}

static bool send_on(struct orl_eye_path *p, const struct orl_scatter *s)
{
    struct trip *t = trip_of(p);
    if (p->bounce >= SURE_BOUNCES &&
        !orl_path_survives(&p->path, orl_smaller(orl_rgb_max(p->path.weight), 1), p->random))
        return false;
    p->chance = orl_chance_after(p->world, &p->hit, orl_path_back(&p->path), s, p->chance);
    t->reflections += s->event == ORL_EVENT_DIFFUSE;
    orl_eye_path_cross(p, s);
    return true;
}

static const struct orl_eye_sink sink = {.outdoors = come_in, .met = shade_hit, .sent_on = send_on};

/* One estimate of the irradiance at a place. */
static double trace(const struct orl_world *world, const struct orl_place *place,
                    uint32_t most_reflections, struct orl_random *random, struct orl_health *health)
{
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const struct orl_direct_query query = {
        .point = place->point, .normal = place->normal, .through_ports = true, .mirrored = true};
    struct trip trip = {
        .eye = {.world = world,
                .random = random,
                .path = orl_path_from(place->point, orl_hemisphere_about(place->normal, u0, u1)),
                .chance = orl_chance_found(),
                .outside = place->outside},
        .health = health,
        .most_reflections = most_reflections};
    orl_eye_path_follow(&trip.eye, &sink, health);
    return orl_luma(
        orl_rgb_add(orl_direct_light(world, &query, random), orl_rgb_scale(trip.eye.seen, ORL_PI)));
}

/* ---- Groups of sensors ----------------------------------------------------------------------- */

struct group {
    size_t first, count;
    size_t traced;        /* sensors that paths were traced for */
    double sum, variance; /* lx, of these sensors' means by paths */
    double effective;
};

struct check {
    const struct orl_run_state *state;
    uint32_t paths; /* a sensor */
    size_t stride;  /* between sensors of a group that paths are traced for */
    size_t n_groups;
    struct group groups[MOST_GROUPS];
    struct orl_health health[MOST_GROUPS]; /* of paths that reach no result */
};

static void trace_sensor(struct check *check, struct group *group, size_t sensor,
                         struct orl_health *health, double *sums)
{
    const struct orl_run_state *state = check->state;
    const struct orl_world *world = state->world;
    const struct orl_vec3 position =
        orl_sub(state->sensors[sensor].position, world->geometry->center);
    struct orl_place place = {.normal = orl_normalize(state->sensors[sensor].direction)};
    double sum = 0, squares = 0;
    place.point = orl_stand(world->geometry, position, place.normal);
    place.outside = orl_world_is_outside(world, place.point);
    for (uint32_t i = 0; i < check->paths && !orl_is_cancelled(state->env->cancel); i++) {
        struct orl_random random = orl_random_stream(state->job->seed, ORL_PURPOSE_CROSS_CHECK,
                                                     (uint64_t)sensor * check->paths + i);
        const double lx =
            ORL_EFFICACY_LM_PER_W *
            trace(world, &place, state->result->plan.most_reflections, &random, health);
        sum += lx;
        squares += lx * lx;
    }
    const double n = check->paths, mean = sum / n;
    group->sum += mean;
    group->variance += fmax(squares / n - mean * mean, 0) / (n - 1);
    sums[0] += sum;
    sums[1] += squares;
}

static void trace_group(void *arg, size_t index, uint32_t member)
{
    struct check *check = arg;
    struct group *group = &check->groups[index];
    double sums[2] = {0, 0};
    (void)member;
    for (size_t i = group->first; i < group->first + group->count; i += check->stride) {
        trace_sensor(check, group, i, &check->health[index], sums);
        group->traced++;
    }
    group->effective = sums[1] > 0 ? sums[0] * sums[0] / sums[1] : 0;
}

/*
 * Returns true if paths find all light, and often: nothing bends or focuses it, flat mirrors have
 * images of all suns and lamps, and no lobe sends on a sun or lamp, which paths from a sensor meet
 * in few directions; so few that their scatter may not tell that there is such light.
 */
static bool paths_find_all(const struct orl_world *world)
{
    bool lights = world->n_suns > 0;
    if (world->images.n_left_out > 0 || world->lamp_images.left_out > 0)
        return false;
    for (size_t i = 0; i < world->n_emitters && !lights; i++)
        lights = world->emitters[i].direct;
    for (struct orl_kept_walk walk = orl_kept_walk(world->geometry); orl_kept_next(&walk);) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_of(world->geometry, walk.facet, &room);
        const struct orl_material *m = &world->materials[f->material];
        const bool flat = f->kind == ORL_SURFACE_POLYGON || f->kind == ORL_SURFACE_RING;
        if (orl_material_bends(m) || (orl_material_is_mirror(m) && (!flat || m->texture)) ||
            (lights && orl_material_has_lobes(m)))
            return false;
    }
    return true;
}

/* Sums of values, and of half their intervals as standard errors: those of neighbours go along. */
static void sum_results(const struct orl_result *r, const struct group *group, size_t stride,
                        double *ret_lx, double *ret_error)
{
    *ret_lx = *ret_error = 0;
    for (size_t i = group->first; i < group->first + group->count; i += stride) {
        *ret_lx += r->illuminance_lx[i];
        *ret_error += (r->interval_95_lx[i][1] - r->interval_95_lx[i][0]) / (2 * 1.96);
    }
}

/* Widens the group's intervals to the bound of what paths have found: each sensor's in proportion
 * to its value, or where none has any light by the mean. Returns true if it had to. */
static bool judge_group(struct orl_result *r, const struct group *group, size_t stride,
                        bool paths_find_all)
{
    double lx, error;
    sum_results(r, group, stride, &lx, &error);
    const double off = group->sum - lx, scatter = sqrt(group->variance);
    if (group->effective < least_effective ||
        fabs(off) < differs_in_errors * hypot(scatter, error) || fabs(off) < differs_by * lx ||
        (off < 0 && !paths_find_all))
        return false;
    const double sum = off > 0 ? group->sum + bound_in_errors * scatter
                               : fmax(group->sum - bound_in_errors * scatter, 0);
    for (size_t i = group->first; i < group->first + group->count; i++) {
        double *const interval = r->interval_95_lx[i];
        const double bound = lx > 0 ? r->illuminance_lx[i] * sum / lx : sum / (double)group->traced;
        interval[0] = fmin(interval[0], bound);
        interval[1] = fmax(interval[1], bound);
    }
    return true;
}

/* Returns the ratio of a group's light by paths to its light by the technique, at most 1000. */
static double ratio_of(const struct group *group, double lx)
{
    return group->sum / fmax(lx, 1e-3 * group->sum);
}

static void warn_of_worst(struct orl_run_state *state, const struct group *worst, double ratio)
{
    struct orl_result *r = state->result;
    const enum orl_technique technique = r->plan.technique;
    orl_run_warn(state,
                 "cross-check: plain path tracing finds %.2g times the light that technique %s has "
                 "found at %zu sensor%s from sensors[%zu] on, beyond the errors of both; intervals "
                 "of %zu sensor%s are widened to include it. Compare with technique %s",
                 ratio, orl_technique_name(technique), worst->count, orl_plural(worst->count),
                 worst->first, r->cross_check.sensors_off, orl_plural(r->cross_check.sensors_off),
                 technique == ORL_TECHNIQUE_BACKWARD ? "gather" : "backward");
}

static void judge(struct orl_run_state *state, const struct check *check)
{
    struct orl_result *r = state->result;
    struct orl_cross_check *c = &r->cross_check;
    const bool find_all = paths_find_all(state->world);
    const struct group *worst = NULL;
    double all = 0, by_paths = 0, variance = 0, worst_ratio = 1;
    for (size_t g = 0; g < check->n_groups; g++) {
        const struct group *group = &check->groups[g];
        double lx, error;
        c->paths += (uint64_t)check->paths * group->traced;
        if (group->effective < least_effective)
            continue;
        sum_results(r, group, check->stride, &lx, &error);
        c->sensors += group->traced;
        all += lx;
        by_paths += group->sum;
        variance += group->variance;
        if (!judge_group(r, group, check->stride, find_all))
            continue;
        c->sensors_off += group->count;
        for (size_t i = group->first; i < group->first + group->count; i++)
            orl_run_doubt(state, i, ORL_DOUBT_CROSS_CHECK);
        if (!worst || fabs(log(ratio_of(group, lx))) > fabs(log(worst_ratio))) {
            worst_ratio = ratio_of(group, lx);
            worst = group;
        }
    }
    const bool known = all > 0 && (find_all || by_paths >= all);
    c->ratio = known ? by_paths / all : NAN;
    c->ratio_error = known ? sqrt(variance) / all : NAN;
    if (worst)
        warn_of_worst(state, worst, worst_ratio);
}

/* Effects that the job leaves out on demand would be in the light of the paths. */
static bool leaves_out_on_demand(const struct orl_job *job)
{
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        if (job->wishes[i] == ORL_WISH_SKIP)
            return true;
    return false;
}

/* Returns the most shadow rays that one surface takes. */
static double count_lights(const struct orl_world *world)
{
    return 1 + (double)(world->n_suns + world->images.n_nodes + world->n_emitters +
                        world->lamp_images.n_images);
}

int orl_run_cross_check(struct orl_run_state *state, struct orl_error *err)
{
    struct check check = {.state = state};
    const size_t n = state->n_sensors;
    if (n == 0 || state->result->n_sensors != n || leaves_out_on_demand(state->job) ||
        state->world->scene->mist || orl_world_seen(state->world) != state->world)
        return 0;
    double samples = 0;
    for (size_t i = 0; i < n; i++)
        samples += state->samples > 0 ? state->samples : orl_run_sensor_samples(state, i);
    const double most = fmin(MOST_PATHS, MOST_SHADOW_RAYS / count_lights(state->world));
    const double wanted = fmin(fmax(samples / SAMPLES_A_PATH, LEAST_PATHS), most);
    if (wanted < PATHS_OF_USE)
        return 0;
    check.stride = (size_t)ceil((double)n * LEAST_PATHS_A_SENSOR / wanted);
    check.paths = (uint32_t)(wanted / ceil((double)n / (double)check.stride));
    check.n_groups = n < MOST_GROUPS ? n : MOST_GROUPS;
    for (size_t g = 0; g < check.n_groups; g++) {
        check.groups[g].first = n * g / check.n_groups;
        check.groups[g].count = n * (g + 1) / check.n_groups - check.groups[g].first;
    }
    const int code = orl_crew_try(state->env->crew, check.n_groups, trace_group, &check);
    if (code < 0)
        return orl_error_set(err, code, "%s", "cancelled while checking sensors by paths");
    judge(state, &check);
    return 0;
}
