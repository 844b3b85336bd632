#include "run/goals/percentile.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/statistics/numeric.h"

enum { MOST_SELECTED = 4096, MOST_OF_FEW = 16, HALVINGS = 48, THINNED = 16, LEAST_THINNED = 64 };
/* Relative accuracy of bounds, of the first guess of one, and of predicted work. */
static const double accuracy = 1e-5, accuracy_of_guess = 0.02, accuracy_of_work = 1e-4;
/* Normal quantile of the probability. */
static const double probability = 0.975, quantile = 1.9599639845400545;

/* Range of bounds that are searched. */
static const double least_bound = 1e-9, most_bound = 1e3;

const double orl_floor_of_sensors = 1e-3, orl_floor_of_pixels = 0.1;

/* Returns the probability that a normal value exceeds x of its estimated standard errors
 * (percentile.h). */
static double above(double x, double degrees_of_freedom)
{
    if (degrees_of_freedom > 2) {
        const double m = degrees_of_freedom - 1, part = x * x / degrees_of_freedom;
        const double z = part < 1 ? (8 * m + 1) / (8 * m + 3) * sqrt(-m * log1p(-part)) : INFINITY;
        x = copysign(z, x);
    }
    return 0.5 * erfc(x * M_SQRT1_2);
}

/* Returns the probability that a normal error with that bias and deviation is beyond x, on either
 * side. */
static double beyond(double x, double bias, double error, double degrees_of_freedom)
{
    if (!(error > 0))
        return fabs(bias) > x ? 1 : 0;
    if (bias == 0)
        return 2 * above(x / error, degrees_of_freedom);
    return above((x - bias) / error, degrees_of_freedom) +
           above((x + bias) / error, degrees_of_freedom);
}

/* The estimates used: every step-th, with the least divisor. */
struct selection {
    const struct orl_estimates *estimates;
    size_t step, count;
    double least;
    double scale, bias_scale; /* factors of errors and biases */
};

/* Returns the probability that the k-th estimate used is beyond x. */
static double beyond_at(const struct selection *selection, size_t k, double x)
{
    const struct orl_estimates *e = selection->estimates;
    const size_t i = k * selection->step;
    const double by = fmax(fabs(e->value[i]), selection->least);
    return beyond(x * by, e->bias ? selection->bias_scale * e->bias[i] : 0,
                  selection->scale * e->error[i], e->degrees_of_freedom);
}

/* Returns the excess for a small allowed number, from the distribution of the number beyond x, to
 * which estimates are added one by one. */
static double excess_of_few(const struct selection *selection, double x, size_t allowed)
{
    double distribution[MOST_OF_FEW + 1] = {1}, sum = 0;
    for (size_t k = 0; k < selection->count; k++) {
        const double p = beyond_at(selection, k, x);
        for (size_t n = allowed; n > 0; n--)
            distribution[n] += p * (distribution[n - 1] - distribution[n]);
        distribution[0] -= p * distribution[0];
    }
    for (size_t n = 0; n <= allowed; n++)
        sum += distribution[n];
    return probability - sum;
}

/* Returns the excess for a large allowed number, from mean, variance and skewness. */
static double excess_of_many(const struct selection *selection, double x, size_t allowed)
{
    double mean = 0, variance = 0, third = 0;
    for (size_t k = 0; k < selection->count; k++) {
        const double p = beyond_at(selection, k, x);
        mean += p;
        variance += p * (1 - p);
        third += p * (1 - p) * (1 - 2 * p);
    }
    const double skew = variance > 0 ? third / variance : 0; /* skewness times the deviation */
    const double bound = mean + quantile * sqrt(variance) + (quantile * quantile - 1) / 6 * skew;
    return bound - ((double)allowed + 0.5);
}

/* Returns a number that falls as x grows, and is at most 0 if the number of estimates beyond x is
 * within the allowed one with the required probability. */
static double excess_beyond(const struct selection *selection, double x, size_t allowed)
{
    return allowed <= MOST_OF_FEW ? excess_of_few(selection, x, allowed)
                                  : excess_of_many(selection, x, allowed);
}

static bool is_bound(const struct selection *selection, double x, size_t allowed)
{
    return excess_beyond(selection, x, allowed) <= 0;
}

static int has_bias(const struct orl_estimates *e)
{
    for (size_t i = 0; e->bias && i < e->count; i++)
        if (e->bias[i] != 0)
            return 1;
    return 0;
}

/* Computes the mean value. Returns 0 if an error is unknown. */
static int compute_mean(const struct orl_estimates *e, double *ret_mean)
{
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < e->count; i++) {
        if (!isfinite(e->value[i]) || !isfinite(e->error[i]) || (e->bias && !isfinite(e->bias[i])))
            return 0;
        orl_sum_add(&sum, fabs(e->value[i]));
    }
    *ret_mean = orl_sum_value(&sum) / (double)e->count;
    return 1;
}

/* Returns how many of the estimates used may be beyond the bound. */
static size_t allowed_of(const struct selection *selection, double at)
{
    const size_t kept = (size_t)ceil(at * (double)selection->count - 1e-9);
    return selection->count - (kept < selection->count ? kept : selection->count);
}

/* Interval that holds the bound, with the excess at its ends. */
struct bracket {
    double low, high, low_excess, high_excess;
};

/* Bisects the widest range, until the ends differ by little. */
static double guess_bound(const struct selection *selection, double at)
{
    const size_t allowed = allowed_of(selection, at);
    double low = least_bound, high = most_bound;
    while (high > low * (1 + accuracy_of_guess)) {
        const double middle = sqrt(low * high);
        if (is_bound(selection, middle, allowed))
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* Returns an interval about a guess from one estimate in sixteen, if there are enough. */
static struct bracket start_bracket(const struct selection *selection, double at, size_t allowed)
{
    struct bracket b = {least_bound, most_bound, 1, -1};
    if (selection->count < (size_t)THINNED * LEAST_THINNED)
        return b;
    struct selection thinned = *selection;
    thinned.step *= THINNED;
    thinned.count = (selection->count + THINNED - 1) / THINNED;
    const double guess = guess_bound(&thinned, at);
    for (double wide = 1.05; wide < most_bound; wide *= wide) {
        b.low = fmax(guess / wide, least_bound);
        b.high = fmin(guess * wide, most_bound);
        b.low_excess = excess_beyond(selection, b.low, allowed);
        b.high_excess = excess_beyond(selection, b.high, allowed);
        if (b.low_excess > 0 && b.high_excess <= 0)
            return b;
    }
    return (struct bracket){least_bound, most_bound, 1, -1};
}

/* Finds the bound by the Illinois method on the logarithm, which falls back to bisection while the
 * interval is wide (Dowell and Jarratt 1971). */
static double find_bound(const struct selection *selection, double at)
{
    const size_t allowed = allowed_of(selection, at);
    if (is_bound(selection, least_bound, allowed))
        return 0;
    struct bracket b = start_bracket(selection, at, allowed);
    int last = 0; /* the end that moved last: -1 high, 1 low */
    for (int i = 0; i < HALVINGS && b.high > b.low * (1 + accuracy); i++) {
        const bool narrow = b.high < 4 * b.low;
        const double part = narrow ? b.low_excess / (b.low_excess - b.high_excess) : 0.5;
        /* Not so close to an end that the other one never moves. */
        const double inside = fmin(fmax(part, 0.01), 0.99);
        const double middle = b.low * pow(b.high / b.low, inside);
        const double excess = excess_beyond(selection, middle, allowed);
        if (excess <= 0) {
            b.high = middle;
            b.high_excess = excess;
            b.low_excess *= last < 0 ? 0.5 : 1;
            last = -1;
        } else {
            b.low = middle;
            b.low_excess = excess;
            b.high_excess *= last > 0 ? 0.5 : 1;
            last = 1;
        }
    }
    return b.high;
}

/* Selects the estimates to use. Returns 0 if an error is unknown. */
static int select_estimates(const struct orl_estimates *estimates, struct selection *ret_selection)
{
    const size_t step = (estimates->count + MOST_SELECTED - 1) / MOST_SELECTED;
    double mean;
    if (estimates->count == 0 || !compute_mean(estimates, &mean))
        return 0;
    *ret_selection = (struct selection){.estimates = estimates,
                                        .step = step,
                                        .count = (estimates->count + step - 1) / step,
                                        .least = estimates->floor * mean,
                                        .scale = 1,
                                        .bias_scale = 1};
    return 1;
}

double orl_percentile_error(const struct orl_estimates *estimates, double at)
{
    struct selection selection;
    if (!select_estimates(estimates, &selection))
        return NAN;
    return selection.least > 0 ? find_bound(&selection, at) : 0;
}

/* Returns true if the bound is at most `target`. */
static bool orl_percentile_is_met(const struct orl_estimates *estimates, double at, double target)
{
    struct selection selection;
    if (!select_estimates(estimates, &selection))
        return false;
    return !(selection.least > 0) || is_bound(&selection, target, allowed_of(&selection, at));
}

double orl_percentile_work(const struct orl_estimates *estimates, double at, double target)
{
    const double now = orl_percentile_error(estimates, at);
    double low = 1e-9, high = 1; /* range of 1 / work */
    struct selection selection;
    if (!(now > target) || !select_estimates(estimates, &selection))
        return 1;
    if (!has_bias(estimates))
        return now / target *
               (now / target); /* all errors, and so their bound, scale by one factor */
    while (high > low * (1 + accuracy_of_work)) {
        const double middle = sqrt(low * high);
        selection.scale = sqrt(middle);
        selection.bias_scale = cbrt(middle);
        if (is_bound(&selection, target, allowed_of(&selection, at)))
            low = middle;
        else
            high = middle;
    }
    return 1 / low;
}

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
    while (high > low * (1 + accuracy_of_work)) {
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
