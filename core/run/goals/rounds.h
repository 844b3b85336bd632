/*
 * Jobs with an accuracy or a deadline: rounds until the goal is met or cannot be met.
 *
 * A round is the job as it would run alone, with settings by the round's size (round_cost.h). Its
 * seed is derived from the job's and the round's number; the first round has the job's. Rounds are
 * independent, so that their results are pooled (pooled_estimates.h): a value is the mean over
 * rounds, weighted by their mean samples. All work before photons is done once.
 *
 * Sensors by backward, which is unbiased, continue their sample sequence in each round, so that all
 * samples are as well stratified as without rounds. Only the virtual lights are new in each round.
 * Rounds after the first allocate more samples to noisier sensors (sample_allocation.h). Photon
 * maps have a bias that pooling does not reduce. As in probabilistic progressive photon mapping
 * (Knaus and Zwicker 2011) their bandwidths therefore shrink with the photons so far: a kernel's
 * area is proportional to their number to the power -1/3, by which bias and noise fall together.
 *
 * Accuracy: the error is defined in percentile.h. The share of sensors, or of pixels, that the goal
 * names is within it with a probability of 0.975. The first round is small. Its error, and that
 * variances are inversely proportional to samples, determine the remaining work. Sizes depend on
 * errors and counts alone, never on time: the same job and seed give the same bytes.
 *
 * Deadline: rounds are sized from the time of earlier ones, each to fill most of the time left.
 * Views by a final gather have rays in proportion to a round's size as well. The results depend on
 * the machine and differ from run to run.
 */
#ifndef ORL_RUN_GOALS_ROUNDS_H
#define ORL_RUN_GOALS_ROUNDS_H

#include "run/run_state.h"

/* Runs the photons, maps and render stages of a job in rounds. */
int orl_run_rounds(struct orl_run_state *state, struct orl_error *err);

#endif
