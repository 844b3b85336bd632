/*
 * Pooled results of a job's rounds so far: its sensors and the pixels of each view
 * (pooled_estimates.h), and their transfer to the result.
 *
 * Ownership: init allocates, done frees. Threads: only the lead's.
 */
#ifndef ORL_RUN_GOALS_FINDINGS_H
#define ORL_RUN_GOALS_FINDINGS_H

#include "metrics/view_batches.h"
#include "run/goals/percentile.h"
#include "run/goals/pooled_estimates.h"
#include "run/stages.h"

/* Results of the sensors, or of one view. */
struct orl_finding_part {
    struct orl_pooled pool;
    double *errors; /* standard errors of its means, owned */
    /* Variance of one sample of each sensor (sample_allocation.h), owned; NULL: unknown. */
    double *noise;
    struct orl_rays *rays; /* contributions of single rays to sensors' means, owned */
    double floor;
    struct orl_film film; /* mean colours of a view */
    bool rated;           /* true if its glare is computed, from batches */
    struct orl_view_batches batches;
};

struct orl_findings {
    struct orl_finding_part *parts; /* sensors first if there are any, then views */
    size_t n_parts, first_view;
    struct orl_estimates *estimates; /* one for every part; set by orl_findings_judge */
};

/* Allocates, in the result as well. shared: samples are allocated to sensors by noise. */
int orl_findings_init(struct orl_findings *findings, struct orl_run_state *state, bool shared,
                      struct orl_error *err);
void orl_findings_done(struct orl_findings *findings); /* also after a failed orl_findings_init */

/* Add a round's sensors and a round's picture. samples, groups: each sensor's samples, and the
 * means of its groups, if they were allocated by noise; else NULL. */
void orl_findings_add_sensors(struct orl_findings *findings, const struct orl_run_state *round,
                              double effort, const double *samples, const double *groups);
int orl_findings_add_film(struct orl_findings *findings, size_t view, const struct orl_film *film,
                          double effort, struct orl_error *err);

/* Computes the errors. */
void orl_findings_judge(struct orl_findings *findings);

/* Copies means and errors to the result and writes the views' files; call orl_findings_judge
 * first. */
int orl_findings_show(struct orl_findings *findings, struct orl_run_state *state,
                      struct orl_error *err);

#endif
