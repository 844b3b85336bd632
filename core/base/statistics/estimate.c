#include "base/statistics/estimate.h"

#include <math.h>

static const double normal_95 = 1.959963984540054;
/* Smallest skewness of a single group that counts. Chance gives 16 normal groups a standard
 * deviation of 0.56. */
static const double least_skewness = 1;
/* Ratio of true to observed skewness for 16 groups. Lognormal groups (sigma 0.5 to 1) show a half
 * to a quarter of it. */
static const double skewness_correction = 2;

struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count)
{
    struct orl_rgb mean = orl_gray(0);
    double square = 0, cube = 0;
    const double n = count;
    for (uint32_t i = 0; i < count; i++)
        mean = orl_rgb_add(mean, orl_rgb_scale(values[i], 1.0 / count));
    for (uint32_t i = 0; i < count; i++) {
        const double off = orl_luma(values[i]) - orl_luma(mean);
        square += off * off;
        cube += off * off * off;
    }
    return (struct orl_estimate){.value = mean,
                                 .standard_error = sqrt(square / n / (n - 1)),
                                 .degrees_of_freedom = n - 1,
                                 .third_cumulant = count > 2 ? cube / (n * (n - 1) * (n - 2)) : 0};
}

struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b)
{
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
    const double spread = va * va / a.degrees_of_freedom + vb * vb / b.degrees_of_freedom;
    return (struct orl_estimate){.value = orl_rgb_add(a.value, b.value),
                                 .standard_error = sqrt(va + vb),
                                 .degrees_of_freedom =
                                     spread > 0 ? (va + vb) * (va + vb) / spread
                                                : fmin(a.degrees_of_freedom, b.degrees_of_freedom),
                                 .bias = a.bias + b.bias,
                                 .third_cumulant = a.third_cumulant + b.third_cumulant,
                                 .rays = orl_ray_moments_mix(a.rays, 1, b.rays, 1)};
}

/* Returns the ratio of Student's t to the normal law at 97.5 %. The first terms in 1 / degrees are
 * good to 1 % from 3 degrees on. */
static double student_over_normal(double degrees_of_freedom)
{
    const double z2 = normal_95 * normal_95, d = degrees_of_freedom;
    return 1 + (z2 + 1) / (4 * d) + ((5 * z2 + 16) * z2 + 3) / (96 * d * d) +
           (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * d * d * d);
}

static double normal_below(double x)
{
    return 0.5 * erfc(-x * sqrt(0.5));
}

/* Returns the 95th percentile of |N(bias, 1)|, by Newton's method from above, where the law is
 * concave. */
static double biased_95(double bias)
{
    double c = bias + normal_95;
    for (int i = 0; i < 6; i++) {
        const double off = normal_below(c - bias) - normal_below(-c - bias) - 0.95;
        const double slope =
            (exp(-0.5 * (c - bias) * (c - bias)) + exp(-0.5 * (c + bias) * (c + bias))) /
            sqrt(2 * acos(-1));
        c -= off / slope;
    }
    return c;
}

/* Returns the extension of the upper margin due to sparse events, in standard errors; t is
 * Student's. */
static double skewness_margin(const struct orl_estimate *e, double t)
{
    const double cube = e->standard_error * e->standard_error * e->standard_error;
    const double skewness = cube > 0 ? e->third_cumulant / cube : 0;
    if (!(skewness * sqrt(e->degrees_of_freedom + 1) > least_skewness))
        return 0;
    return skewness_correction * skewness * (1 + 2 * t * t) / 6;
}

struct orl_margins orl_estimate_margins(const struct orl_estimate *e)
{
    const double se = e->standard_error, bias = fabs(e->bias);
    if (!(se > 1e-6 * bias))
        return (struct orl_margins){bias, bias};
    const double student = student_over_normal(e->degrees_of_freedom);
    const double half = se * student * biased_95(bias / se);
    return (struct orl_margins){half, half + se * skewness_margin(e, student * normal_95)};
}
