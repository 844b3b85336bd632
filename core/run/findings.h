/*
 * What the rounds of a job have found so far: of its sensors and of the pixels of each view, pooled
 * (pooled_estimates.h), and how it gets into the result.
 *
 * Ownership: init makes, done frees. Threads: the lead's only.
 */
#ifndef ORL_RUN_FINDINGS_H
#define ORL_RUN_FINDINGS_H

#include "metrics/view_batches.h"
#include "run/percentile.h"
#include "run/pooled_estimates.h"
#include "run/stages.h"

/* Of the sensors, or of one view. */
struct orl_finding_part {
    struct orl_pooled pool;
    double *errors; /* of its means; owned */
    double *noise;  /* sample_allocation.h: of one sample of a sensor; owned; NULL: not known */
    struct orl_rays *rays; /* of sensors, in their means; owned */
    double floor;
    struct orl_film film; /* of a view: the means, in colour */
    bool rated;           /* by its glare: */
    struct orl_view_batches batches;
};

struct orl_findings {
    struct orl_finding_part *parts; /* sensors first when there are any, then views */
    size_t n_parts, first_view;
    struct orl_estimates *estimates; /* of every part; filled by judge */
};

/* Makes room in the result too. shared: samples are shared out among sensors. */
int orl_findings_init(struct orl_findings *findings, struct orl_run_state *state, bool shared,
                      struct orl_error *err);
void orl_findings_done(struct orl_findings *findings); /* also of one that init left half-filled */

/* A round's sensors, with the samples of each and what its groups found where they were shared out,
 * else NULL; and a round's picture. */
void orl_findings_add_sensors(struct orl_findings *findings, const struct orl_run_state *round,
                              double effort, const double *samples, const double *groups);
int orl_findings_add_film(struct orl_findings *findings, size_t view, const struct orl_film *film,
                          double effort, struct orl_error *err);

/* Works out the errors. */
void orl_findings_judge(struct orl_findings *findings);

/* Into the result, with the views' files; after judge. */
int orl_findings_show(struct orl_findings *findings, struct orl_run_state *state,
                      struct orl_error *err);

#endif
