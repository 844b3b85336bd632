/*
 * A sampled value with its error estimate.
 *
 * A variance comes from a few independent parts or groups, one more than the standard error has
 * degrees of freedom. A sum of independent values has more degrees of freedom
 * (Welch-Satterthwaite).
 *
 * The 95 % interval is valid for an estimate whose bias is no larger than estimated, in either
 * direction. Its half-width is the standard error times the 95th percentile of |N(b, 1)|, where b
 * is the bias in standard errors. The percentile is 1.96 without bias, and b + 1.64 from b = 1 on.
 * The half-width is multiplied by the ratio of Student's t to the normal law for the few degrees of
 * freedom. The value is not corrected: near the edge of a shadow a bias estimate is more reliable
 * in size than in sign.
 *
 * With sparse events, most groups find little light and a few find much. An estimate that comes out
 * low then has too small a standard error. Therefore the interval is wider above the value, by the
 * groups' skewness (Johnson's modified t); below the value it is unchanged. Skewness that chance
 * alone gives so few groups does not count. Events that all groups have missed may be estimated
 * from other sensors (sparse_events.h).
 *
 * References: Welch 1947, Biometrika 34, 28; Johnson 1978, Journal of the American Statistical
 * Association 73, 536; Armstrong and Kolesar 2020, Quantitative Economics 11, 1 (intervals with
 * known bias); Abramowitz and Stegun 1964, 26.7.5 (Student's t).
 */
#ifndef ORL_BASE_STATISTICS_ESTIMATE_H
#define ORL_BASE_STATISTICS_ESTIMATE_H

#include <stdint.h>

#include <oriel/base/vec.h>

#include "base/statistics/sparse_events.h"

struct orl_estimate {
    struct orl_rgb value;
    /* Errors of the luma of `value`. */
    double standard_error,
        degrees_of_freedom;      /* standard error and its degrees of freedom, above 0 */
    double bias;                 /* estimated bias; positive: the value is too high */
    double third_cumulant;       /* third cumulant: skewness times the cube of the standard error */
    struct orl_ray_moments rays; /* moments of the contributions of single rays, if counted */
};

/* Returns the mean of two or more independent values, with the error by their spread. */
struct orl_estimate orl_estimate_of_mean(const struct orl_rgb *values, uint32_t count);

/* Returns the sum of two independent terms. */
struct orl_estimate orl_estimate_add(struct orl_estimate a, struct orl_estimate b);

/* Distances from the value's luma to the lower and the upper end of its 95 % interval. */
struct orl_margins {
    double below, above;
};
struct orl_margins orl_estimate_margins(const struct orl_estimate *estimate);

#endif
