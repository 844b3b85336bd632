/* Functions beside those of oriel/annual/annual_metrics.h: the calendar of steps, the year of one
 * sensor, the distribution of a passing area. */
#ifndef ORL_METRICS_ANNUAL_ANNUAL_FIGURES_H
#define ORL_METRICS_ANNUAL_ANNUAL_FIGURES_H

#include <stdatomic.h>
#include <stddef.h>

#include <oriel/annual/annual_metrics.h>

/* Day of a year. */
struct orl_calendar_day {
    int month, day; /* both from 1 */
};

/* Returns the day of a step. */
struct orl_calendar_day orl_calendar_day_of(const struct orl_annual_steps *steps, uint32_t step);

/* Return the middle of a step: hours since the year began, and hours since midnight. */
static inline double orl_calendar_hour_of_year(const struct orl_annual_steps *steps, uint32_t step)
{
    return (step + 0.5) / steps->per_hour;
}
double orl_calendar_hour_of(const struct orl_annual_steps *steps, uint32_t step);

/* ---- The year of one sensor ------------------------------------------------------------------ */

/* 97.5 % quantile of Student's t with ORL_ANNUAL_DEGREES degrees of freedom. */
#define ORL_ANNUAL_Z 2.131449545559323

/* Returns the light of one of the sensors. */
struct orl_annual_light orl_annual_light_of(const struct orl_annual_rows *rows, size_t sensor);

bool orl_annual_errors_known(const struct orl_annual_metric *metric,
                             const struct orl_annual_light *row);

/* Returns the metric, and its lower and upper bound if all values are within z standard errors. */
struct orl_annual_value orl_annual_within(const struct orl_annual_metric *metric,
                                          const struct orl_annual_period *period,
                                          const struct orl_annual_light *row, double z);

/*
 * Distribution of the passing area, where each part of the area passes with its own probability.
 *
 * It is the distribution of a sum of independent parts that are present or absent
 * (Poisson-binomial), computed by convolution with one part after another: Barlow and Heidtmann
 * 1984, IEEE Trans. Reliability 33, 322. Parts of equal area need as many places as there are
 * parts, without rounding. Unequal areas are mapped to a grid of 2^14 places. An area between two
 * places is split between both, so that the mean is preserved.
 */

struct orl_area_part {
    double area, pass; /* pass: probability to pass, 0 to 1 */
};

/* Computes bounds of the sum: it is below low, and above high, with a probability of at most `tail`
 * each. Polls cancel, which may be NULL, at each part. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_passing_area_bounds(const struct orl_area_part *parts, size_t n, double tail,
                            const atomic_bool *cancel, double *ret_low, double *ret_high);

/* Return the share of Student's t distribution above t, with ORL_ANNUAL_DEGREES degrees of freedom
 * (Abramowitz and Stegun 1964, 26.7.3), and its inverse for 0 < share_above < 1. */
double orl_student_above(double t);
double orl_student_t(double share_above);

#endif
