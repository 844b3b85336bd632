#include "run/goals/pooled_estimates.h"

#include <math.h>
#include <stdlib.h>

#include "base/sum.h"

/* Degrees of freedom with which the common variance enters each value's. */
static const double shared_degrees = 4;
/* Limit of one value's contribution to the dispersion, because tails are heavy. */
static const double most_of_one = 25;
/* A dispersion up to this is within chance. */
static const double tolerated_dispersion = 1.3;

int orl_pooled_init(struct orl_pooled *pool, size_t count, uint32_t groups, struct orl_error *err)
{
    *pool = (struct orl_pooled){
        .count = count, .n_groups = groups, .knows_errors = true, .knows_bias = true};
    double **const arrays[] = {&pool->groups, &pool->mean,   &pool->bias,
                               &pool->spread, &pool->within, &pool->expected};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        *arrays[i] = calloc((i == 0 ? groups : 1) * count + 1, sizeof(double));
        if (!*arrays[i]) {
            orl_pooled_done(pool);
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory to pool %zu values", count);
        }
    }
    return 0;
}

void orl_pooled_done(struct orl_pooled *pool)
{
    free(pool->mean);
    free(pool->bias);
    free(pool->spread);
    free(pool->within);
    free(pool->expected);
    free(pool->groups);
    *pool = (struct orl_pooled){0};
}

void orl_pooled_add(struct orl_pooled *pool, const struct orl_round_findings *found)
{
    const double before = pool->effort, effort = found->effort;
    const double share = effort / (before + effort);
    for (size_t i = 0; i < pool->count; i++) {
        /* West (1979): weighted mean and squares in one pass. */
        const double off = found->value[i] - pool->mean[i];
        pool->mean[i] += share * off;
        pool->spread[i] += before * share * off * off;
        if (found->error) {
            const double square = found->error[i] * found->error[i];
            pool->within[i] += effort * effort * square;
            pool->expected[i] += effort * square;
        }
        if (found->bias)
            pool->bias[i] += share * (found->bias[i] - pool->bias[i]);
    }
    for (size_t i = 0; i < pool->count * pool->n_groups; i++)
        pool->groups[i] += share * (found->groups[i] - pool->groups[i]);
    pool->knows_errors = pool->knows_errors && found->error;
    pool->knows_bias = pool->knows_bias && found->bias;
    pool->effort += effort;
    pool->effort_squares += found->degrees > 0 ? effort * effort / found->degrees : 0;
    pool->rounds++;
}

double orl_pooled_dispersion(const struct orl_pooled *pool)
{
    struct orl_sum sum = {0, 0};
    size_t used = 0;
    if (pool->rounds < 2 || !pool->knows_errors)
        return 1;
    for (size_t i = 0; i < pool->count; i++) {
        /* Expectation of spread[i] if the rounds' own errors are right. */
        const double mean = pool->expected[i] - pool->within[i] / pool->effort;
        if (!(mean > 0))
            continue;
        orl_sum_add(&sum, fmin(pool->spread[i] / mean, most_of_one));
        used++;
    }
    return used > 0 ? orl_sum_value(&sum) / (double)used : 1;
}

/* Computes errors from the rounds' own. */
static void errors_within(const struct orl_pooled *pool, double *ret_errors)
{
    const double dispersion = orl_pooled_dispersion(pool);
    const double factor = dispersion > tolerated_dispersion ? sqrt(dispersion) : 1;
    for (size_t i = 0; i < pool->count; i++)
        ret_errors[i] = factor * sqrt(pool->within[i]) / pool->effort;
}

/* Computes errors from the spread of groups, each over all rounds. */
static void errors_of_groups(const struct orl_pooled *pool, double *ret_errors)
{
    const double n = pool->n_groups;
    for (size_t i = 0; i < pool->count; i++) {
        const double *groups = &pool->groups[i * pool->n_groups];
        double squares = 0;
        for (uint32_t k = 0; k < pool->n_groups; k++)
            squares += (groups[k] - pool->mean[i]) * (groups[k] - pool->mean[i]);
        ret_errors[i] = sqrt(squares / n / (n - 1));
    }
}

double orl_pooled_third(const struct orl_pooled *pool, size_t index)
{
    const double n = pool->n_groups;
    double cubes = 0;
    for (uint32_t k = 0; k < pool->n_groups; k++) {
        const double off = pool->groups[index * pool->n_groups + k] - pool->mean[index];
        cubes += off * off * off;
    }
    return n > 2 ? cubes / (n * (n - 1) * (n - 2)) : 0;
}

/* Computes errors from the spread between rounds: spread / ((rounds - 1) effort) is the variance of
 * a mean. */
static void errors_between(const struct orl_pooled *pool, double floor, double *ret_errors)
{
    const double own = pool->rounds - 1.0;
    struct orl_sum mean = {0, 0}, shared = {0, 0};
    for (size_t i = 0; i < pool->count; i++)
        orl_sum_add(&mean, fabs(pool->mean[i]) / (double)pool->count);
    const double least = floor * orl_sum_value(&mean);
    for (size_t i = 0; i < pool->count; i++) {
        const double by = fmax(fabs(pool->mean[i]), least);
        if (by > 0)
            orl_sum_add(&shared,
                        pool->spread[i] / (own * pool->effort * by * by * (double)pool->count));
    }
    for (size_t i = 0; i < pool->count; i++) {
        const double by = fmax(fabs(pool->mean[i]), least);
        const double alike = orl_sum_value(&shared) * by * by;
        const double here = pool->spread[i] / (own * pool->effort);
        ret_errors[i] = sqrt((shared_degrees * alike + own * here) / (shared_degrees + own));
    }
}

bool orl_pooled_errors(const struct orl_pooled *pool, double floor, double *ret_errors)
{
    if (pool->rounds > 0 && pool->n_groups > 0) {
        errors_of_groups(pool, ret_errors);
        return true;
    }
    if (pool->rounds > 0 && pool->knows_errors) {
        errors_within(pool, ret_errors);
        return true;
    }
    if (pool->rounds > 1) {
        errors_between(pool, floor, ret_errors);
        return true;
    }
    for (size_t i = 0; i < pool->count; i++)
        ret_errors[i] = NAN;
    return false;
}

double orl_pooled_degrees(const struct orl_pooled *pool)
{
    if (pool->n_groups > 0)
        return pool->n_groups - 1.0;
    if (!pool->knows_errors)
        return shared_degrees + pool->rounds - 1.0;
    /* Welch (1947), with variances inversely proportional to effort. */
    return pool->effort_squares > 0 ? pool->effort * pool->effort / pool->effort_squares : 1;
}
