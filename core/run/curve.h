/*
 * The pilot of a job: what its errors and times tell of accuracies it might ask for (oriel/run.h,
 * orl_plan_curve). Seconds are of the whole job: those of sensors and of views are scaled by how
 * many times more of them there are.
 */
#ifndef ORL_RUN_CURVE_H
#define ORL_RUN_CURVE_H

#include "run/stages.h"

enum { ORL_PILOT_ROUNDS = 2 };

struct orl_pilot {
    double sensor_times, view_times; /* the job's are so many times the pilot's */
    struct orl_curve *curve;         /* out */
};

/* The job that is tried, whatever technique or settings it has itself. Borrows from job. */
struct orl_job orl_pilot_job(const struct orl_job *job);

/* Once its plan is made: fills state->pilot->curve. */
int orl_run_pilot(struct orl_run_state *state, struct orl_error *err);

#endif
