/*
 * The error bound that a share of many estimates keeps to, and the allocation of samples that
 * reduces it.
 */
#ifndef ORL_RUN_GOALS_PERCENTILE_H
#define ORL_RUN_GOALS_PERCENTILE_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Error bound that a share of many estimates keeps to: the at-percentile of |x_i - truth_i| /
 * max(x_i, floor), where estimate i has a bias b_i and a normal error of deviation s_i.
 *
 * The percentile itself is random: which of 57 sensors have large errors differs from seed to seed.
 * A job must keep its goal as a rule, and it tests the goal more than once. The functions therefore
 * return not its mean but a bound that holds with probability 0.975. It is the least x at which,
 * with that probability, the number of errors beyond x is at most the number that the share allows.
 * The number is a sum of independent trials (Poisson's binomial). If few are allowed its
 * distribution is computed; otherwise its quantile is Cornish and Fisher's, with skewness.
 *
 * Standard errors are estimates as well, some too small and some too large. Their scatter makes the
 * mixture of many wider than the true errors are. The probability that one is beyond x is therefore
 * an unbiased estimate that accounts for the degrees of freedom of its standard error (Kolmogorov
 * 1950; Lieberman and Resnikoff 1955, Journal of the American Statistical Association 50, 457). It
 * uses the distribution of one of n normal values over the root of their sum of squares, a
 * transformed Student's t. Here that is Wallace's approximation (1959, Annals of Mathematical
 * Statistics 30, 1121).
 *
 * If there are more than a few thousand estimates, usually pixels, some thousand evenly spaced ones
 * are used. They count as independent, which neighbouring pixels are not.
 */

struct orl_estimates {
    const double *value, *error;
    const double *bias; /* NULL: unknown */
    /* Variance of one sample, if samples can be allocated by noise; else NULL. */
    const double *noise;
    double samples; /* mean number so far, if noise is known */
    size_t count;
    double floor; /* least divisor, as a share of the mean value */
    double
        degrees_of_freedom; /* degrees of freedom of the errors, more than 2; 0: errors are exact */
};

/* Floors, as in study.h. */
extern const double orl_floor_of_sensors, orl_floor_of_pixels;

/* Returns the bound; NaN if an error is unknown, 0 if all values are 0. */
double orl_percentile_error(const struct orl_estimates *estimates, double at);

/*
 * Returns the total work, relative to that done so far, that brings the bound down to target, if
 * each estimate gets the same increase. Variances are inversely proportional to the work. Biases
 * fall with its power -1/3, as Knaus and Zwicker (2011, "Progressive photon mapping: a
 * probabilistic approach") derive for shrinking bandwidths.
 */
double orl_percentile_work(const struct orl_estimates *estimates, double at, double target);

/*
 * Allocates a round's samples to sensors. The noise of one sample differs by factors between
 * sensors, and equal numbers would waste samples on accurate ones. Samples are proportional to
 * relative standard deviations, which minimises the mean of squared relative errors (Neyman 1934,
 * Journal of the Royal Statistical Society 97, 558). A part is allocated equally, because noise is
 * itself an estimate, and a sensor whose noise is small by chance must still get samples.
 *
 * Shares depend on earlier rounds alone. Rounds are weighted by their mean number of samples,
 * whatever an individual sensor got. Weights by a sensor's own noise would correlate with its
 * value, if tails are heavy, and bias it downwards. So means stay unbiased.
 */

/*
 * Returns the total samples, relative to those so far, that bring the bound of orl_percentile_error
 * down to target; at least 1. For estimates without bias and of known noise. Returns NaN if out of
 * memory.
 */
double orl_allocation_work(const struct orl_estimates *estimates, double at, double target);

/* Sets the samples of each sensor in a round of that mean. */
void orl_allocate_samples(const struct orl_estimates *estimates, double mean, double *ret_samples);

#endif
