/* Jobs with an accuracy or a deadline: rounds, and the choice of the next one. */
#ifndef ORL_RUN_GOALS_ROUNDS_H
#define ORL_RUN_GOALS_ROUNDS_H

#include "run/estimate/round_cost.h"
#include "run/goals/pooled_results.h"
#include "run/run_state.h"

/*
 * Chooses the next step of a job with a deadline: another round, of what size, or the end. It uses
 * the seconds of earlier rounds (round_cost.h) and reads no clock.
 *
 * Each round fills most of the remaining time, so that a wrong estimate does little harm. The last
 * one fills nearly all of it. If the largest possible round is shorter than that, there are two or
 * more. The smallest round has a minimum length too: by photon maps a view is rendered completely
 * each time, by a final gather with at least a quarter of its usual rays (round_cost.h). If even
 * that does not fit, the job ends early and reports it.
 */

enum orl_deadline_step {
    ORL_DEADLINE_ROUND,    /* another round of `samples` */
    ORL_DEADLINE_USED_UP,  /* almost no time is left */
    ORL_DEADLINE_NO_ROOM,  /* the time left is less than the smallest round */
    ORL_DEADLINE_TOO_LATE, /* the deadline has passed */
};

struct orl_deadline_next {
    enum orl_deadline_step step;
    double samples; /* samples of the next round */
    bool last;      /* true if it fills nearly all of the time left */
    double least_s; /* estimated seconds of the smallest round */
};

/*
 * Returns the samples of the first round: the minimum, or enough to fill most of the time left, if
 * views are rendered completely each time and a second round would not fit. photons_s, render_s:
 * estimated seconds of photons for ORL_DEFAULT_GATHER_SAMPLES, and of the views.
 */
double orl_deadline_first(const struct orl_work *work, double photons_s, double render_s,
                          double left_s);

struct orl_deadline_next orl_deadline_next(const struct orl_throughput *throughput,
                                           const struct orl_work *work, double deadline_s,
                                           double left_s);

/* Returns the remaining seconds of the job during a round: round_s until its end, until_s until the
 * deadline. That is until_s, unless the time after the round is too short for another one. */
double orl_deadline_left_s(double round_s, double until_s, double deadline_s);

/* State shared by rounds.c, which runs the rounds, and next_round.c, which decides whether and how
 * they continue. */

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
    /* Number of rounds of a job in equal rounds; 0: until its goal is met. */
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

/*
 * Jobs with an accuracy or a deadline: rounds until the goal is met or cannot be met.
 *
 * A round is the job as it would run alone, with settings by the round's size (round_cost.h). Its
 * seed is derived from the job's and the round's number; the first round has the job's. Rounds are
 * independent, so that their results are pooled (pooled_results.h): a value is the mean over
 * rounds, weighted by their mean samples. All work before photons is done once.
 *
 * Sensors by backward, which is unbiased, continue their sample sequence in each round, so that all
 * samples are as well stratified as without rounds. Only the virtual lights are new in each round.
 * Rounds after the first allocate more samples to noisier sensors (percentile.h). Photon
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

/* Runs the photons, maps and render stages of a job in rounds. */
int orl_run_rounds(struct orl_run_state *state, struct orl_error *err);

#endif
