/* Predicts the cost of an accuracy before a job is started: two small rounds by its technique, with
 * some of its sensors and coarse pictures, extrapolated by the model of round_cost.h. */
#include "run/estimate/round_cost.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/job/paths.h>

#include "run/goals/rounds.h"
#include "run/run_state.h"
#include "scene/material/function_brdf/function_brdf_check.h"

enum { MOST_SENSORS = 64, MOST_PIXELS = 4096, MOST_PIXELS_OF_MAPS = 16384 };
/* An unreachable accuracy: a pilot ends by its number of rounds. */
static const double unreachable_error = 1e-4, usual_share = 0.95;
/*
 * Exponent of a final gather's time over pixels: most of it is for records, of which larger
 * pictures have fewer per pixel. An office through glass and through panels, from 4 thousand to 260
 * thousand pixels, took 8.7 and 7.7 times as long.
 */
static const double gather_power = 0.55;
/* Maximum time for the photons of a round by maps, and the minimum samples for them. */
static const double photons_s = 1, fewest_samples = 256;

static int select_sensors(struct orl_run_state *state, struct orl_pilot *pilot,
                          struct orl_error *err)
{
    const size_t all = state->n_sensors, some = all < MOST_SENSORS ? all : MOST_SENSORS;
    struct orl_sensor *sensors = some < all ? malloc(some * sizeof *sensors) : NULL;
    if (some == all)
        return 0;
    if (!sensors)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", some);
    for (size_t i = 0; i < some; i++)
        sensors[i] = state->sensors[i * all / some];
    if (state->sensors_owned)
        free(state->sensors);
    state->sensors = sensors;
    state->sensors_owned = true;
    state->n_sensors = some;
    pilot->sensor_factor = (double)all / (double)some;
    return 0;
}

static double pixels_of(const struct orl_job *job)
{
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    return pixels;
}

static uint32_t shrink_side(uint32_t side, double by)
{
    return (uint32_t)fmax(ceil(side * by), 1);
}

/* Replaces the job's views by small ones with that many pixels in total, without metrics and
 * files. */
static int shrink_views(struct orl_job *job, struct orl_pilot *pilot, struct orl_error *err)
{
    const struct orl_technique_facts *facts = orl_technique_facts(job->technique);
    const double all = pixels_of(job),
                 most = facts->samples_paths ? MOST_PIXELS : MOST_PIXELS_OF_MAPS;
    const double by = fmin(sqrt(most / fmax(all, 1)), 1);
    struct orl_view_request *views = calloc(job->n_views + 1, sizeof *views);
    if (!views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu views", job->n_views);
    for (size_t i = 0; i < job->n_views; i++)
        views[i] = (struct orl_view_request){.name = job->views[i].name,
                                             .view = job->views[i].view,
                                             .width = shrink_side(job->views[i].width, by),
                                             .height = shrink_side(job->views[i].height, by),
                                             .irradiance = job->views[i].irradiance};
    job->views = views;
    pilot->view_factor = job->n_views > 0 ? all / pixels_of(job) : 1;
    if (facts->final_gather == ORL_GATHER_EVERYWHERE)
        pilot->view_factor = pow(pilot->view_factor, gather_power);
    return 0;
}

/* Returns the samples of a round by photon maps; 0 for paths. */
static double samples_of(const struct orl_run_state *state)
{
    const double all = state->clock.cost_s[ORL_STAGE_PHOTONS], unit = ORL_MAP_BATCHES;
    if (orl_technique_facts(state->result->plan.technique)->samples_paths)
        return 0;
    const double share = fmin(photons_s / fmax(all, photons_s), 1.0 / ORL_PILOT_ROUNDS);
    return unit * ceil(fmax(share * ORL_DEFAULT_GATHER_SAMPLES, fewest_samples) / unit);
}

const char *orl_run_no_curve_reason(const struct orl_run_state *state)
{
    const struct orl_lit_scene *const lit_scene = state->lit_scene;
    const struct orl_plan *plan = &state->result->plan;
    if (orl_find_narrow_lobes(lit_scene->geometry, lit_scene->materials))
        return "not known: lobes of some materials are too narrow to sample reliably";
    if (orl_paths_missed(plan->technique, plan->paths))
        return "not known: paths find light from mirrors or lenses by chance only";
    return NULL;
}

int orl_run_pilot(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_pilot *pilot = state->pilot;
    struct orl_job job = *state->job;
    const char *const why = orl_run_no_curve_reason(state);
    if (why) {
        snprintf(pilot->curve->model, sizeof pilot->curve->model, "%s", why);
        return 0;
    }
    int code = select_sensors(state, pilot, err);
    if (code == 0)
        code = shrink_views(&job, pilot, err);
    if (code < 0)
        return code;
    const struct orl_job *whole = state->job;
    pilot->samples = samples_of(state);
    state->job = &job;
    code = orl_run_rounds(state, err);
    state->job = whole;
    free(job.views);
    return code;
}

struct orl_job orl_pilot_job(const struct orl_job *job, enum orl_technique technique)
{
    struct orl_job pilot = *job;
    pilot.technique = technique;
    pilot.goal = (struct orl_goal){.relative_error = unreachable_error,
                                   .at = job->goal.at > 0 ? job->goal.at : usual_share};
    pilot.photons_global = pilot.photons_caustic = ORL_PHOTONS_BY_PLAN;
    pilot.photons_exact = false;
    pilot.gather_samples = pilot.pixel_samples = 0;
    pilot.heat_map.asked = pilot.sensor_files = false;
    return pilot;
}
