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
#ifndef ORL_RUN_GOALS_SAMPLE_ALLOCATION_H
#define ORL_RUN_GOALS_SAMPLE_ALLOCATION_H

#include "run/goals/percentile.h"

/*
 * Returns the total samples, relative to those so far, that bring the bound of percentile.h down to
 * target; at least 1. For estimates without bias and of known noise. Returns NaN if out of memory.
 */
double orl_allocation_work(const struct orl_estimates *estimates, double at, double target);

/* Sets the samples of each sensor in a round of that mean. */
void orl_allocate_samples(const struct orl_estimates *estimates, double mean, double *ret_samples);

#endif
