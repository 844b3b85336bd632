/*
 * Cross-check of sensors by plain path tracing with shadow rays (cross_check_path.h), which uses no
 * photons, ports, importance-sampled rays or caches. Sensors form groups of neighbours. For each
 * group the sum by paths is compared with that of the technique (cross_check_verdict.h).
 *
 * Paths omit suns reflected or refracted by curved mirrors and dielectrics, and rarely hit suns and
 * lamps through lobes. With such light, a smaller sum by paths means nothing.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/job/paths.h>

#include "base/sampling/random.h"
#include "plan/decide.h"
#include "run/diagnostics/cross_check_path.h"
#include "run/diagnostics/cross_check_verdict.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/sensor_results.h"
#include "scene/geometry/surface_offset.h"

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
