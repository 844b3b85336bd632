/*
 * A round's samples shared out among sensors. The noise of one sample differs by factors from
 * sensor to sensor, and as many for each would be spent on those that are good already: samples go
 * as relative standard deviations, by which the mean of squared relative errors is the least that
 * so many samples allow (Neyman 1934, Journal of the Royal Statistical Society 97, 558). A part of
 * them goes evenly, for noise is itself an estimate, and one that is small by chance must not
 * starve its sensor.
 *
 * Shares depend on earlier rounds alone, and rounds are weighted by their mean number of samples,
 * whatever a sensor got of it: a weight that knew of a sensor's own noise would know of its value
 * too, where tails are heavy, and pull it down. So means stay unbiased.
 */
#ifndef ORL_RUN_SAMPLE_ALLOCATION_H
#define ORL_RUN_SAMPLE_ALLOCATION_H

#include "run/percentile.h"

/*
 * How many times the samples so far it takes, in all, to bring the bound of percentile.h down to
 * target; at least 1. Estimates without a bias, of known noise. NaN without memory.
 */
double orl_allocation_work(const struct orl_estimates *estimates, double at, double target);

/* Samples for each in a round, of that mean. */
void orl_allocate_samples(const struct orl_estimates *estimates, double mean, double *ret_samples);

#endif
