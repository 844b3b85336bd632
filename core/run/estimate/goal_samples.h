/* Estimates the work of a job for an accuracy before its errors are known. */
#ifndef ORL_RUN_ESTIMATE_GOAL_SAMPLES_H
#define ORL_RUN_ESTIMATE_GOAL_SAMPLES_H

#include <oriel/job/run.h>

/* Returns the total samples of a sensor, as rounds count them (round_cost.h), by backward or by
 * maps. of_round: samples of a round, for goals of a DGP error. NaN: limited only by a deadline. */
double orl_goal_estimate_samples(const struct orl_goal *goal, bool backward, double of_round);

#endif
