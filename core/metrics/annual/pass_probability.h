/*
 * Distribution of the passing area, where each part of the area passes with its own probability.
 *
 * It is the distribution of a sum of independent parts that are present or absent
 * (Poisson-binomial), computed by convolution with one part after another: Barlow and Heidtmann
 * 1984, IEEE Trans. Reliability 33, 322. Parts of equal area need as many places as there are
 * parts, without rounding. Unequal areas are mapped to a grid of 2^14 places. An area between two
 * places is split between both, so that the mean is preserved.
 */
#ifndef ORL_METRICS_ANNUAL_PASS_PROBABILITY_H
#define ORL_METRICS_ANNUAL_PASS_PROBABILITY_H

#include <stdatomic.h>
#include <stddef.h>

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
