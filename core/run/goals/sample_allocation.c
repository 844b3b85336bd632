#include "run/goals/sample_allocation.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics/sum.h"

enum { HALVINGS = 40 };

/* Share of the samples that is allocated equally. */
static const double even_part = 0.2;

/* Relative standard deviations of one sample. */
struct noise {
    const struct orl_estimates *estimates;
    double least; /* least divisor */
    double mean;  /* mean over all; 0: nothing to allocate by */
};

static double divisor(const struct noise *noise, size_t i)
{
    return fmax(fabs(noise->estimates->value[i]), noise->least);
}

static double noise_of(const struct noise *noise, size_t i)
{
    return sqrt(noise->estimates->noise[i]) / divisor(noise, i);
}

static struct noise measure_noise(const struct orl_estimates *estimates)
{
    struct noise noise = {estimates, 0, 0};
    struct orl_sum values = {0, 0}, sum = {0, 0};
    for (size_t i = 0; i < estimates->count; i++)
        orl_sum_add(&values, fabs(estimates->value[i]));
    noise.least = estimates->floor * orl_sum_value(&values) / (double)estimates->count;
    if (!(noise.least > 0))
        return noise;
    for (size_t i = 0; i < estimates->count; i++)
        orl_sum_add(&sum, noise_of(&noise, i));
    noise.mean = orl_sum_value(&sum) / (double)estimates->count;
    noise.mean = isfinite(noise.mean) ? noise.mean : 0;
    return noise;
}

/* Returns the samples of one sensor, relative to the mean. */
static double share_of(const struct noise *noise, size_t i)
{
    return noise->mean > 0 ? even_part + (1 - even_part) * noise_of(noise, i) / noise->mean : 1;
}

/* Returns true if the bound is at most the target after a round of `more` samples; errors:
 * scratch. */
static bool reaches_target(const struct noise *noise, double more, double at, double target,
                           double *errors)
{
    struct orl_estimates then = *noise->estimates;
    const double weight = more / (then.samples + more);
    for (size_t i = 0; i < then.count; i++) {
        const double left = (1 - weight) * then.error[i];
        const double added = weight * weight * then.noise[i] / (more * share_of(noise, i));
        errors[i] = sqrt(left * left + added);
    }
    then.error = errors;
    return orl_percentile_is_met(&then, at, target);
}

double orl_allocation_work(const struct orl_estimates *estimates, double at, double target)
{
    const double most = 1e9; /* relative to the samples so far */
    const struct noise noise = measure_noise(estimates);
    double low = 1e-3 * estimates->samples, high = most * estimates->samples;
    if (!(noise.mean > 0) || orl_percentile_is_met(estimates, at, target))
        return 1;
    double *errors = malloc(estimates->count * sizeof *errors);
    if (!errors)
        return NAN;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = sqrt(low * high);
        if (reaches_target(&noise, middle, at, target, errors))
            high = middle;
        else
            low = middle;
    }
    free(errors);
    return 1 + high / estimates->samples;
}

void orl_allocate_samples(const struct orl_estimates *estimates, double mean, double *ret_samples)
{
    const struct noise noise = measure_noise(estimates);
    for (size_t i = 0; i < estimates->count; i++)
        ret_samples[i] = mean * share_of(&noise, i);
}
