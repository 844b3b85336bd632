/* What a job for an accuracy is going to take, before anything is known of its errors. */
#ifndef ORL_RUN_GOAL_GUESS_H
#define ORL_RUN_GOAL_GUESS_H

#include <oriel/run.h>

/* Samples of a sensor in all, as rounds count them (cost.h), by backward or by maps; of an error of
 * DGP in rounds of so many. NaN: as many as a deadline leaves room for. */
double orl_goal_guess_samples(const struct orl_goal *goal, bool backward, double of_round);

#endif
