/*
 * How much of an area passes, where each part of it has a chance of its own to.
 *
 * The distribution of a sum of independent parts that are there or not (Poisson-binomial), by
 * convolution with one part after another: Barlow and Heidtmann 1984, IEEE Trans. Reliability 33,
 * 322. Parts of equal area need as many places as there are parts, and nothing is rounded. Areas
 * that differ go onto a grid of 2^14 places; what falls between two goes to both, so that the mean
 * is kept.
 */
#ifndef ORL_METRICS_ANNUAL_CHANCE_H
#define ORL_METRICS_ANNUAL_CHANCE_H

#include <stdatomic.h>
#include <stddef.h>

struct orl_area_part {
    double area, pass; /* pass: its chance, 0 to 1 */
};

/* The sum's bounds: with a probability of `tail` at most each it is below low, or above high.
 * Polls cancel, or NULL, at each part. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_chance_bounds(const struct orl_area_part *parts, size_t n, double tail,
                      const atomic_bool *cancel, double *ret_low, double *ret_high);

/* The share of Student's t, with ORL_ANNUAL_DEGREES degrees of freedom, above t (Abramowitz and
 * Stegun 1964, 26.7.3); and the t that so much is above; 0 < share < 1. */
double orl_student_above(double t);
double orl_student_t(double share_above);

#endif
