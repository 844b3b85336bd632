/*
 * How long a run still takes, and so how much of it is done.
 *
 * What is left of the stage under way is what it was foreseen to take, and more and more what its
 * own progress says; of those to come, what they were foreseen to take, times how much longer than
 * foreseen the ones before took. Where a pilot has tried photons the costs of all are this
 * machine's already, and stages before say nothing of those to come. A stage that overruns is never
 * thought to be all but done.
 *
 * A stage may go in phases, each of one kind of work: what is left of the one under way goes by its
 * own progress, and what comes after it by all of the stage so far.
 *
 * What is told as done goes on as fast as gets it to the end when the time is over: where what is
 * left was thought rightly from the start it is a share of time, elapsed / (elapsed + left). It
 * never falls and never stands still, whatever is found out on the way.
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
    double phase_from, phase_to;        /* of the stage; both 0: it is one phase */
    double in_phase_s;                  /* since it began */
};

/* Seconds until the last stage ends. */
double orl_ahead_left_s(const struct orl_ahead *ahead);

/* The share that is done, that long after it was `before`, with so much left. 0..1 */
double orl_ahead_share(double before, double since_s, double left_s);

#endif
