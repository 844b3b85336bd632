/* Pooled results of a job's rounds: estimates by value, and the sensors and views of the job. */
#ifndef ORL_RUN_GOALS_POOLED_RESULTS_H
#define ORL_RUN_GOALS_POOLED_RESULTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "metrics/glare.h"
#include "run/goals/percentile.h"
#include "run/run_state.h"

/*
 * Pools the results of independent rounds for many values: means weighted by each round's weight,
 * and their standard errors.
 *
 * If every round knew its own errors, standard errors come from these, checked against the spread
 * between rounds. If the spread exceeds them, over all values together, they are raised by that
 * factor. Otherwise they come from the spread alone, which has few degrees of freedom. Each value's
 * variance is then shrunk towards the relative variance of all values (Smyth 2004, moderated
 * variances): with two rounds a single spread says almost nothing.
 *
 * Rounds that continue the sample sequence of the last one are not independent, and together better
 * than as many independent ones. But their batches of samples, each over all rounds, are
 * independent, and standard errors come from the spread of these.
 *
 * Ownership: init allocates, done frees. Not thread-safe.
 */

/* Results of one round. Errors are standard errors. */
struct orl_round_values {
    const double *value;
    const double *error, *bias; /* NULL: unknown */
    double degrees_of_freedom;  /* degrees of freedom of its errors */
    /* Samples or photons; variances are assumed inversely proportional to it. */
    double weight;
    const double
        *batches; /* [value][batch], with the value as their mean; for estimates with batches */
};

struct orl_pooled_estimates {
    size_t count;
    uint32_t n_batches, rounds;
    double weight, weight_squares; /* sums of weight, and of weight^2 / degrees */
    bool knows_errors, knows_bias; /* true if every round did */
    double *mean, *bias;
    double *spread;   /* sum of weight (x - mean)^2 */
    double *within;   /* sum of weight^2 s^2 */
    double *expected; /* sum of weight s^2 */
    double *batches;  /* [value][batch], means over rounds */
};

/* Initialises the estimates. batches: 0 for independent rounds. Returns 0 or ORL_ERR_NOMEM. */
int orl_pooled_init(struct orl_pooled_estimates *pooled, size_t count, uint32_t batches,
                    struct orl_error *err);
void orl_pooled_done(struct orl_pooled_estimates *pooled); /* also accepts an all-zero struct */

void orl_pooled_add(struct orl_pooled_estimates *pooled, const struct orl_round_values *found);

/* Computes standard errors of the means. Returns false, with NaN everywhere, if there is no basis
 * yet. */
bool orl_pooled_errors(const struct orl_pooled_estimates *pooled, double floor, double *ret_errors);

/* Returns the third cumulant of a mean, by its batches; 0 without batches, when it is unknown. */
double orl_pooled_third(const struct orl_pooled_estimates *pooled, size_t index);

/* Returns the degrees of freedom of these errors. */
double orl_pooled_degrees(const struct orl_pooled_estimates *pooled);

/* Returns the ratio of the variances between rounds to those that rounds report; 1 with one
 * round. */
double orl_pooled_dispersion(const struct orl_pooled_estimates *pooled);

/*
 * Pooled results of a job's rounds so far: its sensors and the pixels of each view, and their
 * transfer to the result.
 *
 * Ownership: init allocates, done frees. Threads: the lead thread.
 */

/* Results of the sensors, or of one view. */
struct orl_pooled_output {
    struct orl_pooled_estimates pooled;
    double *errors; /* standard errors of its means, owned */
    /* Variance of one sample of each sensor (percentile.h), owned; NULL: unknown. */
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

/* Allocates, in the result as well. by_noise: samples are allocated to sensors by noise. */
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
