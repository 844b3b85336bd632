/*
 * Jobs that want an accuracy, or are given a time: rounds until the goal is met, or cannot be.
 *
 * A round is the job as it would run by itself, with settings by its size (cost.h) and a seed
 * of its own, made from the job's and the round's number; the first one's is the job's. Rounds are
 * independent, so that their findings are pooled (pooled_estimates.h): a value is the mean over
 * rounds, weighted by their mean samples. What comes before photons is done once.
 *
 * Sensors by backward, which is unbiased, do better: a sensor's samples go on in each round where
 * the last one's ended, so that all of them are as even as those of a job in one piece; only
 * virtual lamps are the round's own. And each round after the first gives more samples to sensors
 * of more noise (sample_allocation.h). Photon maps have a bias that
 * pooling leaves as it is; as in probabilistic progressive photon mapping (Knaus and Zwicker 2011)
 * their bandwidths therefore shrink with all the photons so far: a kernel's area goes as their
 * number to the power -1/3, by which bias and noise fall together.
 *
 * An accuracy: the error is what percentile.h takes it to be: the share of sensors, or of pixels,
 * that the goal names is within it with a probability of 0.975. The first round is small; its
 * error and that variances fall as the inverse of samples say how much there is to do. Sizes depend
 * on errors and counts alone, never on time: the same job and seed give the same bytes.
 *
 * A deadline: rounds are sized from the time that those before took, each to fill most of what is
 * left; views by a final gather have rays by the size of a round, too. What such a job finds
 * depends on the machine, and is never twice the same.
 */
#ifndef ORL_RUN_ROUNDS_H
#define ORL_RUN_ROUNDS_H

#include "run/stages.h"

/* Photons, maps and render stages of a job with a goal, over and over. */
int orl_run_rounds(struct orl_run_state *state, struct orl_error *err);

#endif
