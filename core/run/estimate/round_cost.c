#include "run/estimate/round_cost.h"

#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/limits.h>

#include "render/film/film.h"
#include "run/estimate/progress.h"
#include "run/goals/percentile.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

enum { HALVINGS = 40 };

/* Samples of a sensor that correspond to one of a pixel, and to the planner's photons or lights. */
static const double pixel_samples = 1.0 * ORL_DEFAULT_GATHER_SAMPLES / ORL_DEFAULT_PIXEL_SAMPLES,
                    map_samples = ORL_DEFAULT_GATHER_SAMPLES;
enum { LAMPS_A_ROUND = 4000000, PHOTONS_A_ROUND = 8000000 };
/* Minimum samples of a round: for sensors by backward, and for all other work but views by maps. */
static const double least_of_sensors = 64, least_samples = 256;
/*
 * Lights are made once for all sensors, which share their cost. From this number of sensors on, all
 * lights of the planner are made; fewer sensors get proportionally fewer, but at least this share.
 * Lights and samples then take about the same time. That is at most twice the time of the best
 * division, whichever of the two dominates the noise.
 */
static const double sensors_of_lamps = 57, least_lamps = 0.25;
/*
 * Exponent with which variances of stratified samples fall with the work; the actual one may be
 * larger. In rooms with panes and panels four rounds have 0.74 to 0.84 of the variance of
 * independent ones.
 */
static const double evenness = 1.15;
/*
 * Growth limit: maximum samples of a round relative to all before, because early errors are
 * inaccurate. While little is done (`far`), a round aims below the wanted number (`approach`). A
 * later one, with better known errors, exceeds it slightly (`margin`).
 */
static const double growth = 8, approach = 0.6, far = 0.35, margin = 1.02;

/*
 * With a deadline, views by a final gather have rays in proportion to a round's samples, like
 * photons, so that rounds can have any length. Measured in an office of 800x600 pixels by one map,
 * with 0.25 to 2.25 times the usual rays: the error falls as their square root, from 6.5 to 2.3 %
 * through glass and from 8.6 to 3.4 % through a panel. Half of the usual time is proportional to
 * the rays. Beyond 2.25 hemispheres reach their maximum of rows (gather.h).
 */
static const double part_by_rays = 0.5, most_rays = 2.25;

static double photons_of(const struct orl_work *work, double samples)
{
    double sum = 0;
    for (int kind = 0; kind < ORL_SHOT_KINDS; kind++)
        sum += (double)work->photons[kind] * samples / map_samples;
    return sum;
}

/*
 * Returns the work of a job. Views by maps have noise of photons and of their own rays, in unknown
 * proportion. A round gets as many photons as take about as long as the views, by rough costs. That
 * is at most twice the time of the best division.
 */
struct orl_work orl_work_of(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    struct orl_work work = {.technique = plan->technique,
                            .of_views = state->job->n_views > 0,
                            .photons = {plan->photons_global, plan->photons_caustic},
                            .least = least_samples};
    const double photons = fmax((double)plan->photons_global, (double)plan->photons_caustic);
    const struct orl_technique_facts *facts = orl_technique_facts(work.technique);
    work.by_noise = facts->samples_paths && !work.of_views;
    if (work.by_noise) {
        const double worth = fmax((double)state->n_sensors / sensors_of_lamps, least_lamps);
        work.photons[ORL_MAP_GLOBAL] =
            (uint64_t)ceil((double)plan->photons_global * fmin(worth, 1));
    }
    const double most_photons = facts->samples_paths ? LAMPS_A_ROUND : PHOTONS_A_ROUND;
    work.most = fmin(map_samples * fmax(1, most_photons / fmax(photons, 1)), 1 << 18);
    if (work.of_views && !facts->samples_paths) {
        const double alike = orl_run_photons_in_view_time(state) / fmax(photons_of(&work, 1), 1);
        work.least = map_samples;
        if (state->job->goal.deadline_s > 0 && facts->final_gather == ORL_GATHER_EVERYWHERE) {
            work.ray_time_share = part_by_rays;
            work.most = fmin(work.most, most_rays * map_samples);
        } else {
            work.most = fmin(work.most, fmax(alike, work.least));
        }
    } else if (work.by_noise || state->job->goal.dgp_error > 0)
        work.least = least_of_sensors;
    return work;
}

uint64_t orl_work_photons(const struct orl_work *work, int kind, double samples)
{
    return (uint64_t)ceil((double)work->photons[kind] * samples / map_samples);
}

uint32_t orl_work_pixel_samples(double samples)
{
    return (uint32_t)fmax(ceil(samples / pixel_samples), 1);
}

/*
 * Sets relative kernel areas. Hemispheres average over many kernels of global photons, so that
 * these may hold few photons: 64, or fewer as maps add up. Caustics are seen directly: their
 * kernels grow with the power 2/3 of all photons, from the size for the planner's number.
 */
void orl_work_bandwidths(double samples, double before, double ret_bandwidths[ORL_MAP_KINDS])
{
    const double all = before + samples;
    ret_bandwidths[ORL_MAP_GLOBAL] = cbrt(samples / all);
    ret_bandwidths[ORL_MAP_CAUSTIC] = samples / map_samples / cbrt(all / map_samples);
    ret_bandwidths[ORL_MAP_PRECOMPUTED] = 1;
}

double orl_work_limit(void)
{
    return ORL_LIMIT_GOAL_SAMPLES;
}

double orl_work_next(const struct orl_work *work, double done, double wanted)
{
    const double unit = ORL_MAP_BATCHES; /* samples are divided into this many batches */
    const double aim = wanted * (done < far * wanted && work->by_noise ? approach : margin);
    const double missing = fmin(fmin(aim - done, growth * done), orl_work_limit() - done);
    double samples = work->least;
    if (done > 0)
        samples = fmax(missing, samples);
    return unit * ceil(fmin(samples, work->most) / unit);
}

bool orl_work_view_time_is_fixed(const struct orl_work *work)
{
    return work->of_views && !orl_technique_facts(work->technique)->samples_paths &&
           !(work->ray_time_share > 0);
}

double orl_work_view_rays(const struct orl_work *work, double samples)
{
    return work->ray_time_share > 0 ? fmin(samples / map_samples, most_rays) : 0;
}

/* Returns the seconds of views and sensors in a round, if views' rays follow the samples. */
static double render_by_rays_s(const struct orl_throughput *throughput, const struct orl_work *work,
                               double samples)
{
    const double b = work->ray_time_share, usual = 1 - b + b * samples / map_samples;
    const double done = throughput->rounds * (1 - b) + b * throughput->samples / map_samples;
    return throughput->views_s / done * usual +
           (throughput->render_s - throughput->views_s) / throughput->samples * samples;
}

double orl_throughput_round_s(const struct orl_throughput *throughput, const struct orl_work *work,
                              double samples)
{
    double seconds = throughput->rounds > 0 ? throughput->other_s / throughput->rounds : 0;
    if (throughput->photons > 0)
        seconds += throughput->photon_s / throughput->photons * photons_of(work, samples);
    if (orl_work_view_time_is_fixed(work))
        return seconds + (throughput->rounds > 0 ? throughput->render_s / throughput->rounds : 0);
    if (work->ray_time_share > 0 && throughput->samples > 0)
        return seconds + render_by_rays_s(throughput, work, samples);
    return seconds +
           (throughput->samples > 0 ? throughput->render_s / throughput->samples * samples : 0);
}

double orl_throughput_samples(const struct orl_throughput *throughput, const struct orl_work *work,
                              double seconds, double most)
{
    double low = work->least, high = fmax(fmin(work->most, most), low);
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (orl_throughput_round_s(throughput, work, middle) <= seconds)
            low = middle;
        else
            high = middle;
    }
    return ORL_MAP_BATCHES * floor(low / ORL_MAP_BATCHES);
}

double orl_throughput_run_s(const struct orl_throughput *throughput, const struct orl_work *work,
                            double wanted)
{
    return throughput->setup_s + orl_throughput_remaining_s(throughput, work, 0, wanted);
}

double orl_throughput_remaining_s(const struct orl_throughput *throughput,
                                  const struct orl_work *work, double done, double wanted)
{
    double seconds = 0;
    while (done < wanted || done == 0) {
        const double samples = orl_work_next(work, done, wanted);
        seconds += orl_throughput_round_s(throughput, work, samples);
        done += samples;
    }
    return seconds;
}

void orl_throughput_stage_s(const struct orl_throughput *throughput, const struct orl_work *work,
                            double samples, double estimated_s[ORL_STAGE_COUNT])
{
    const double all = orl_throughput_round_s(throughput, work, samples);
    const double photons = throughput->photons > 0 ? throughput->photon_s / throughput->photons *
                                                         photons_of(work, samples)
                                                   : 0;
    estimated_s[ORL_STAGE_PHOTONS] = photons;
    estimated_s[ORL_STAGE_MAPS] = 0;
    estimated_s[ORL_STAGE_RENDER] = all - photons;
}

/* ---- Predictions ----------------------------------------------------------------------------- */

double orl_output_estimates_error(const struct orl_output_estimates *outputs)
{
    double most = outputs->count > 0 ? 0 : NAN;
    for (size_t i = 0; i < outputs->count; i++) {
        const double error = orl_percentile_error(&outputs->outputs[i], outputs->at);
        most = isnan(error) || error > most ? error : most;
        if (isnan(error))
            break;
    }
    return most;
}

double orl_output_estimates_work(const struct orl_output_estimates *outputs, double target)
{
    double most = 1;
    for (size_t i = 0; i < outputs->count; i++) {
        const struct orl_estimates *output = &outputs->outputs[i];
        const double work =
            output->noise ? pow(orl_allocation_work(output, outputs->at, target), 1 / evenness)
                          : orl_percentile_work(output, outputs->at, target);
        most = isnan(work) || work > most ? work : most;
        if (isnan(work))
            break;
    }
    return most;
}

/* Returns the seconds until the error is `target`; NaN if that exceeds a job's limit. */
static double seconds_to(const struct orl_throughput *throughput, const struct orl_work *work,
                         const struct orl_output_estimates *outputs, double target)
{
    const double wanted = throughput->samples * orl_output_estimates_work(outputs, target);
    return wanted <= orl_work_limit() ? orl_throughput_run_s(throughput, work, wanted) : NAN;
}

void orl_run_predict_cost(struct orl_run_state *state, const struct orl_throughput *throughput,
                          const struct orl_work *work, const struct orl_output_estimates *outputs)
{
    const double one_percent = 0.01;
    const bool by_rounds = orl_work_view_time_is_fixed(work) || work->ray_time_share > 0;
    struct orl_cost *cost = &state->result->cost;
    cost->rays = state->result->health.rays;
    cost->photons = state->result->health.photons;
    cost->error = orl_output_estimates_error(outputs);
    cost->halve_s = cost->one_percent_s = NAN;
    snprintf(cost->model, sizeof cost->model, "the errors are not known");
    if (isnan(cost->error))
        return;
    snprintf(cost->model, sizeof cost->model, "no further improvement is possible");
    if (!(cost->error > 0) || !(throughput->samples > 0)) {
        cost->one_percent_s = cost->error <= one_percent ? 0 : NAN;
        return;
    }
    cost->halve_s = seconds_to(throughput, work, outputs, cost->error / 2);
    cost->one_percent_s =
        cost->error <= one_percent ? 0 : seconds_to(throughput, work, outputs, one_percent);
    snprintf(cost->model, sizeof cost->model,
             "a run in rounds with %s: %.3g s, %.3g s per million photons, %.3g s %s; error^2 "
             "falls as 1 / work%s",
             orl_technique_name(work->technique), throughput->setup_s,
             throughput->photons > 0 ? 1e6 * throughput->photon_s / throughput->photons : 0,
             by_rounds ? throughput->render_s / fmax(throughput->rounds, 1)
                       : 1e3 * throughput->render_s / throughput->samples,
             by_rounds ? "per round of its views" : "per thousand samples",
             work->by_noise ? "^1.15" : "");
}

void orl_run_compute_curve(const struct orl_run_state *state,
                           const struct orl_throughput *throughput, const struct orl_work *work,
                           const struct orl_output_estimates *outputs,
                           struct orl_accuracy_curve *ret_curve)
{
    static const double errors[] = {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};
    const struct orl_cost *cost = &state->result->cost;
    struct orl_accuracy_curve *curve = ret_curve;
    curve->n_points = 0;
    snprintf(curve->model, sizeof curve->model, "%s", cost->model);
    if (!(cost->error > 0) || !(throughput->samples > 0))
        return;
    curve->points[0].seconds = orl_throughput_run_s(throughput, work, throughput->samples);
    curve->points[curve->n_points++].error = cost->error;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        const double seconds = errors[i] < cost->error
                                   ? seconds_to(throughput, work, outputs, errors[i])
                                   : (double)NAN;
        if (!isfinite(seconds))
            continue;
        /* The smallest possible round reaches this error as well. */
        if (!(seconds > curve->points[curve->n_points - 1].seconds))
            curve->n_points--;
        curve->points[curve->n_points].seconds = seconds;
        curve->points[curve->n_points++].error = errors[i];
    }
}

/* ---- Jobs without rounds --------------------------------------------------------------------- */

/* Returns a job's own settings as samples of a sensor. */
static double samples_of(const struct orl_run_state *state, const struct orl_work *work)
{
    const struct orl_job *job = state->job;
    if (orl_technique_facts(work->technique)->samples_paths && state->n_sensors == 0)
        return pixel_samples * orl_run_pixel_samples(state);
    if (state->n_sensors == 0)
        return map_samples;
    return job->gather_samples ? job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
}

/* Returns the seconds of photons and maps, including those of earlier jobs that made its maps. */
static double seconds_of_photons(const struct orl_result *result)
{
    double seconds = result->timings_s[ORL_STAGE_PHOTONS] + result->timings_s[ORL_STAGE_MAPS];
    for (size_t i = 0; i < result->n_maps; i++)
        seconds += result->maps[i].earlier_s;
    return seconds;
}

void orl_run_store_pixels(struct orl_run_state *state, size_t index, const struct orl_film *film)
{
    enum { MOST_PIXELS = 4096 };
    const size_t all = (size_t)film->width * film->height;
    const size_t step = (all + MOST_PIXELS - 1) / MOST_PIXELS, count = (all + step - 1) / step;
    if (!state->stored_pixels)
        state->stored_pixels = calloc(state->job->n_views, sizeof *state->stored_pixels);
    double *values = state->stored_pixels ? malloc(2 * count * sizeof *values) : NULL;
    if (!values)
        return;
    for (size_t i = 0; i < count; i++) {
        const float *p = film->pixels[i * step];
        values[i] = orl_luma((struct orl_rgb){p[0], p[1], p[2]});
        values[count + i] = film->errors[i * step];
    }
    state->stored_pixels[index] = (struct orl_estimates){.value = values,
                                                         .error = values + count,
                                                         .count = count,
                                                         .floor = orl_floor_of_pixels,
                                                         .degrees_of_freedom = ORL_MAP_BATCHES - 1};
}

void orl_run_free_pixels(struct orl_run_state *state)
{
    for (size_t i = 0; state->stored_pixels && i < state->job->n_views; i++)
        free((double *)(uintptr_t)state->stored_pixels[i].value);
    free(state->stored_pixels);
    state->stored_pixels = NULL;
}

/* Lists the estimates of sensors and of views; returns their number. */
static size_t list_outputs(const struct orl_run_state *state, const double *noise, double samples,
                           struct orl_estimates *ret_outputs)
{
    const struct orl_result *result = state->result;
    size_t n = 0;
    if (state->n_sensors > 0)
        ret_outputs[n++] = (struct orl_estimates){.value = result->illuminance_lx,
                                                  .error = result->standard_error_lx,
                                                  .bias = result->bias_estimate_lx,
                                                  .noise = noise,
                                                  .samples = samples,
                                                  .count = result->n_sensors,
                                                  .floor = orl_floor_of_sensors,
                                                  .degrees_of_freedom = ORL_MAP_BATCHES - 1};
    for (size_t i = 0; state->stored_pixels && i < state->job->n_views; i++)
        if (state->stored_pixels[i].count > 0)
            ret_outputs[n++] = state->stored_pixels[i];
    return n;
}

/* Returns the variances of one sample, if rounds would allocate samples by noise; else NULL. The
 * caller frees them. */
static double *noise_of(const struct orl_run_state *state, const struct orl_work *work,
                        double samples)
{
    const struct orl_result *result = state->result;
    double *noise = work->by_noise ? malloc((result->n_sensors + 1) * sizeof *noise) : NULL;
    for (size_t i = 0; noise && i < result->n_sensors; i++)
        noise[i] = samples * result->standard_error_lx[i] * result->standard_error_lx[i];
    return noise;
}

void orl_run_compute_cost(struct orl_run_state *state)
{
    const struct orl_result *result = state->result;
    struct orl_work work = orl_work_of(state);
    const double samples = samples_of(state, &work);
    const double photons = (double)(work.photons[ORL_MAP_GLOBAL] + work.photons[ORL_MAP_CAUSTIC]);
    /* This plan's lights are for its own samples; rounds have lights for the default number. */
    if (work.by_noise)
        work.photons[ORL_MAP_GLOBAL] = (uint64_t)(photons * map_samples / samples);
    const struct orl_throughput throughput = {.setup_s = result->timings_s[ORL_STAGE_LOAD] +
                                                         result->timings_s[ORL_STAGE_BVH] +
                                                         result->timings_s[ORL_STAGE_PLAN],
                                              .photons = photons,
                                              .photon_s = seconds_of_photons(result),
                                              .samples = samples,
                                              .render_s = result->timings_s[ORL_STAGE_RENDER],
                                              .rounds = 1};
    struct orl_estimates *estimates = calloc(state->job->n_views + 1, sizeof *estimates);
    double *noise = noise_of(state, &work, samples);
    const struct orl_output_estimates outputs = {
        estimates, estimates ? list_outputs(state, noise, samples, estimates) : 0, 0.95};
    orl_run_predict_cost(state, &throughput, &work, &outputs);
    free(noise);
    free(estimates);
}
