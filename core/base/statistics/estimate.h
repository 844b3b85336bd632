/*
 * Sampled values with their error estimates, and error bounds for sparse events.
 *
 * Sparse events are light that so few of a sensor's rays find that their spread does not give its
 * error. A sensor whose rays have found none of this light is too low, and its own rays do not show
 * it. But other sensors of the job have found some. Let f be the sum of the fourth powers of the
 * contributions of a sensor's rays, and e the sum of their eighth powers. The effective number of
 * the brightest rays is f^2 / e, as Kish's effective number of weights. It is in the hundreds if
 * the brightest rays are those to a window. It is one or two if single rays are several times as
 * bright as the many others. If the brightest rays are few and make up most of the sensor's
 * variance, they are treated as events of one size. Their number has a Poisson law, with a separate
 * rate for each sensor. The rates are assumed to be exponentially distributed over sensors (the law
 * of maximum entropy for a given mean). The mean is estimated from all sensors. Given k events of
 * its own, a sensor's rate then has a gamma distribution of shape 1 + k. If every sensor has many
 * brightest rays, nothing changes.
 *
 * Sensors of different orientation see different light. So the sensors of a job are pooled by the
 * axis, up or down it, that each faces most.
 *
 * If one sensor has a hundredth of another's light, indoors beside a street, the size of such an
 * event there is not known: the same or a hundredth. It is assumed to scale with the square root of
 * the light, half way between the two.
 *
 * Events that all such sensors have missed stay unknown; so do those of a single sensor.
 *
 * References: Kish 1965, Survey Sampling (effective numbers); Buehlmann 1967, ASTIN Bulletin 4, 199
 * (credibility: the weight of a claim rate's own data); Wilson and Hilferty 1931, Proceedings of
 * the National Academy of Sciences 17, 684 (percentiles of gamma laws).
 */
#ifndef ORL_BASE_STATISTICS_ESTIMATE_H
#define ORL_BASE_STATISTICS_ESTIMATE_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>
#include <oriel/job/run.h>

/* Sums of powers of the contributions of single rays to a sensor's luma. */
struct orl_ray_moments {
    double fourths, eighths;
};

static inline void orl_ray_moments_add(struct orl_ray_moments *moments, double luma)
{
    const double fourth = luma * luma * luma * luma;
    moments->fourths += fourth;
    moments->eighths += fourth * fourth;
}

/* Returns the moments of a sum of two sets of rays, scaled by these factors. */
struct orl_ray_moments orl_ray_moments_mix(struct orl_ray_moments a, double of_a,
                                           struct orl_ray_moments b, double of_b);

enum { ORL_SENSOR_ORIENTATIONS = 6 }; /* orientations of sensors: dominant axis and its sign */

int orl_sensor_orientation(struct orl_vec3 direction);

/* Sparse events of all sensors of a job with one orientation. */
struct orl_sparse_events {
    double events; /* mean number per sensor; 0: no sparse events */
    double size;   /* size of an event, in the square root of the unit of contributions */
    double light;  /* mean value of the sensors */
};

/* Input of orl_sparse_events_of: values, and standard errors by the spread of groups, both in the
 * unit of contributions. */
struct orl_sparse_event_sensors {
    const struct orl_sensor *sensors;
    const struct orl_ray_moments *moments;
    const double *values, *standard_errors;
    size_t count;
};
void orl_sparse_events_of(const struct orl_sparse_event_sensors *sensors,
                          struct orl_sparse_events ret_sparse[ORL_SENSOR_ORIENTATIONS]);

/* Lower bounds on a sensor's standard error, and on the distances from its value to the ends of its
 * 95 % interval; all 0 without sparse events. */
struct orl_sparse_event_bounds {
    double standard_error, below, above;
};
struct orl_sparse_event_bounds orl_sparse_event_bounds(const struct orl_sparse_events *sparse,
                                                       const struct orl_ray_moments *own,
                                                       double value);

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
 * from other sensors (above).
 *
 * References: Welch 1947, Biometrika 34, 28; Johnson 1978, Journal of the American Statistical
 * Association 73, 536; Armstrong and Kolesar 2020, Quantitative Economics 11, 1 (intervals with
 * known bias); Abramowitz and Stegun 1964, 26.7.5 (Student's t).
 */

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
