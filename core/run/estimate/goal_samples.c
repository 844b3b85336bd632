#include "run/estimate/goal_samples.h"

#include <math.h>

#include <oriel/base/limits.h>

/* Error that 95 % of an office's sensors stay within, by maps and by backward, and the samples for
 * it. */
static const double usual_error[] = {0.04, 0.02}, usual_samples[] = {4096, 2048};
/* For a goal of a DGP error. */
enum { LEAST_ROUNDS = 4 };

double orl_goal_estimate_samples(const struct orl_goal *goal, bool backward, double of_round)
{
    const double times = usual_error[backward] / goal->relative_error;
    if (goal->dgp_error > 0)
        return LEAST_ROUNDS * of_round;
    return goal->deadline_s > 0
               ? (double)NAN
               : fmin(times * times * usual_samples[backward], ORL_LIMIT_GOAL_SAMPLES);
}
