/* State shared by rounds.c, which runs the rounds, and next_round.c, which decides whether and how
 * they continue. */
#ifndef ORL_RUN_GOALS_NEXT_ROUND_H
#define ORL_RUN_GOALS_NEXT_ROUND_H

#include "run/estimate/round_cost.h"
#include "run/goals/pooled_results.h"

struct orl_rounds {
    struct orl_run_state *state;
    struct orl_work work;
    struct orl_throughput throughput;
    struct orl_pooled_results results;
    double error;            /* current error of the whole job */
    double samples;          /* samples of the current round; the mean over sensors */
    double *shares;          /* samples of each sensor; NULL: equal for all */
    uint32_t *sample_counts; /* the same in whole numbers, followed by the sums of earlier rounds */
    struct orl_sensor_round sensor_round;
    double bandwidths[ORL_MAP_KINDS]; /* for the current round */
    uint32_t count;
    /* Number of rounds of a job in equal parts; 0: until its goal is met. */
    uint32_t planned;
    double wanted; /* estimated total samples; NaN: until a deadline */
    /* Estimate for the job without rounds, made before the first one. */
    double estimated_s[ORL_STAGE_COUNT];
    bool ended;
};

static inline double orl_rounds_now(const struct orl_rounds *r)
{
    const struct orl_run_env *env = r->state->env;
    return env->now_s(env->ctx);
}

/* Returns the estimated total samples before errors are known; NaN: limited only by a deadline. */
double orl_rounds_estimate_samples(const struct orl_rounds *r);

/* Estimates the next round and those after it, and stores the times in the state, for progress
 * reports. */
void orl_rounds_estimate(struct orl_rounds *r);

/* Handles the end of a round of a job with a goal: sets r->samples of the next one, or r->ended and
 * the outcome. */
void orl_rounds_plan_next(struct orl_rounds *r, const struct orl_output_estimates *outputs);

#endif
