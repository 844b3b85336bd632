/* Pools values of independent rounds, and the sensors and views of a job. */
#include "run/goals/pooled_results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/statistics/numeric.h"
#include "run/output/output_files.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

/* Degrees of freedom with which the common variance enters each value's. */
static const double shared_degrees = 4;
/* Limit of one value's contribution to the dispersion, because tails are heavy. */
static const double most_of_one = 25;
/* A dispersion up to this is within chance. */
static const double tolerated_dispersion = 1.3;

int orl_pooled_init(struct orl_pooled_estimates *pooled, size_t count, uint32_t batches,
                    struct orl_error *err)
{
    *pooled = (struct orl_pooled_estimates){
        .count = count, .n_batches = batches, .knows_errors = true, .knows_bias = true};
    double **const arrays[] = {&pooled->batches, &pooled->mean,   &pooled->bias,
                               &pooled->spread,  &pooled->within, &pooled->expected};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i] = calloc((i == 0 ? batches : 1) * count + 1, sizeof(double));
        if (!*arrays[i]) {
            orl_pooled_done(pooled);
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory to pool %zu values", count);
        }
    }
    return 0;
}

void orl_pooled_done(struct orl_pooled_estimates *pooled)
{
    free(pooled->mean);
    free(pooled->bias);
    free(pooled->spread);
    free(pooled->within);
    free(pooled->expected);
    free(pooled->batches);
    *pooled = (struct orl_pooled_estimates){0};
}

void orl_pooled_add(struct orl_pooled_estimates *pooled, const struct orl_round_values *found)
{
    const double before = pooled->weight, weight = found->weight;
    const double share = weight / (before + weight);
    for (size_t i = 0; i < pooled->count; i++) {
        /* West (1979): weighted mean and squares in one pass. */
        const double off = found->value[i] - pooled->mean[i];
        pooled->mean[i] += share * off;
        pooled->spread[i] += before * share * off * off;
        if (found->error) {
            const double square = found->error[i] * found->error[i];
            pooled->within[i] += weight * weight * square;
            pooled->expected[i] += weight * square;
        }
        if (found->bias)
            pooled->bias[i] += share * (found->bias[i] - pooled->bias[i]);
    }
    for (size_t i = 0; i < pooled->count * pooled->n_batches; i++)
        pooled->batches[i] += share * (found->batches[i] - pooled->batches[i]);
    pooled->knows_errors = pooled->knows_errors && found->error;
    pooled->knows_bias = pooled->knows_bias && found->bias;
    pooled->weight += weight;
    pooled->weight_squares +=
        found->degrees_of_freedom > 0 ? weight * weight / found->degrees_of_freedom : 0;
    pooled->rounds++;
}

double orl_pooled_dispersion(const struct orl_pooled_estimates *pooled)
{
    struct orl_sum sum = {0, 0};
    size_t used = 0;
    if (pooled->rounds < 2 || !pooled->knows_errors)
        return 1;
    for (size_t i = 0; i < pooled->count; i++) {
        /* Expectation of spread[i] if the rounds' own errors are right. */
        const double mean = pooled->expected[i] - pooled->within[i] / pooled->weight;
        if (!(mean > 0))
            continue;
        orl_sum_add(&sum, fmin(pooled->spread[i] / mean, most_of_one));
        used++;
    }
    return used > 0 ? orl_sum_value(&sum) / (double)used : 1;
}

/* Computes errors from the rounds' own. */
static void errors_within(const struct orl_pooled_estimates *pooled, double *ret_errors)
{
    const double dispersion = orl_pooled_dispersion(pooled);
    const double factor = dispersion > tolerated_dispersion ? sqrt(dispersion) : 1;
    for (size_t i = 0; i < pooled->count; i++)
        ret_errors[i] = factor * sqrt(pooled->within[i]) / pooled->weight;
}

/* Computes errors from the spread of batches, each over all rounds. */
static void errors_of_batches(const struct orl_pooled_estimates *pooled, double *ret_errors)
{
    const double n = pooled->n_batches;
    for (size_t i = 0; i < pooled->count; i++) {
        const double *batches = &pooled->batches[i * pooled->n_batches];
        double squares = 0;
        for (uint32_t k = 0; k < pooled->n_batches; k++)
            squares += (batches[k] - pooled->mean[i]) * (batches[k] - pooled->mean[i]);
        ret_errors[i] = sqrt(squares / n / (n - 1));
    }
}

double orl_pooled_third(const struct orl_pooled_estimates *pooled, size_t index)
{
    const double n = pooled->n_batches;
    double cubes = 0;
    for (uint32_t k = 0; k < pooled->n_batches; k++) {
        const double off = pooled->batches[index * pooled->n_batches + k] - pooled->mean[index];
        cubes += off * off * off;
    }
    return n > 2 ? cubes / (n * (n - 1) * (n - 2)) : 0;
}

/* Computes errors from the spread between rounds: spread / ((rounds - 1) weight) is the variance of
 * a mean. */
static void errors_between(const struct orl_pooled_estimates *pooled, double floor,
                           double *ret_errors)
{
    const double own = pooled->rounds - 1.0;
    struct orl_sum mean = {0, 0}, shared = {0, 0};
    for (size_t i = 0; i < pooled->count; i++)
        orl_sum_add(&mean, fabs(pooled->mean[i]) / (double)pooled->count);
    const double least = floor * orl_sum_value(&mean);
    for (size_t i = 0; i < pooled->count; i++) {
        const double by = fmax(fabs(pooled->mean[i]), least);
        if (by > 0)
            orl_sum_add(&shared, pooled->spread[i] /
                                     (own * pooled->weight * by * by * (double)pooled->count));
    }
    for (size_t i = 0; i < pooled->count; i++) {
        const double by = fmax(fabs(pooled->mean[i]), least);
        const double alike = orl_sum_value(&shared) * by * by;
        const double here = pooled->spread[i] / (own * pooled->weight);
        ret_errors[i] = sqrt((shared_degrees * alike + own * here) / (shared_degrees + own));
    }
}

bool orl_pooled_errors(const struct orl_pooled_estimates *pooled, double floor, double *ret_errors)
{
    if (pooled->rounds > 0 && pooled->n_batches > 0) {
        errors_of_batches(pooled, ret_errors);
        return true;
    }
    if (pooled->rounds > 0 && pooled->knows_errors) {
        errors_within(pooled, ret_errors);
        return true;
    }
    if (pooled->rounds > 1) {
        errors_between(pooled, floor, ret_errors);
        return true;
    }
    for (size_t i = 0; i < pooled->count; i++)
        ret_errors[i] = NAN;
    return false;
}

double orl_pooled_degrees(const struct orl_pooled_estimates *pooled)
{
    if (pooled->n_batches > 0)
        return pooled->n_batches - 1.0;
    if (!pooled->knows_errors)
        return shared_degrees + pooled->rounds - 1.0;
    /* Welch (1947), with variances inversely proportional to weight. */
    return pooled->weight_squares > 0 ? pooled->weight * pooled->weight / pooled->weight_squares
                                      : 1;
}

static int output_init(struct orl_pooled_output *output, size_t count, uint32_t batches,
                       double floor, struct orl_error *err)
{
    output->floor = floor;
    output->errors = malloc((count + 1) * sizeof(double));
    if (!output->errors)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return orl_pooled_init(&output->pooled, count, batches, err);
}

int orl_pooled_results_init(struct orl_pooled_results *results, struct orl_run_state *state,
                            bool by_noise, struct orl_error *err)
{
    const size_t sensors = state->n_sensors > 0, views = state->job->n_views;
    int code = 0;
    *results = (struct orl_pooled_results){.n_outputs = sensors + views, .first_view = sensors};
    results->outputs = calloc(sensors + views + 1, sizeof *results->outputs);
    results->estimates = calloc(sensors + views + 1, sizeof *results->estimates);
    state->result->views = calloc(views + 1, sizeof *state->result->views);
    if (!results->outputs || !results->estimates || !state->result->views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    state->result->n_views = views;
    if (sensors)
        code = output_init(&results->outputs[0], state->n_sensors, by_noise ? ORL_MAP_BATCHES : 0,
                           orl_floor_of_sensors, err);
    if (sensors && code == 0 && by_noise) {
        results->outputs[0].noise = calloc(state->n_sensors, sizeof(double));
        if (!results->outputs[0].noise)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    if (sensors && code == 0) {
        results->outputs[0].rays = calloc(state->n_sensors, sizeof *results->outputs[0].rays);
        if (!results->outputs[0].rays)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    for (size_t i = 0; i < views && code == 0; i++) {
        const struct orl_view_request *v = &state->job->views[i];
        struct orl_pooled_output *output = &results->outputs[sensors + i];
        output->has_glare = v->metrics != 0;
        code = output_init(output, (size_t)v->width * v->height, 0, orl_floor_of_pixels, err);
        if (code == 0)
            code = orl_film_init(&output->film, v->width, v->height, err);
    }
    return code;
}

void orl_pooled_results_done(struct orl_pooled_results *results)
{
    for (size_t i = 0; results->outputs && i < results->n_outputs; i++) {
        orl_pooled_done(&results->outputs[i].pooled);
        orl_film_done(&results->outputs[i].film);
        orl_view_batches_done(&results->outputs[i].batches);
        free(results->outputs[i].errors);
        free(results->outputs[i].noise);
        free(results->outputs[i].rays);
    }
    free(results->outputs);
    free(results->estimates);
    *results = (struct orl_pooled_results){0};
}

/* Adds a round's picture: the luma of every pixel, its error if known, and the colours. */
int orl_pooled_results_add_film(struct orl_pooled_results *results, size_t view,
                                const struct orl_film *film, double weight, struct orl_error *err)
{
    struct orl_pooled_output *output = &results->outputs[results->first_view + view];
    const size_t count = output->pooled.count;
    const double share = weight / (output->pooled.weight + weight);
    const bool knows = orl_film_has_errors(film);
    double *value = malloc((2 * count + 1) * sizeof(double)), *error = value + count;
    if (!value)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a round's pixels");
    for (size_t i = 0; i < count; i++) {
        const float *p = film->pixels[i];
        value[i] = orl_luma((struct orl_rgb){p[0], p[1], p[2]});
        error[i] = knows ? film->errors[i] : 0;
        for (int c = 0; c < 3; c++)
            output->film.pixels[i][c] =
                (float)(output->film.pixels[i][c] + share * (p[c] - output->film.pixels[i][c]));
    }
    const struct orl_round_values found = {.value = value,
                                           .error = knows ? error : NULL,
                                           .degrees_of_freedom = ORL_MAP_BATCHES - 1,
                                           .weight = weight};
    orl_pooled_add(&output->pooled, &found);
    free(value);
    return output->has_glare ? orl_view_batches_add(&output->batches, film, weight, err) : 0;
}

void orl_pooled_results_add_sensors(struct orl_pooled_results *results,
                                    const struct orl_run_state *round, double weight,
                                    const double *samples, const double *batches)
{
    struct orl_pooled_output *output = &results->outputs[0];
    const struct orl_result *result = round->result;
    const struct orl_round_values found = {.value = result->illuminance_lx,
                                           .error = result->standard_error_lx,
                                           .bias = result->bias_estimate_lx,
                                           .batches = batches,
                                           .degrees_of_freedom = ORL_MAP_BATCHES - 1,
                                           .weight = weight};
    if (result->n_sensors == 0)
        return;
    orl_pooled_add(&output->pooled, &found);
    const double share = weight / output->pooled.weight;
    for (size_t i = 0; i < output->pooled.count; i++)
        output->rays[i] = orl_ray_moments_mix(output->rays[i], 1 - share, round->rays[i], share);
    for (size_t i = 0; samples && i < output->pooled.count; i++) {
        const double error = found.error[i], noise = samples[i] * error * error;
        output->noise[i] += share * (noise - output->noise[i]);
    }
}

void orl_pooled_results_evaluate(struct orl_pooled_results *results)
{
    for (size_t i = 0; i < results->n_outputs; i++) {
        struct orl_pooled_output *output = &results->outputs[i];
        orl_pooled_errors(&output->pooled, output->floor, output->errors);
        results->estimates[i] = (struct orl_estimates){
            .value = output->pooled.mean,
            .error = output->errors,
            .bias = output->pooled.knows_bias && !output->film.pixels ? output->pooled.bias : NULL,
            .noise = output->noise,
            .samples = output->pooled.weight,
            .count = output->pooled.count,
            .floor = output->floor,
            .degrees_of_freedom = orl_pooled_degrees(&output->pooled)};
    }
}

static double *copy_values(double **array, const double *values, size_t count)
{
    if (!*array)
        *array = malloc((count + 1) * sizeof(double));
    if (*array)
        memcpy(*array, values, count * sizeof(double));
    return *array;
}

static void store_interval(const struct orl_pooled_output *output, size_t i, double ret_interval[2])
{
    const struct orl_estimate pooled = {.standard_error = output->errors[i],
                                        .degrees_of_freedom = orl_pooled_degrees(&output->pooled),
                                        .bias =
                                            output->pooled.knows_bias ? output->pooled.bias[i] : 0,
                                        .third_cumulant = orl_pooled_third(&output->pooled, i)};
    const struct orl_margins margins = orl_estimate_margins(&pooled);
    ret_interval[0] = fmax(output->pooled.mean[i] - margins.below, 0);
    ret_interval[1] = output->pooled.mean[i] + margins.above;
}

static int store_sensors(const struct orl_pooled_output *output, const struct orl_sensor *sensors,
                         struct orl_result *result, struct orl_error *err)
{
    const size_t n = output->pooled.count;
    bool allocated = copy_values(&result->illuminance_lx, output->pooled.mean, n);
    allocated = allocated && copy_values(&result->standard_error_lx, output->errors, n);
    if (output->pooled.knows_bias)
        allocated = allocated && copy_values(&result->bias_estimate_lx, output->pooled.bias, n);
    if (!result->interval_95_lx)
        result->interval_95_lx = calloc(n, sizeof *result->interval_95_lx);
    allocated = allocated && result->interval_95_lx;
    for (size_t i = 0; allocated && i < n; i++)
        store_interval(output, i, result->interval_95_lx[i]);
    result->n_sensors = allocated ? n : 0;
    orl_run_add_sparse_errors(result, sensors, output->rays);
    return allocated ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
}

int orl_pooled_results_write(struct orl_pooled_results *results, struct orl_run_state *state,
                             struct orl_error *err)
{
    int code = results->first_view > 0
                   ? store_sensors(&results->outputs[0], state->sensors, state->result, err)
                   : 0;
    for (size_t i = 0; i < state->job->n_views && code == 0; i++) {
        struct orl_pooled_output *output = &results->outputs[results->first_view + i];
        for (size_t k = 0; k < output->pooled.count; k++)
            output->film.errors[k] = (float)output->errors[k];
        code = orl_run_write_view(state, i, &output->film, err);
        if (code == 0 && output->has_glare)
            code = orl_run_evaluate_glare_errors(state, i, &output->film, &output->batches, err);
    }
    return code;
}
