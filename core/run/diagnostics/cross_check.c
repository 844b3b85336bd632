/*
 * Cross-check of sensors by plain path tracing: the paths, the verdict on groups of sensors, and
 * the check itself.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/input_checks.h>
#include <oriel/job/paths.h>
#include <oriel/job/run.h>

#include "base/sampling/sampling.h"
#include "light/exterior.h"
#include "light/eye_path.h"
#include "light/lit_scene.h"
#include "plan/decide.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"
#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"

/*
 * Cross-check of sensors by plain path tracing with shadow rays. Sensors form groups of
 * neighbours. For each group the sum by paths is compared with that of the technique.
 *
 * Paths omit suns reflected or refracted by curved mirrors and dielectrics, and rarely hit suns and
 * lamps through lobes. With such light, a smaller sum by paths means nothing.
 */

/*
 * Plain path tracing from a sensor for the cross-check, without photons, ports, importance-sampled
 * rays or caches. The light that a path finds is summed by class, which says how it reached the
 * sensor.
 */

enum { SURE_BOUNCES = 2 };

/* One estimate of the irradiance at a place, lx, by class. */
struct orl_plain_light {
    double lx[ORL_LIGHT_CLASSES];
};

struct plain_path {
    struct orl_eye_path eye; /* must be first: visitors receive a pointer to it */
    struct orl_health *health;
    uint32_t reflections, most_reflections; /* number of diffuse reflections, and its limit */
    /* Radiance before the first diffuse reflection: suns and lamps that surfaces on the path
     * reflect diffusely (lit), and the rest, which is set at that reflection. */
    struct orl_rgb lit, unreflected;
};

static struct plain_path *plain_path_of(struct orl_eye_path *p)
{
    return (struct plain_path *)p;
}

static struct orl_rgb subtract(struct orl_rgb a, struct orl_rgb b)
{
    return orl_rgb_add(a, orl_rgb_scale(b, -1));
}

static bool continue_outdoors(struct orl_eye_path *p)
{
    return orl_exterior_continue(p, plain_path_of(p)->health);
}

/* Returns the radiance that a diffuse surface reflects of suns and lamps. */
static struct orl_rgb lit_by_lights(struct orl_eye_path *p, struct orl_rgb albedo)
{
    const struct orl_vec3 normal = orl_hit_facing(&p->hit);
    const struct orl_direct_query query = {
        .point = orl_hit_ray_origin(p->lit_scene->geometry, &p->hit, normal),
        .normal = normal,
        .through_ports = true,
        .mirrored = true};
    return orl_rgb_scale(orl_rgb_mul(albedo, orl_direct_light(p->lit_scene, &query, p->random)),
                         1 / ORL_PI);
}

/* Adds the light that the surface emits, and that it reflects of suns and lamps. */
static enum orl_lobes shade_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    struct plain_path *t = plain_path_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    const bool reflects = t->reflections < t->most_reflections;
    orl_eye_path_add_radiance(p, orl_emitted_radiance(p->lit_scene, &p->hit, eye, &p->chance));
    if (orl_rgb_max(albedo) > 0 && reflects) {
        const struct orl_rgb before = p->seen;
        orl_eye_path_add_radiance(p, lit_by_lights(p, albedo));
        if (t->reflections == 0)
            t->lit = orl_rgb_add(t->lit, subtract(p->seen, before));
    }
    if (orl_material_has_lobes(m))
        orl_eye_path_add_radiance(p, orl_direct_by_lobes(p->lit_scene, &p->hit, m, eye, p->random));
    return reflects ? ORL_LOBE_ALL : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
}

static bool continue_path(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    struct plain_path *t = plain_path_of(p);
    if (p->bounce >= SURE_BOUNCES &&
        !orl_path_roulette(&p->path, orl_smaller(orl_rgb_max(p->path.weight), 1), p->random))
        return false;
    p->chance = orl_mis_pdf_update(p->lit_scene, &p->hit, orl_path_back(&p->path), s, p->chance);
    if (s->event == ORL_EVENT_DIFFUSE && t->reflections++ == 0)
        t->unreflected = subtract(p->seen, t->lit);
    orl_eye_path_cross_port(p, s);
    return true;
}

static const struct orl_path_visitor visitor = {
    .on_outdoors = continue_outdoors, .met = shade_hit, .on_sampled = continue_path};

static double lux_of(struct orl_rgb irradiance)
{
    return ORL_EFFICACY_LM_PER_W * orl_luma(irradiance);
}

/* Adds the light of suns and lamps by shadow rays from the place. The same points of the lights are
 * sampled with mirrors and without, and the difference is the mirrored light. */
static void add_lights(const struct orl_lit_scene *lit_scene, const struct orl_shading_point *place,
                       struct orl_random *random, struct orl_plain_light *light)
{
    const double u0 = orl_random_uniform(random), u[2] = {u0, orl_random_uniform(random)};
    struct orl_direct_query query = {
        .point = place->point, .normal = place->normal, .through_ports = true, .u = u};
    light->lx[ORL_LIGHT_STRAIGHT] = lux_of(orl_direct_light(lit_scene, &query, random));
    if (lit_scene->images.n_mirrors == 0 && lit_scene->virtual_lamps.n_images == 0)
        return;
    query.mirrored = true;
    light->lx[ORL_LIGHT_MIRRORED] =
        lux_of(orl_direct_light(lit_scene, &query, random)) - light->lx[ORL_LIGHT_STRAIGHT];
}

/* Traces one path, with shadow rays at every surface and at most most_reflections diffuse
 * reflections, and returns its estimate. */
static struct orl_plain_light orl_plain_path(const struct orl_lit_scene *lit_scene,
                                             const struct orl_shading_point *place,
                                             uint32_t most_reflections, struct orl_random *random,
                                             struct orl_health *health)
{
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    struct orl_plain_light light = {{0}};
    struct plain_path plain_path = {
        .eye = {.lit_scene = lit_scene,
                .random = random,
                .path = orl_path_from(place->point, orl_hemisphere_about(place->normal, u0, u1)),
                .chance = orl_mis_pdf_zero(),
                .outside = place->outside},
        .health = health,
        .most_reflections = most_reflections};
    add_lights(lit_scene, place, random, &light);
    orl_eye_path_trace(&plain_path.eye, &visitor, health);
    const struct orl_rgb unreflected = plain_path.reflections > 0
                                           ? plain_path.unreflected
                                           : subtract(plain_path.eye.seen, plain_path.lit);
    light.lx[ORL_LIGHT_OUTDOORS] = ORL_PI * lux_of(unreflected);
    light.lx[ORL_LIGHT_REFLECTED] = ORL_PI * lux_of(subtract(plain_path.eye.seen, unreflected));
    return light;
}

/*
 * The verdict of the cross-check: compares groups of sensors by plain paths with
 * the technique's results. The two differ if
 * - a group's sums do, by more than both errors and a tenth of its light; or
 * - the differences of all groups together resemble the light of one class, at least a quarter of
 *   it, by more than their errors. This is a matched filter (North 1943), with each group weighed
 *   by its variance. A class that is missing everywhere shows so before any single group does.
 * Then intervals are widened to include both, sensors are marked as unreliable, and a warning names
 * the class that the differences resemble most.
 *
 * Groups are not compared if their estimate by paths rests on few of them (the effective number of
 * samples, Kish 1965: (sum x)^2 / sum x^2), such as in rooms with one small window.
 *
 * Reference: North 1943, An analysis of the factors which determine signal/noise discrimination
 * (reprinted in Proceedings of the IEEE 51, 1963, 1016).
 */

/* Neighbouring sensors, of which every stride-th was traced by paths. */
struct orl_plain_group {
    size_t first, count;
    size_t traced;                     /* sensors that paths were traced for */
    double sum, variance;              /* lx, of these sensors' means by paths */
    double classes[ORL_LIGHT_CLASSES]; /* parts of the sum, by class */
    double effective;                  /* effective number of samples */
};

struct orl_plain_groups {
    const struct orl_plain_group *groups;
    size_t count, stride;
    uint32_t paths; /* paths per traced sensor */
    bool find_all;  /* true if paths find all light, with a sufficient probability */
};

static const double least_effective = 30; /* effective number of samples */
/* A difference counts beyond so many joint standard errors, and such a share of the light. */
static const double differs_in_errors = 5, differs_by = 0.1;
/* A difference of a class counts if it is this share of the class's light. It is attributed to
 * groups in which it is also this share of all light. */
static const double differs_by_class = 0.25, matters = 0.05;
static const double bound_in_errors = 2;

/* A group, with the technique's result for the same sensors. */
struct compared {
    const struct orl_plain_group *group;
    double lx; /* sum of the technique's values */
    /* Sum of the standard errors implied by the intervals; those of neighbours are assumed
     * correlated. */
    double error;
};

static struct compared compare_group(const struct orl_result *r,
                                     const struct orl_plain_groups *groups, size_t index)
{
    struct compared c = {.group = &groups->groups[index]};
    const size_t end = c.group->first + c.group->count;
    for (size_t i = c.group->first; i < end; i += groups->stride) {
        c.lx += r->illuminance_lx[i];
        c.error += (r->interval_95_lx[i][1] - r->interval_95_lx[i][0]) / (2 * 1.96);
    }
    return c;
}

static bool is_known(const struct compared *c)
{
    return c->group->effective >= least_effective;
}

static double variance_of(const struct compared *c)
{
    return c->group->variance + c->error * c->error;
}

/* ---- Classes --------------------------------------------------------------------------------- */

/* Least-squares fit of the differences of all groups by the light of one class. */
struct match {
    double share;  /* the factor of the class's light: 1 if all of it is missing */
    double errors; /* that factor over its standard error */
};

static struct match match_class(const struct orl_result *r, const struct orl_plain_groups *groups,
                                int light)
{
    double product = 0, squares = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const struct compared c = compare_group(r, groups, g);
        const double variance = variance_of(&c), lx = c.group->classes[light];
        if (!is_known(&c) || !(variance > 0))
            continue;
        product += (c.group->sum - c.lx) * lx / variance;
        squares += lx * lx / variance;
    }
    return squares > 0 ? (struct match){product / squares, product / sqrt(squares)}
                       : (struct match){0, 0};
}

/* Returns the class whose fit is the most significant. */
static enum orl_light_class find_class(const struct orl_result *r,
                                       const struct orl_plain_groups *groups,
                                       struct match *ret_match)
{
    enum orl_light_class best = ORL_LIGHT_STRAIGHT;
    *ret_match = (struct match){0, 0};
    for (int light = 0; light < ORL_LIGHT_CLASSES; light++) {
        const struct match match = match_class(r, groups, light);
        if (fabs(match.errors) <= fabs(ret_match->errors))
            continue;
        best = (enum orl_light_class)light;
        *ret_match = match;
    }
    return best;
}

const char *orl_light_class_name(enum orl_light_class light)
{
    static const char *const names[] = {"direct light of suns and lamps",
                                        "mirrored light of suns and lamps",
                                        "direct light from outdoors", "reflected light"};
    return names[light];
}

/* ---- Groups ---------------------------------------------------------------------------------- */

/* Widens the group's intervals to include `sum` and marks its sensors. Each sensor's bound is in
 * proportion to its value, or the mean if none has any light. */
static void widen_group(struct orl_run_state *state, const struct compared *c, double sum)
{
    struct orl_result *r = state->result;
    const struct orl_plain_group *group = c->group;
    for (size_t i = group->first; i < group->first + group->count; i++) {
        double *const interval = r->interval_95_lx[i];
        const double bound =
            c->lx > 0 ? r->illuminance_lx[i] * sum / c->lx : sum / (double)group->traced;
        interval[0] = fmin(interval[0], fmax(bound, 0));
        interval[1] = fmax(interval[1], bound);
        orl_run_mark_unreliable(state, i, ORL_DOUBT_CROSS_CHECK);
    }
    r->cross_check.sensors_off += group->count;
}

/* The class that best fits the differences of all groups. If match.share is 0, no class fits well
 * enough to count. */
struct verdict {
    enum orl_light_class light;
    struct match match;
};

/* Returns true if the group differs, by itself or as part of a class, and has widened it then. */
static bool evaluate_group(struct orl_run_state *state, const struct compared *c, bool find_all,
                           const struct verdict *verdict)
{
    const double off = c->group->sum - c->lx, scatter = sqrt(c->group->variance);
    const double of_class = verdict->match.share * c->group->classes[verdict->light];
    const bool by_itself = fabs(off) >= differs_in_errors * sqrt(variance_of(c)) &&
                           fabs(off) >= differs_by * c->lx && (off > 0 || find_all);
    if (!by_itself && !(fabs(of_class) >= matters * c->lx))
        return false;
    const double difference = by_itself ? off : of_class;
    const double by_paths = c->group->sum + copysign(bound_in_errors * scatter, difference);
    const double by_class = c->lx + of_class * (1 + bound_in_errors / fabs(verdict->match.errors));
    const double sum = by_itself        ? by_paths
                       : difference > 0 ? fmax(by_paths, by_class)
                                        : fmin(by_paths, by_class);
    widen_group(state, c, sum);
    return true;
}

/* Returns the ratio of a group's light by paths to its light by the technique, at most 1000. */
static double ratio_of(const struct compared *c)
{
    return c->group->sum / fmax(c->lx, 1e-3 * c->group->sum);
}

static void warn_of_worst(struct orl_run_state *state, const struct compared *worst)
{
    struct orl_result *r = state->result;
    const enum orl_technique technique = r->plan.technique;
    const struct orl_plain_group *group = worst->group;
    orl_run_warn(state,
                 "cross-check: plain path tracing finds %.2g times the light that technique %s "
                 "finds at %zu sensor%s from sensors[%zu] on, more than the errors of both "
                 "explain; the difference resembles the %s. Intervals of %zu sensor%s are widened "
                 "to include it. Compare with technique %s",
                 ratio_of(worst), orl_technique_name(technique), group->count,
                 orl_plural(group->count), group->first,
                 orl_light_class_name(r->cross_check.differs_in), r->cross_check.sensors_off,
                 orl_plural(r->cross_check.sensors_off),
                 orl_technique_name(orl_technique_facts(technique)->alternative));
}

/* Sets the result's cross_check, widens intervals, marks sensors and warns. */
static void orl_cross_check_evaluate(struct orl_run_state *state,
                                     const struct orl_plain_groups *groups)
{
    struct orl_result *r = state->result;
    struct orl_cross_check *check = &r->cross_check;
    struct verdict verdict;
    struct compared worst = {.group = NULL};
    double all = 0, by_paths = 0, variance = 0;
    verdict.light = check->differs_in = find_class(r, groups, &verdict.match);
    if (fabs(verdict.match.errors) < differs_in_errors ||
        fabs(verdict.match.share) < differs_by_class ||
        (verdict.match.share < 0 && !groups->find_all))
        verdict.match.share = 0;
    for (size_t g = 0; g < groups->count; g++) {
        const struct compared c = compare_group(r, groups, g);
        check->paths += (uint64_t)groups->paths * c.group->traced;
        if (!is_known(&c))
            continue;
        check->sensors += c.group->traced;
        all += c.lx;
        by_paths += c.group->sum;
        variance += c.group->variance;
        if (evaluate_group(state, &c, groups->find_all, &verdict) &&
            (!worst.group || fabs(log(ratio_of(&c))) > fabs(log(ratio_of(&worst)))))
            worst = c;
    }
    const bool known = all > 0 && (groups->find_all || by_paths >= all);
    check->ratio = known ? by_paths / all : NAN;
    check->ratio_error = known ? sqrt(variance) / all : NAN;
    if (worst.group)
        warn_of_worst(state, &worst);
}

enum { MOST_GROUPS = 16, MOST_PATHS = 1 << 14, LEAST_PATHS = 1 << 11 };
/* Maximum of shadow rays, with those to all lights at one surface of each path: more lights reduce
 * the number of paths. */
enum { MOST_SHADOW_RAYS = 1 << 17, PATHS_OF_USE = 256, LEAST_PATHS_A_SENSOR = 4 };
/* One path for this many samples of the technique, so that the check takes at most 2 % of its
 * time. */
enum { SAMPLES_A_PATH = 64 };

/* ---- Groups of sensors ----------------------------------------------------------------------- */

struct check {
    const struct orl_run_state *state;
    uint32_t paths; /* per sensor */
    size_t stride;  /* distance of the traced sensors of a group */
    size_t n_groups;
    struct orl_plain_group groups[MOST_GROUPS];
    struct orl_health health[MOST_GROUPS]; /* counters of paths, not added to the result */
};

static void trace_sensor(struct check *check, struct orl_plain_group *group, size_t sensor,
                         struct orl_health *health, double *sums)
{
    const struct orl_run_state *state = check->state;
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    const struct orl_vec3 position =
        orl_sub(state->sensors[sensor].position, lit_scene->geometry->center);
    struct orl_shading_point place = {.normal = orl_normalize(state->sensors[sensor].direction)};
    double sum = 0, squares = 0;
    place.point = orl_offset_from_surface(lit_scene->geometry, position, place.normal);
    place.outside = orl_lit_scene_is_outside(lit_scene, place.point);
    for (uint32_t i = 0; i < check->paths && !orl_is_cancelled(state->env->cancel); i++) {
        struct orl_random random = orl_random_stream(state->job->seed, ORL_PURPOSE_CROSS_CHECK,
                                                     (uint64_t)sensor * check->paths + i);
        const struct orl_plain_light light = orl_plain_path(
            lit_scene, &place, state->result->plan.most_reflections, &random, health);
        double lx = 0;
        for (int c = 0; c < ORL_LIGHT_CLASSES; c++) {
            group->classes[c] += light.lx[c] / check->paths;
            lx += light.lx[c];
        }
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
    struct orl_plain_group *group = &check->groups[index];
    double sums[2] = {0, 0};
    (void)member;
    for (size_t i = group->first; i < group->first + group->count; i += check->stride) {
        trace_sensor(check, group, i, &check->health[index], sums);
        group->traced++;
    }
    group->effective = sums[1] > 0 ? sums[0] * sums[0] / sums[1] : 0;
}

/* Returns true if plain paths find all light of the scene, none of it by chance only. */
static bool paths_find_all(const struct orl_run_state *state)
{
    return orl_paths_missed(ORL_TECHNIQUE_AUTO, state->result->plan.paths) == 0;
}

/* Returns true if the job omits effects on request, which the paths would include. */
static bool omits_on_request(const struct orl_job *job)
{
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        if (job->overrides[i] == ORL_OVERRIDE_SKIP)
            return true;
    return false;
}

/* Returns the maximum number of shadow rays at one surface. */
static double count_lights(const struct orl_lit_scene *lit_scene)
{
    return 1 + (double)(lit_scene->n_suns + lit_scene->images.n_nodes + lit_scene->n_emitters +
                        lit_scene->virtual_lamps.n_images);
}

int orl_run_cross_check(struct orl_run_state *state, struct orl_error *err)
{
    struct check check = {.state = state};
    const size_t n = state->n_sensors;
    if (n == 0 || state->result->n_sensors != n || omits_on_request(state->job) ||
        state->lit_scene->scene->mist || orl_lit_scene_seen(state->lit_scene) != state->lit_scene)
        return 0;
    double samples = 0;
    for (size_t i = 0; i < n; i++)
        samples += state->samples > 0 ? state->samples : orl_run_sensor_samples(state, i);
    const double most = fmin(MOST_PATHS, MOST_SHADOW_RAYS / count_lights(state->lit_scene));
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
    const int code = orl_parallel_try(state->env->pool, check.n_groups, trace_group, &check);
    if (code < 0)
        return orl_error_set(err, code, "%s", "cancelled while checking sensors by paths");
    orl_cross_check_evaluate(state,
                             &(struct orl_plain_groups){check.groups, check.n_groups, check.stride,
                                                        check.paths, paths_find_all(state)});
    return 0;
}
