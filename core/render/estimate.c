#include "render/estimate.h"

#include <math.h>

static const double normal_95 = 1.959963984540054;

struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count)
{
    struct orl_rgb mean = orl_gray(0);
    double square = 0;
    for (uint32_t i = 0; i < count; i++)
        mean = orl_rgb_add(mean, orl_rgb_scale(values[i], 1.0 / count));
    for (uint32_t i = 0; i < count; i++) {
        const double off = orl_luma(values[i]) - orl_luma(mean);
        square += off * off;
    }
    return (struct orl_estimate){
        .value = mean, .standard_error = sqrt(square / count / (count - 1)), .degrees = count - 1};
}

struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b)
{
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
    const double spread = va * va / a.degrees + vb * vb / b.degrees;
    return (struct orl_estimate){.value = orl_rgb_add(a.value, b.value),
                                 .standard_error = sqrt(va + vb),
                                 .degrees = spread > 0 ? (va + vb) * (va + vb) / spread
                                                       : fmin(a.degrees, b.degrees),
                                 .bias = a.bias + b.bias};
}

/* Student's t over the normal law, at 97.5 %: the first terms in 1 / degrees, good to 1 % from 3
 * degrees on. */
static double student_over_normal(double degrees)
{
    const double z2 = normal_95 * normal_95, d = degrees;
    return 1 + (z2 + 1) / (4 * d) + ((5 * z2 + 16) * z2 + 3) / (96 * d * d) +
           (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * d * d * d);
}

static double normal_below(double x)
{
    return 0.5 * erfc(-x * sqrt(0.5));
}

/* The 95th percentile of |N(bias, 1)|, by Newton's method: from above, where the law is concave. */
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

double orl_estimate_half_width(const struct orl_estimate *e)
{
    const double se = e->standard_error, bias = fabs(e->bias);
    if (!(se > 1e-6 * bias))
        return bias;
    return se * student_over_normal(e->degrees) * biased_95(bias / se);
}
