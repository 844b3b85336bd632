/*
 * What a job for a deadline does next: another round, of what size, or no more. By the seconds that
 * rounds have taken (cost.h); it looks at no clock.
 *
 * Rounds each fill most of what is left, so that an estimate that is off spoils little; the last
 * one fills nearly all; where the largest round that there may be is shorter than that it is two,
 * or more. The smallest round there is has a length, too: by photon maps a view is rendered as a
 * whole each time, by a final gather with a quarter of its usual rays at the least (cost.h). Where
 * even that does not fit the job ends with time to spare, and says so.
 */
#ifndef ORL_RUN_DEADLINE_H
#define ORL_RUN_DEADLINE_H

#include "run/cost.h"

enum orl_deadline_step {
    ORL_DEADLINE_ROUND,    /* another one, of `samples` */
    ORL_DEADLINE_USED_UP,  /* hardly anything is left */
    ORL_DEADLINE_NO_ROOM,  /* some is left, but less than the smallest round takes */
    ORL_DEADLINE_TOO_LATE, /* it has passed */
};

struct orl_deadline_next {
    enum orl_deadline_step step;
    double samples; /* of the round */
    bool last;      /* it fills nearly all that is left */
    double least_s; /* what the smallest round is thought to take */
};

/* Samples of the first round: the least, or, of views that are rendered as a whole each time, where
 * a second round would not fit, as many as fill most of what is left. photons_s, render_s: what
 * ORL_DEFAULT_GATHER_SAMPLES' worth of photons, and the views, are thought to take. */
double orl_deadline_first(const struct orl_work *work, double photons_s, double render_s,
                          double left_s);

struct orl_deadline_next orl_deadline_next(const struct orl_pace *pace, const struct orl_work *work,
                                           double deadline_s, double left_s);

/* What is left of the job while a round goes on that still takes so long, when it is so long until
 * the deadline: all of that, unless the round leaves no more than what is not worth another one. */
double orl_deadline_left_s(double round_s, double until_s, double deadline_s);

#endif
