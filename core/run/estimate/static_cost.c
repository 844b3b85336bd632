/* Rough estimates of the stages' times and of a goal's samples, before anything is measured. */
#include <math.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "run/distributed/task_work.h"
#include "run/estimate/progress.h"
#include "run/estimate/round_cost.h"
#include "run/run_state.h"

/* Error that 95 % of an office's sensors stay within, by maps and by paths, and the samples for
 * it. */
static const double usual_error[] = {0.04, 0.02}, usual_samples[] = {4096, 2048};
/* For a goal of a DGP error. */
enum { LEAST_ROUNDS = 4 };

double orl_goal_estimate_samples(const struct orl_goal *goal, bool paths, double of_round)
{
    const double times = usual_error[paths] / goal->relative_error;
    if (goal->dgp_error > 0)
        return LEAST_ROUNDS * of_round;
    return goal->deadline_s > 0
               ? (double)NAN
               : fmin(times * times * usual_samples[paths], ORL_LIMIT_GOAL_SAMPLES);
}

/* Rough estimates of the stages' times, before anything is measured. */

/*
 * Rough costs in microseconds on one core. Photons: one traced (without a pilot), one virtual light
 * traced, one photon indexed, and one made into records. Gather rays: one ray, its first reads of
 * the map, and one read of each photon as the limit of these. Paths by backward: for a sensor, and
 * for a pixel.
 */
static const double photon_us = 0.5, lamp_us = 0.8, index_us = 0.28, record_us = 0.3,
                    gather_us = 2.2, first_us = 15, leaf_us = 0.7, path_us = 7.5,
                    pixel_path_us = 10;
/* Cost of a view by a final gather, besides its pixels. */
static const double view_us = 5.5e5;
/* Cost of a pixel in one picture file. */
static const double write_us = 0.08;
/* Cost of a pixel, by technique. */
static const double pixel_us[] = {[ORL_TECHNIQUE_AUTO] = 20,
                                  [ORL_TECHNIQUE_DIRECT] = 15,
                                  [ORL_TECHNIQUE_PRECOMPUTED] = 9,
                                  [ORL_TECHNIQUE_GATHER] = 7};

static bool gathers_everywhere(enum orl_technique technique)
{
    return orl_technique_facts(technique)->final_gather == ORL_GATHER_EVERYWHERE;
}

static bool makes_records(enum orl_technique technique)
{
    return orl_technique_facts(technique)->reads_map[ORL_MAP_PRECOMPUTED];
}

static double pixels_of(const struct orl_job *job)
{
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    return pixels;
}

/* Microseconds on one core that painting a pixel takes. */
static double paint_us(const struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    const double samples = job->pixel_samples ? job->pixel_samples : ORL_DEFAULT_PIXEL_SAMPLES;
    const enum orl_technique technique = state->result->plan.technique;
    return orl_technique_facts(technique)->samples_paths ? samples * pixel_path_us
                                                         : pixel_us[technique];
}

/* Returns the microseconds on one core for painting all views. */
static double views_us(const struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    const bool gathers = gathers_everywhere(state->result->plan.technique);
    return pixels_of(job) * paint_us(state) + (gathers ? view_us * (double)job->n_views : 0);
}

double orl_run_painting_share(const struct orl_run_state *state,
                              const struct orl_view_request *view)
{
    double files = 4; /* HDR and PNG, and their errors */
    for (uint32_t formats = view->formats; formats != 0; formats &= formats - 1)
        files++;
    const double painting = paint_us(state);
    return state->round.receive_film ? 1 : painting / (painting + files * write_us);
}

double orl_run_photons_in_view_time(const struct orl_run_state *state)
{
    const double times = state->pilot ? state->pilot->view_factor : 1;
    return times * views_us(state) / (photon_us + index_us);
}

/* Returns the cost of first reads. Each part of the map is read for the first time once; the more
 * has been read, the fewer rays pay for it. */
static double first_reads_us(const struct orl_run_state *state, double rays)
{
    const struct orl_plan *plan = &state->result->plan;
    const double all = (double)plan->photons_global * leaf_us;
    if (!gathers_everywhere(plan->sensor_technique) || !(all > 0))
        return 0;
    return (1 - state->map_share_read) * all * (1 - exp(-rays * first_us / all));
}

static double rays_us(const struct orl_run_state *state, double rays)
{
    const bool paths = orl_technique_facts(state->result->plan.sensor_technique)->samples_paths;
    return rays * (paths ? path_us : gather_us) + first_reads_us(state, rays);
}

static double sensor_rays(const struct orl_run_state *state)
{
    const double samples =
        state->job->gather_samples ? state->job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    return (double)state->n_sensors * samples;
}

static double sensors_us(const struct orl_run_state *state)
{
    return rays_us(state, sensor_rays(state));
}

double orl_run_sensors_time_share(const struct orl_run_state *state, double taken)
{
    const double rays = sensor_rays(state), all = rays_us(state, rays);
    return all > 0 ? rays_us(state, taken * rays) / all : taken;
}

double orl_run_sensors_share(const struct orl_run_state *state)
{
    const double sensors = sensors_us(state), all = sensors + views_us(state);
    return all > 0 ? sensors / all : 1;
}

/*
 * Returns the slowness of this machine and scene relative to the costs above, if a pilot has
 * measured it. It is a square root, because gather rays differ less between machines than a short
 * pilot's do.
 */
static double slowness(const struct orl_run_state *state)
{
    const struct orl_photon_forecast *f = &state->result->plan.forecast;
    const double usual_us = 0.28, least = 0.25, most = 4;
    const double ray_us = 1e6 * f->ray_s * orl_thread_pool_size(state->env->pool);
    return f->known && ray_us > 0 ? sqrt(fmin(fmax(ray_us / usual_us, least), most)) : 1;
}

/* Returns the factor from microseconds on one core to seconds of the thread pool. */
static double crew_s(const struct orl_run_state *state)
{
    return 1e-6 / orl_thread_pool_size(state->env->pool) * slowness(state);
}

void orl_run_discount_map_reads(struct orl_run_state *state, double share)
{
    const double before = sensors_us(state);
    state->map_share_read = share;
    if (!orl_run_is_measured(state))
        state->clock.cost_s[ORL_STAGE_RENDER] -= crew_s(state) * (before - sensors_us(state));
}

bool orl_run_is_measured(const struct orl_run_state *state)
{
    return state->env->part_stages_s && !orl_goal_is_set(&state->job->goal);
}

/* Returns the cost of the plan's photons. */
static double photons_us(const struct orl_plan *plan, double photons)
{
    const bool lamps = !orl_technique_reads_maps(plan->technique);
    const bool records = makes_records(plan->technique);
    return lamps ? photons * lamp_us
                 : photons * (photon_us + index_us) +
                       (records ? (double)plan->photons_global * record_us : 0);
}

static uint64_t target_of(uint64_t photons)
{
    return photons == ORL_PHOTONS_BY_PLAN ? ORL_DEFAULT_PHOTONS : photons;
}

uint64_t orl_run_estimate_bytes(const struct orl_job *job)
{
    uint64_t pixels = 0;
    for (size_t i = 0; i < job->n_views; i++) {
        const uint64_t own = (uint64_t)job->views[i].width * job->views[i].height;
        pixels = own > pixels ? own : pixels;
    }
    return ORL_PIXEL_BYTES * pixels +
           ORL_PHOTON_BYTES * (target_of(job->photons_global) + target_of(job->photons_caustic));
}

/* Returns the seconds on one core of a job without rounds. */
static double settings_core_s(const struct orl_job *job)
{
    const double start_us = 5e5; /* start-up cost of every run */
    struct orl_result result = {.n_sensors = job->n_sensors};
    const struct orl_run_state state = {.job = job, .result = &result, .n_sensors = job->n_sensors};
    struct orl_plan *plan = &result.plan;
    plan->technique = job->technique == ORL_TECHNIQUE_AUTO ? ORL_TECHNIQUE_GATHER : job->technique;
    plan->sensor_technique = plan->technique;
    plan->photons_global = target_of(job->photons_global);
    plan->photons_caustic = target_of(job->photons_caustic);
    const double photons = (double)(plan->photons_global + plan->photons_caustic);
    return 1e-6 * (start_us + photons_us(plan, photons) + sensors_us(&state) + views_us(&state));
}

/* Returns the seconds on one core of a job with a goal: those of a job with default settings,
 * scaled by the estimated samples (round_cost.h). */
static double goal_core_s(const struct orl_job *job, enum orl_technique technique)
{
    const bool paths = orl_technique_facts(technique)->samples_paths;
    struct orl_job usual = *job;
    usual.technique = technique;
    usual.photons_global = usual.photons_caustic = ORL_PHOTONS_BY_PLAN;
    usual.gather_samples = usual.pixel_samples = 0;
    const double samples = orl_goal_estimate_samples(&job->goal, paths, ORL_DEFAULT_GATHER_SAMPLES);
    return settings_core_s(&usual) * fmax(samples / ORL_DEFAULT_GATHER_SAMPLES, 1);
}

double orl_run_estimate_core_s(const struct orl_job *job)
{
    if (!orl_goal_is_set(&job->goal))
        return settings_core_s(job);
    if (job->technique != ORL_TECHNIQUE_AUTO)
        return goal_core_s(job, job->technique);
    return fmax(goal_core_s(job, ORL_TECHNIQUE_GATHER), goal_core_s(job, ORL_TECHNIQUE_BACKWARD));
}

void orl_run_estimate_stages(struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const bool planned = plan->technique != ORL_TECHNIQUE_AUTO;
    if (orl_run_is_measured(state)) {
        memcpy(state->clock.cost_s, state->env->part_stages_s, sizeof state->clock.cost_s);
        return;
    }
    const double photons = planned ? (double)(plan->photons_global + plan->photons_caustic)
                                   : 2.0 * ORL_DEFAULT_PHOTONS;
    const double us = crew_s(state);
    state->clock.cost_s[ORL_STAGE_LOAD] = 0.2;
    state->clock.cost_s[ORL_STAGE_BVH] = 0.05;
    state->clock.cost_s[ORL_STAGE_PLAN] = 0.1;
    const bool lamps = !orl_technique_reads_maps(plan->technique);
    state->clock.cost_s[ORL_STAGE_PHOTONS] = us * photons * (lamps ? lamp_us : photon_us);
    if (plan->forecast.known)
        state->clock.cost_s[ORL_STAGE_PHOTONS] = plan->forecast.photons_s;
    state->clock.cost_s[ORL_STAGE_MAPS] = lamps ? 0 : us * photons * index_us;
    if (makes_records(plan->technique))
        state->clock.cost_s[ORL_STAGE_MAPS] += us * (double)plan->photons_global * record_us;
    state->clock.cost_s[ORL_STAGE_RENDER] = us * (sensors_us(state) + views_us(state));
}
