/* Estimates the work of a job for an accuracy before its errors are known. */
#ifndef ORL_RUN_PROGRESS_GOAL_COST_H
#define ORL_RUN_PROGRESS_GOAL_COST_H

#include <oriel/run.h>

/* Returns the total samples of a sensor, as rounds count them (round_cost.h), by backward or by
 * maps. of_round: samples of a round, for goals of a DGP error. NaN: limited only by a deadline. */
double orl_goal_guess_samples(const struct orl_goal *goal, bool backward, double of_round);

#endif
