/*
 * How long a run still takes, and so how much of it is done.
 *
 * What is told as done is a share of time: elapsed / (elapsed + left). Whoever takes the rest of
 * the time from it (elapsed * (1 - done) / done) gets what is left as it is thought here. Of the
 * stage under way that is what it was foreseen to take, and more and more what its own progress
 * says; of those to come, what they were foreseen to take, times how much longer than foreseen the
 * ones before took. A stage that overruns is never thought to be all but done. What is told never
 * falls.
 *
 * Functions of times and fractions alone: they look at no clock.
 */
#ifndef ORL_RUN_AHEAD_H
#define ORL_RUN_AHEAD_H

#include <oriel/run.h>

struct orl_ahead {
    double foreseen_s[ORL_STAGE_COUNT]; /* of each stage, by the whole crew */
    double spent_s[ORL_STAGE_COUNT];    /* of those before the one under way */
    enum orl_stage stage;               /* under way */
    double fraction;                    /* of it, as it tells itself; 0: it does not say */
    double in_stage_s;                  /* since it began */
};

/* Seconds until the last stage ends. */
double orl_ahead_left_s(const struct orl_ahead *ahead);

/* The share that is done: of a run that has so much behind it and so much left. 0..1 */
double orl_ahead_share(double elapsed_s, double left_s);

/*
 * The share of a run that was thought to take so long in all. Near the end, and beyond, it goes on
 * ever more slowly, for nothing is known of the rest.
 */
double orl_ahead_share_of(double elapsed_s, double all_s);

/* Before a job with a goal has seen its first round: how many more like it there may be. */
extern const double orl_ahead_rounds;

#endif
