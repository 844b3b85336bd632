/*
 * A value with what is known of its error.
 *
 * Variances come from a few independent parts or groups each, one more than a standard error has
 * degrees of freedom; of a sum of independent ones it has more (Welch-Satterthwaite).
 *
 * The 95 % interval is as wide as it must be for an estimate whose bias is no larger than
 * estimated, to whichever side: half of it is the standard error times the 95th percentile of |N(b,
 * 1)|, b the bias in standard errors (1.96 without any; b + 1.64 from b = 1 on), times what
 * Student's t has over a normal law for so few degrees of freedom. The value is not corrected: near
 * the edge of a shadow a bias estimate tells a size better than a sign.
 *
 * Where light is rare most groups find little and a few find much. An estimate that comes out low
 * then thinks itself surer than it is, so that above the value the interval is wider by what the
 * groups' skewness calls for (Johnson's modified t); below it is left as it is. Skewness that
 * chance alone gives so few groups does not count. What groups have missed altogether other sensors
 * may tell (rare.h).
 *
 * References: Welch 1947, Biometrika 34, 28; Johnson 1978, Journal of the American Statistical
 * Association 73, 536; Armstrong and Kolesar 2020, Quantitative Economics 11,
 * 1 (intervals that know of a bias); Abramowitz and Stegun 1964, 26.7.5 (Student's t).
 */
#ifndef ORL_BASE_ESTIMATE_H
#define ORL_BASE_ESTIMATE_H

#include <stdint.h>

#include <oriel/vec.h>

#include "base/rare.h"

struct orl_estimate {
    struct orl_rgb value;
    /* Of its luma: */
    double standard_error, degrees; /* and its degrees of freedom, more than 0 */
    double bias;                    /* what it is thought to be too high */
    double third;         /* third cumulant: its skewness times the cube of the standard error */
    struct orl_rays rays; /* what single ones added to it, where they were counted */
};

/* The mean of several independent values, 2 or more, by their spread. */
struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count);

/* The two as independent terms of a sum. */
struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b);

/* How far the 95 % interval of the value's luma reaches below it, and above. */
struct orl_margins {
    double below, above;
};
struct orl_margins orl_estimate_margins(const struct orl_estimate *estimate);

#endif
