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
#ifndef ORL_RUN_GOALS_POOLED_ESTIMATES_H
#define ORL_RUN_GOALS_POOLED_ESTIMATES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

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

#endif
