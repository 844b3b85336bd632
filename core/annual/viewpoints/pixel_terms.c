#include "annual/viewpoints/viewpoints.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

#include "base/memory/memory.h"

enum { FIRST_SLOTS = 4096 };

void orl_pixel_terms_done(struct orl_pixel_terms *terms)
{
    free(terms->at);
    free(terms->slots);
}

/* ---- Adding ---------------------------------------------------------------------------------- */

static int grow_slots(struct orl_pixel_terms *terms, uint32_t which)
{
    size_t n = terms->n_slots > 0 ? terms->n_slots : FIRST_SLOTS;
    while (n <= which)
        n *= 2;
    uint32_t *grown = realloc(terms->slots, n * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    memset(grown + terms->n_slots, 0, (n - terms->n_slots) * sizeof *grown);
    terms->slots = grown;
    terms->n_slots = n;
    return 0;
}

int orl_pixel_terms_add(struct orl_pixel_terms *terms, uint32_t which, double weight)
{
    if (which >= terms->n_slots && grow_slots(terms, which) < 0)
        return ORL_ERR_NOMEM;
    if (terms->slots[which] > 0) {
        terms->at[terms->slots[which] - 1].weight += (float)weight;
        return 0;
    }
    if (!orl_array_reserve(&terms->at, &terms->room, terms->count, sizeof *terms->at))
        return ORL_ERR_NOMEM;
    terms->at[terms->count++] = (struct orl_pixel_term){which, (float)weight};
    terms->slots[which] = (uint32_t)terms->count;
    return 0;
}

void orl_pixel_terms_clear(struct orl_pixel_terms *terms)
{
    for (size_t i = 0; i < terms->count; i++)
        terms->slots[terms->at[i].which] = 0;
    terms->count = 0;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static int descending(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p < q) - (p > q);
}

/* Returns the threshold at which `most` of n weights are kept; sorts `sorted` in place. */
static double find_threshold(double *sorted, size_t n, size_t most)
{
    double rest = 0;
    qsort(sorted, n, sizeof *sorted, descending);
    for (size_t i = 0; i < n; i++)
        rest += sorted[i];
    for (size_t kept = 0; kept < most; kept++) {
        const double threshold = rest / (double)(most - kept);
        if (!(sorted[kept] > threshold))
            return threshold;
        rest -= sorted[kept];
    }
    return 0;
}

int orl_threshold_sample(const double *weights, size_t n, size_t most, struct orl_random *random,
                         double *ret_factors)
{
    for (size_t i = 0; i < n; i++)
        ret_factors[i] = 1;
    if (n <= most)
        return 0;
    double *sorted = malloc(n * sizeof *sorted);
    if (!sorted)
        return ORL_ERR_NOMEM;
    memcpy(sorted, weights, n * sizeof *sorted);
    const double threshold = find_threshold(sorted, n, most);
    free(sorted);
    /* Systematic sampling with one random number: a weight is kept if the running sum crosses an
     * integer there. */
    double sum = orl_random_uniform(random);
    for (size_t i = 0; i < n; i++) {
        if (weights[i] > threshold)
            continue;
        sum += threshold > 0 ? weights[i] / threshold : 0;
        ret_factors[i] = sum >= 1 ? threshold / weights[i] : 0;
        if (sum >= 1)
            sum -= 1;
    }
    return 0;
}

int orl_pixel_terms_thin(struct orl_pixel_terms *terms, size_t most, struct orl_random *random)
{
    const size_t n = terms->count;
    if (n <= most)
        return 0;
    double *weights = calloc(2 * n, sizeof *weights); /* weights, followed by their factors */
    if (!weights)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        weights[i] = (double)terms->at[i].weight;
    const int code = orl_threshold_sample(weights, n, most, random, weights + n);
    size_t kept = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        const uint32_t which = terms->at[i].which;
        terms->slots[which] = 0;
        if (!(weights[n + i] > 0))
            continue;
        terms->at[kept] = (struct orl_pixel_term){which, (float)(weights[i] * weights[n + i])};
        terms->slots[which] = (uint32_t)++kept;
    }
    if (code == 0)
        terms->count = kept;
    free(weights);
    return code;
}
