/*
 * The pilot of a job: what its errors and times tell of accuracies it might ask for (oriel/run.h,
 * orl_plan_curve). Seconds are of the whole job: those of sensors and of views are scaled by how
 * many times more of them there are. By photon maps its rounds have as many of the plan's photons
 * as a second or two traces, and the job's rounds all of them.
 */
#ifndef ORL_RUN_CURVE_H
#define ORL_RUN_CURVE_H

#include "run/stages.h"

enum { ORL_PILOT_ROUNDS = 2 };

struct orl_pilot {
    double sensor_times, view_times; /* the job's are so many times the pilot's */
    double samples;                  /* of its rounds (cost.h); 0: the smallest that jobs have */
    struct orl_curve *curve;         /* out */
};

/* The job that is tried, whatever settings it has itself. Borrows from job. */
struct orl_job orl_pilot_job(const struct orl_job *job, enum orl_technique technique);

/* Once the plan is made: returns the reason why no accuracy of the job can be predicted, a
 * constant; NULL if a pilot can predict them. */
const char *orl_run_why_no_curve(const struct orl_run_state *state);

/* Once its plan is made: fills state->pilot->curve. */
int orl_run_pilot(struct orl_run_state *state, struct orl_error *err);

#endif
