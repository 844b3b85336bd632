/*
 * Pools the results of independent rounds for many values: means weighted by each round's effort,
 * and their standard errors.
 *
 * If every round knew its own errors, standard errors come from these, checked against the spread
 * between rounds. If the spread exceeds them, over all values together, they are raised by that
 * factor. Otherwise they come from the spread alone, which has few degrees of freedom. Each value's
 * variance is then shrunk towards the relative variance of all values (Smyth 2004, moderated
 * variances): with two rounds a single spread says almost nothing.
 *
 * Rounds that continue the sample sequence of the last one are not independent, and together better
 * than as many independent ones. But their groups of samples, each over all rounds, are
 * independent, and standard errors come from the spread of these.
 *
 * Ownership: init allocates, done frees. Not thread-safe.
 */
#ifndef ORL_RUN_GOALS_POOLED_ESTIMATES_H
#define ORL_RUN_GOALS_POOLED_ESTIMATES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

/* Results of one round. Errors are standard errors. */
struct orl_round_findings {
    const double *value;
    const double *error, *bias; /* NULL: unknown */
    double degrees;             /* degrees of freedom of its errors */
    /* Samples or photons; variances are assumed inversely proportional to it. */
    double effort;
    const double *groups; /* [value][group], with the value as their mean; for a pool with groups */
};

struct orl_pooled {
    size_t count;
    uint32_t n_groups, rounds;
    double effort, effort_squares; /* sums of effort, and of effort^2 / degrees */
    bool knows_errors, knows_bias; /* true if every round did */
    double *mean, *bias;
    double *spread;   /* sum of effort (x - mean)^2 */
    double *within;   /* sum of effort^2 s^2 */
    double *expected; /* sum of effort s^2 */
    double *groups;   /* [value][group], means over rounds */
};

/* Initialises a pool. groups: 0 for independent rounds. Returns 0 or ORL_ERR_NOMEM. */
int orl_pooled_init(struct orl_pooled *pool, size_t count, uint32_t groups, struct orl_error *err);
void orl_pooled_done(struct orl_pooled *pool); /* also accepts an all-zero struct */

void orl_pooled_add(struct orl_pooled *pool, const struct orl_round_findings *found);

/* Computes standard errors of the means. Returns false, with NaN everywhere, if there is no basis
 * yet. */
bool orl_pooled_errors(const struct orl_pooled *pool, double floor, double *ret_errors);

/* Returns the third cumulant of a mean, by its groups; 0 without groups, when it is unknown. */
double orl_pooled_third(const struct orl_pooled *pool, size_t index);

/* Returns the degrees of freedom of these errors. */
double orl_pooled_degrees(const struct orl_pooled *pool);

/* Returns the ratio of the variances between rounds to those that rounds report; 1 with one
 * round. */
double orl_pooled_dispersion(const struct orl_pooled *pool);

#endif
