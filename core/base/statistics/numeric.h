/*
 * Numbers in arrays: compensated sums, shares in percent, the k-th smallest, sorting with polls for
 * cancellation.
 *
 * Compensated summation collects the rounding error of each addition and adds it at the end, so
 * that the error does not grow with the number of terms (Neumaier 1974).
 */
#ifndef ORL_BASE_STATISTICS_NUMERIC_H
#define ORL_BASE_STATISTICS_NUMERIC_H

#include <math.h>
#include <stddef.h>

#include <oriel/base/thread_pool.h>

struct orl_sum {
    double high, low; /* zero: empty sum */
};

static inline void orl_sum_add(struct orl_sum *sum, double value)
{
    const double high = sum->high + value;
    if (fabs(sum->high) >= fabs(value))
        sum->low += (sum->high - high) + value;
    else
        sum->low += (value - high) + sum->high;
    sum->high = high;
}

static inline double orl_sum_value(const struct orl_sum *sum)
{
    return sum->high + sum->low;
}

/* Shares in percent, without rounding artefacts: the whole is exactly 100, and 7 of 25 is 28. */

/* Returns part of whole, 0 ... 100; 0 if whole is 0. */
static inline double orl_percent(double part, double whole)
{
    if (!(whole > 0))
        return 0;
    return part < whole ? 100 * part / whole : 100;
}

/* Selection of the k-th smallest number, in linear time (Hoare 1961). */

/* Returns the k-th smallest of n values, k from 0 to n - 1. Reorders the values, which must not be
 * NaN. */
double orl_nth_element(double *values, size_t n, size_t k);

/*
 * Sorts many items with polls for cancellation; a qsort of a million takes half a second.
 *
 * The sort is stable, so that results do not depend on the amount of memory. Those of qsort may.
 */

/* Same as qsort, with cancellation. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED; on errors the
 * order is undefined. */
int orl_sort(void *items, size_t n, size_t size, int (*compare)(const void *, const void *),
             const atomic_bool *cancel);

#endif
