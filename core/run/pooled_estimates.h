/*
 * What independent rounds have found of many values, put together: means weighted by the effort of
 * each round, and the standard errors of these.
 *
 * Standard errors come from those of the rounds when every round knew its own, checked against the
 * spread between rounds: where that is larger than they explain, over all values together, they are
 * raised by as much. Otherwise they come from the spread alone, of few degrees of freedom, and each
 * value's is drawn towards what all values' are relative to themselves (Smyth 2004, moderated
 * variances): with two rounds a spread by itself says next to nothing.
 *
 * Rounds whose samples go on where the last one's ended are not independent, and better together
 * than as many that are. But their groups of samples are, each over all rounds, and standard errors
 * come from the spread of these.
 *
 * Ownership: init makes, done frees. Not for several threads.
 */
#ifndef ORL_RUN_POOLED_ESTIMATES_H
#define ORL_RUN_POOLED_ESTIMATES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

/* One round's findings. Errors are standard errors. */
struct orl_round_findings {
    const double *value;
    const double *error, *bias; /* NULL: not known */
    double degrees;             /* of freedom of its errors */
    double effort;        /* samples or photons; variances are thought to fall as its inverse */
    const double *groups; /* [value][group], whose mean the value is; of a pool of groups */
};

struct orl_pooled {
    size_t count;
    uint32_t n_groups, rounds;
    double effort, effort_squares; /* sums; the second of effort^2 / degrees */
    bool knows_errors, knows_bias; /* every round did */
    double *mean, *bias;
    double *spread;   /* sum of effort (x - mean)^2 */
    double *within;   /* sum of effort^2 s^2 */
    double *expected; /* sum of effort s^2 */
    double *groups;   /* [value][group]: means */
};

/* groups: 0 of rounds that are independent. */
int orl_pooled_init(struct orl_pooled *pool, size_t count, uint32_t groups, struct orl_error *err);
void orl_pooled_done(struct orl_pooled *pool); /* also of one that is all zero */

void orl_pooled_add(struct orl_pooled *pool, const struct orl_round_findings *found);

/* Standard errors of the means; false, and NaN everywhere, while there is nothing to tell them by.
 */
bool orl_pooled_errors(const struct orl_pooled *pool, double floor, double *ret_errors);

/* The third cumulant of a mean, by its groups; without groups it is not known: 0. */
double orl_pooled_third(const struct orl_pooled *pool, size_t index);

/* Of these errors. */
double orl_pooled_degrees(const struct orl_pooled *pool);

/* How often the variances that rounds report go into those between rounds; 1 with one round. */
double orl_pooled_dispersion(const struct orl_pooled *pool);

#endif
