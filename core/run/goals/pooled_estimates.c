#include "run/goals/pooled_estimates.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics/sum.h"

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
