/*
 * Rounds on their way, between rounds.c, which runs them, and goals.c, which says how large the
 * next one is, or that there is none, and what is left to do.
 */
#ifndef ORL_RUN_GOALS_H
#define ORL_RUN_GOALS_H

#include "run/cost.h"
#include "run/findings.h"

struct orl_rounds {
    struct orl_run_state *state;
    struct orl_work work;
    struct orl_pace pace;
    struct orl_findings findings;
    double error;    /* of the whole, as it stands */
    double samples;  /* of the round that runs; the mean over sensors */
    double *shares;  /* and those of each sensor; NULL: as many for all */
    uint32_t *spans; /* the same in whole numbers, then those of rounds before */
    struct orl_sensor_round sensor_round;
    double bandwidths[ORL_MAP_KINDS]; /* of the round */
    uint32_t count;
    uint32_t planned;                  /* of a job in one piece; 0: until its goal is met */
    double wanted;                     /* samples in all, as it is thought; NaN: until a deadline */
    double guessed_s[ORL_STAGE_COUNT]; /* of a job in one piece, before the first round */
    bool ended;
};

static inline double orl_rounds_now(const struct orl_rounds *r)
{
    const struct orl_run_env *env = r->state->env;
    return env->now_s(env->ctx);
}

/* Samples that the job may take in all, before anything is known of its errors; NaN: as many as a
 * deadline leaves room for. */
double orl_rounds_guess_wanted(const struct orl_rounds *r);

/* What the next round and those after it are going to take: into the state, for what is told. */
void orl_rounds_foresee(struct orl_rounds *r);

/* After a round of a job with a goal: r->samples of the next one, or r->ended and the outcome. */
void orl_rounds_go_on(struct orl_rounds *r, const struct orl_parts *parts);

#endif
