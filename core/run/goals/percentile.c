#include "run/goals/percentile.h"

#include <math.h>

#include "base/sum.h"

enum { MOST_LOOKED_AT = 4096, MOST_OF_FEW = 16, HALVINGS = 48 };
/* Normal quantile of the probability. */
static const double probability = 0.975, quantile = 1.9599639845400545;

const double orl_floor_of_sensors = 1e-3, orl_floor_of_pixels = 0.1;

/* Returns the probability that a normal value exceeds x of its estimated standard errors
 * (percentile.h). */
static double above(double x, double degrees)
{
    if (degrees > 2) {
        const double m = degrees - 1, part = x * x / degrees;
        const double z = part < 1 ? (8 * m + 1) / (8 * m + 3) * sqrt(-m * log1p(-part)) : INFINITY;
        x = copysign(z, x);
    }
    return 0.5 * erfc(x * M_SQRT1_2);
}

/* Returns the probability that a normal error with that bias and deviation is beyond x, on either
 * side. */
static double beyond(double x, double bias, double error, double degrees)
{
    if (!(error > 0))
        return fabs(bias) > x ? 1 : 0;
    return above((x - bias) / error, degrees) + above((x + bias) / error, degrees);
}

/* The estimates used: every step-th, with the least divisor. */
struct look {
    const struct orl_estimates *estimates;
    size_t step, count;
    double least;
    double scale, bias_scale; /* factors of errors and biases */
};

/* Returns the probability that the k-th estimate used is beyond x. */
static double beyond_at(const struct look *look, size_t k, double x)
{
    const struct orl_estimates *e = look->estimates;
    const size_t i = k * look->step;
    const double by = fmax(fabs(e->value[i]), look->least);
    return beyond(x * by, e->bias ? look->bias_scale * e->bias[i] : 0, look->scale * e->error[i],
                  e->degrees);
}

/* Tests the bound for a small number by computing the distribution of the number beyond x, adding
 * estimates one by one. */
static int is_bound_of_few(const struct look *look, double x, size_t allowed)
{
    double chance[MOST_OF_FEW + 1] = {1}, sum = 0;
    for (size_t k = 0; k < look->count; k++) {
        const double p = beyond_at(look, k, x);
        for (size_t n = allowed; n > 0; n--)
            chance[n] += p * (chance[n - 1] - chance[n]);
        chance[0] -= p * chance[0];
    }
    for (size_t n = 0; n <= allowed; n++)
        sum += chance[n];
    return sum >= probability;
}

/* Tests the bound for a large number by mean, variance and skewness. */
static int is_bound_of_many(const struct look *look, double x, size_t allowed)
{
    double mean = 0, variance = 0, third = 0;
    for (size_t k = 0; k < look->count; k++) {
        const double p = beyond_at(look, k, x);
        mean += p;
        variance += p * (1 - p);
        third += p * (1 - p) * (1 - 2 * p);
    }
    const double skew = variance > 0 ? third / variance : 0; /* skewness times the deviation */
    const double bound = mean + quantile * sqrt(variance) + (quantile * quantile - 1) / 6 * skew;
    return bound <= (double)allowed + 0.5;
}

/* Returns 1 if the number beyond x is within the allowed one with the required probability. */
static int is_bound(const struct look *look, double x, size_t allowed)
{
    return allowed <= MOST_OF_FEW ? is_bound_of_few(look, x, allowed)
                                  : is_bound_of_many(look, x, allowed);
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
static size_t allowed_of(const struct look *look, double at)
{
    const size_t kept = (size_t)ceil(at * (double)look->count - 1e-9);
    return look->count - (kept < look->count ? kept : look->count);
}

static double find_bound(const struct look *look, double at)
{
    const size_t allowed = allowed_of(look, at);
    double low = 1e-9, high = 1e3;
    if (is_bound(look, low, allowed))
        return 0;
    for (int i = 0; i < HALVINGS && high > low * (1 + 1e-6); i++) {
        const double middle = sqrt(low * high);
        if (is_bound(look, middle, allowed))
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* Selects the estimates to use. Returns 0 if an error is unknown. */
static int select_estimates(const struct orl_estimates *estimates, struct look *ret_look)
{
    const size_t step = (estimates->count + MOST_LOOKED_AT - 1) / MOST_LOOKED_AT;
    double mean;
    if (estimates->count == 0 || !compute_mean(estimates, &mean))
        return 0;
    *ret_look = (struct look){.estimates = estimates,
                              .step = step,
                              .count = (estimates->count + step - 1) / step,
                              .least = estimates->floor * mean,
                              .scale = 1,
                              .bias_scale = 1};
    return 1;
}

double orl_percentile_error(const struct orl_estimates *estimates, double at)
{
    struct look look;
    if (!select_estimates(estimates, &look))
        return NAN;
    return look.least > 0 ? find_bound(&look, at) : 0;
}

bool orl_percentile_is_kept(const struct orl_estimates *estimates, double at, double target)
{
    struct look look;
    if (!select_estimates(estimates, &look))
        return false;
    return !(look.least > 0) || is_bound(&look, target, allowed_of(&look, at));
}

double orl_percentile_work(const struct orl_estimates *estimates, double at, double target)
{
    const double now = orl_percentile_error(estimates, at);
    double low = 1e-9, high = 1; /* range of 1 / work */
    struct look look;
    if (!(now > target) || !select_estimates(estimates, &look))
        return 1;
    if (!has_bias(estimates))
        return now / target *
               (now / target); /* all errors, and so their bound, scale by one factor */
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = sqrt(low * high);
        look.scale = sqrt(middle);
        look.bias_scale = cbrt(middle);
        if (is_bound(&look, target, allowed_of(&look, at)))
            low = middle;
        else
            high = middle;
    }
    return 1 / low;
}
