/*
 * Weighted reservoir sampling (Chao 1982, Biometrika 69, 653): one of several candidates is sampled
 * by weight in one pass, with one random number.
 */
#ifndef ORL_BASE_SAMPLING_RESERVOIR_H
#define ORL_BASE_SAMPLING_RESERVOIR_H

#include <stdbool.h>
#include <stdint.h>

struct orl_reservoir {
    double weight_sum;
    double u; /* rescaled to a uniform number after each decision */
};

static inline struct orl_reservoir orl_reservoir_begin(uint64_t bits)
{
    return (struct orl_reservoir){0, (double)(bits >> 11) * 0x1p-53};
}

/* Returns true if the candidate replaces the one that was chosen before. */
static inline bool orl_reservoir_add(struct orl_reservoir *r, double weight)
{
    const double before = r->weight_sum;
    if (!(weight > 0))
        return false;
    r->weight_sum = before + weight;
    const double at = r->u * r->weight_sum;
    r->u = at < weight ? at / weight : (at - weight) / before;
    return at < weight;
}

#endif
