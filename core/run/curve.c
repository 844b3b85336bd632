/*
 * What an accuracy takes, before a job is paid for: two small rounds of it by paths, of some of its
 * sensors and of coarse pictures, and the model of cost.h from there on.
 */
#include "run/curve.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "run/rounds.h"

enum { MOST_SENSORS = 64, MOST_PIXELS = 4096 };
/* Nobody gets there: a pilot ends by its rounds. */
static const double aim = 1e-4, usual_share = 0.95;

static int take_some_sensors(struct orl_run_state *state, struct orl_pilot *pilot,
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
    pilot->sensor_times = (double)all / (double)some;
    return 0;
}

static double pixels_of(const struct orl_job *job)
{
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    return pixels;
}

static uint32_t shrink(uint32_t side, double by)
{
    return (uint32_t)fmax(ceil(side * by), 1);
}

/* All of them, with so many pixels together. Nothing is made of them: no metrics, no files. */
static int take_small_views(struct orl_job *job, struct orl_pilot *pilot, struct orl_error *err)
{
    const double all = pixels_of(job), by = fmin(sqrt(MOST_PIXELS / fmax(all, 1)), 1);
    struct orl_view_request *views = calloc(job->n_views + 1, sizeof *views);
    if (!views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu views", job->n_views);
    for (size_t i = 0; i < job->n_views; i++)
        views[i] = (struct orl_view_request){.name = job->views[i].name,
                                             .view = job->views[i].view,
                                             .width = shrink(job->views[i].width, by),
                                             .height = shrink(job->views[i].height, by),
                                             .irradiance = job->views[i].irradiance};
    job->views = views;
    pilot->view_times = job->n_views > 0 ? all / pixels_of(job) : 1;
    return 0;
}

int orl_run_pilot(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_pilot *pilot = state->pilot;
    struct orl_job job = *state->job;
    if (state->result->plan.by_chance) {
        snprintf(pilot->curve->model, sizeof pilot->curve->model,
                 "not known: paths come upon light by way of mirrors or lenses by chance only");
        return 0;
    }
    int code = take_some_sensors(state, pilot, err);
    if (code == 0)
        code = take_small_views(&job, pilot, err);
    if (code < 0)
        return code;
    const struct orl_job *whole = state->job;
    state->job = &job;
    code = orl_run_rounds(state, err);
    state->job = whole;
    free(job.views);
    return code;
}

struct orl_job orl_pilot_job(const struct orl_job *job)
{
    struct orl_job pilot = *job;
    pilot.technique = ORL_TECHNIQUE_BACKWARD;
    pilot.goal = (struct orl_goal){.relative_error = aim,
                                   .at = job->goal.at > 0 ? job->goal.at : usual_share};
    pilot.photons_global = pilot.photons_caustic = ORL_PHOTONS_BY_PLAN;
    pilot.photons_exact = false;
    pilot.gather_samples = pilot.pixel_samples = 0;
    pilot.heat_map.asked = false;
    return pilot;
}
