/*
 * The error that a share of many estimates keep to, from what is known of each: the at-percentile
 * of |x_i - truth_i| / max(x_i, floor), where estimate i is off by its bias b_i and a normal error
 * of deviation s_i.
 *
 * The percentile itself is by chance: which of 57 sensors come out badly differs from seed to seed.
 * What is returned is therefore not its mean but a bound that holds with a probability of
 * 0.975, for a job is to keep its goal as a rule and looks at it more than once: the
 * least x at which the number of errors beyond x, a sum of independent trials (Poisson's binomial),
 * is at most the number that the share allows, with that probability. Where few are allowed the
 * sum's law is worked out; else its quantile is Cornish and Fisher's, with skewness.
 *
 * Standard errors are estimates too, some too small and some too large, and among many that scatter
 * makes the mixture of all wider than their errors are. The probability of each to be beyond x is
 * therefore the unbiased estimate of it by a standard error of so many degrees of freedom
 * (Kolmogorov 1950; Lieberman and Resnikoff 1955, Journal of the American Statistical Association
 * 50, 457): by the law of one of as many normal values over the root of their sum of squares, which
 * is a transformed Student's t, here in Wallace's approximation (1959, Annals of Mathematical
 * Statistics 30, 1121).
 *
 * Of more than a few thousand estimates, pixels as a rule, some thousand are looked at, evenly
 * spread. They count as independent, which pixels next to each other are not.
 */
#ifndef ORL_RUN_PERCENTILE_H
#define ORL_RUN_PERCENTILE_H

#include <stdbool.h>
#include <stddef.h>

struct orl_estimates {
    const double *value, *error;
    const double *bias;  /* NULL: none is known */
    const double *noise; /* variance of one sample, where they can be shared out; else NULL */
    double samples;      /* so far, mean; of those of which the noise is known */
    size_t count;
    double floor;   /* share of the mean value below which nothing is divided by */
    double degrees; /* of freedom of the errors, more than 2; 0: they are exact */
};

/* study.h's floors. */
extern const double orl_floor_of_sensors, orl_floor_of_pixels;

/* The bound; NaN when an error is not known. 0 when all is black. */
double orl_percentile_error(const struct orl_estimates *estimates, double at);

/* Whether it is at most that. */
bool orl_percentile_is_kept(const struct orl_estimates *estimates, double at, double target);

/*
 * How many times the work done so far it takes, in all, to bring the bound down to target, when it
 * is as much more for each.
 * Variances fall as the inverse of the work; biases as its power -1/3, which is what Knaus and
 * Zwicker (2011, "Progressive photon mapping: a probabilistic approach") have of shrinking
 * bandwidths.
 */
double orl_percentile_work(const struct orl_estimates *estimates, double at, double target);

#endif
