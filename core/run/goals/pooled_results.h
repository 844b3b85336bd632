/*
 * Pooled results of a job's rounds so far: its sensors and the pixels of each view
 * (pooled_estimates.h), and their transfer to the result.
 *
 * Ownership: init allocates, done frees. Threads: only the lead's.
 */
#ifndef ORL_RUN_GOALS_POOLED_RESULTS_H
#define ORL_RUN_GOALS_POOLED_RESULTS_H

#include "metrics/view_batches.h"
#include "run/goals/percentile.h"
#include "run/goals/pooled_estimates.h"
#include "run/run_state.h"

/* Results of the sensors, or of one view. */
struct orl_pooled_output {
    struct orl_pooled_estimates pooled;
    double *errors; /* standard errors of its means, owned */
    /* Variance of one sample of each sensor (sample_allocation.h), owned; NULL: unknown. */
    double *noise;
    struct orl_ray_moments *rays; /* contributions of single rays to sensors' means, owned */
    double floor;
    struct orl_film film; /* mean colours of a view */
    bool has_glare;       /* true if its glare is computed, from batches */
    struct orl_view_batches batches;
};

struct orl_pooled_results {
    struct orl_pooled_output *outputs; /* sensors first if there are any, then views */
    size_t n_outputs, first_view;
    struct orl_estimates *estimates; /* one for every output; set by orl_pooled_results_evaluate */
};

/* Allocates, in the result as well. shared: samples are allocated to sensors by noise. */
int orl_pooled_results_init(struct orl_pooled_results *results, struct orl_run_state *state,
                            bool by_noise, struct orl_error *err);
void orl_pooled_results_done(
    struct orl_pooled_results *results); /* also after a failed orl_pooled_results_init */

/* Add a round's sensors and a round's picture. samples, batches: each sensor's samples, and the
 * means of its batches, if they were allocated by noise; else NULL. */
void orl_pooled_results_add_sensors(struct orl_pooled_results *results,
                                    const struct orl_run_state *round, double weight,
                                    const double *samples, const double *batches);
int orl_pooled_results_add_film(struct orl_pooled_results *results, size_t view,
                                const struct orl_film *film, double weight, struct orl_error *err);

/* Computes the errors. */
void orl_pooled_results_evaluate(struct orl_pooled_results *results);

/* Copies means and errors to the result and writes the views' files; call
 * orl_pooled_results_evaluate first. */
int orl_pooled_results_write(struct orl_pooled_results *results, struct orl_run_state *state,
                             struct orl_error *err);

#endif
