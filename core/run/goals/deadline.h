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
#ifndef ORL_RUN_GOALS_DEADLINE_H
#define ORL_RUN_GOALS_DEADLINE_H

#include "run/estimate/round_cost.h"

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

#endif
