/*
 * The pilot of a job: predicts time over accuracy from a short run (oriel/job/run.h,
 * orl_plan_accuracy_curve). Seconds are those of the whole job: the pilot's sensors and views are
 * scaled by the ratio of numbers. By photon maps the pilot's rounds have as many of the plan's
 * photons as one or two seconds trace; the job's rounds have all.
 */
#ifndef ORL_RUN_ESTIMATE_ACCURACY_CURVE_H
#define ORL_RUN_ESTIMATE_ACCURACY_CURVE_H

#include "run/run_state.h"

enum { ORL_PILOT_ROUNDS = 2 };

struct orl_pilot {
    /* Ratio of the job's sensors, and views' work, to the pilot's. */
    double sensor_factor, view_factor;
    double samples; /* samples of its rounds (round_cost.h); 0: the minimum of a job */
    struct orl_accuracy_curve *curve; /* out */
};

/* Returns the pilot's job, whatever goal `job` has. Borrows from job. */
struct orl_job orl_pilot_job(const struct orl_job *job, enum orl_technique technique);

/* Returns the reason why no accuracy of the job can be predicted, a constant; NULL if a pilot can
 * predict them. Call it after the plan is made. */
const char *orl_run_no_curve_reason(const struct orl_run_state *state);

/* Runs the pilot after its plan is made; fills state->pilot->curve. */
int orl_run_pilot(struct orl_run_state *state, struct orl_error *err);

#endif
