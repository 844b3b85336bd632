/*
 * A value with what is known of its error.
 *
 * Variances come from a few independent parts or groups each, one more than a standard error has
 * degrees of freedom; of a sum of independent ones it has more (Welch-Satterthwaite).
 *
 * The 95 % interval lies evenly about the value. It is as wide as it must be for an estimate whose
 * bias is no larger than estimated, to whichever side: half of it is the standard error times the
 * 95th percentile of |N(b, 1)|, b the bias in standard errors (1.96 without any; b + 1.64 from b =
 * 1 on), times what Student's t has over a normal law for so few degrees of freedom. The value is
 * not corrected: near the edge of a shadow a bias estimate tells a size better than a sign.
 *
 * References: Welch 1947, Biometrika 34, 28; Armstrong and Kolesar 2020, Quantitative Economics 11,
 * 1 (intervals that know of a bias); Abramowitz and Stegun 1964, 26.7.5 (Student's t).
 */
#ifndef ORL_RENDER_ESTIMATE_H
#define ORL_RENDER_ESTIMATE_H

#include <stdint.h>

#include <oriel/vec.h>

struct orl_estimate {
    struct orl_rgb value;
    /* Of its luma: */
    double standard_error, degrees; /* and its degrees of freedom, more than 0 */
    double bias;                    /* what it is thought to be too high */
};

/* The mean of several independent values, 2 or more, by their spread. */
struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count);

/* The two as independent terms of a sum. */
struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b);

/* Half of the 95 % interval of the value's luma. */
double orl_estimate_half_width(const struct orl_estimate *estimate);

#endif
