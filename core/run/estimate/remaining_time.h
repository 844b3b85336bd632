/*
 * Remaining time of a run, and the share that is done.
 *
 * The remaining time of the current stage is its estimate, replaced gradually by an extrapolation
 * of its own progress. For later stages it is their estimate, scaled by the ratio of actual to
 * estimated time so far. If a pilot has traced photons, all estimates are already for this machine,
 * and earlier stages do not scale later ones. A stage that overruns always keeps some remaining
 * time.
 *
 * A stage may have phases, each of one kind of work. The remaining time of the current phase
 * follows from its own progress, that of later ones from the whole stage so far.
 *
 * The reported share grows at a rate that reaches 1 when the remaining time is over. If the
 * remaining time was right from the start it is a share of time, elapsed / (elapsed + left). It
 * never decreases and never stands still, however estimates change.
 *
 * All functions depend on their arguments alone; they read no clock.
 */
#ifndef ORL_RUN_ESTIMATE_REMAINING_TIME_H
#define ORL_RUN_ESTIMATE_REMAINING_TIME_H

#include <oriel/job/run.h>

struct orl_remaining_time {
    double estimated_s[ORL_STAGE_COUNT]; /* estimate for each stage, by the whole crew */
    double spent_s[ORL_STAGE_COUNT];     /* time of the stages before the current one */
    enum orl_stage stage;                /* current stage */
    double fraction;                     /* reported progress of the stage; 0: none */
    double stage_elapsed_s;              /* time since the stage began */
    /* Current phase, as shares of the stage; both 0: there is only one. */
    double phase_from, phase_to;
    double phase_elapsed_s; /* time since the phase began */
};

/* Returns the seconds until the last stage ends. */
double orl_remaining_time_s(const struct orl_remaining_time *remaining);

/* Returns the share that is done, 0..1: since_s after it was `before`, with left_s remaining. */
double orl_remaining_time_share(double before, double since_s, double left_s);

#endif
