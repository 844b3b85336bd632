/*
 * Terms of one pixel while its rays are traced: a weight for each bin or place seen. Adding a term
 * takes constant time. If a pixel has more terms than a limit, some are sampled without bias.
 *
 * The method is threshold sampling (Duffield, Lund and Thorup 2007, "Priority sampling for
 * estimation of arbitrary subset sums", J. ACM 54(6)), with systematic draws. Weights above a
 * threshold are kept unchanged. Each other weight is kept with a probability proportional to it,
 * and is then set to the threshold. The sum of the weights does not change.
 *
 * Threads: one thread at a time.
 */
#ifndef ORL_ANNUAL_VIEWPOINTS_PIXEL_TERMS_H
#define ORL_ANNUAL_VIEWPOINTS_PIXEL_TERMS_H

#include <stddef.h>
#include <stdint.h>

#include "base/sampling/random.h"

/* A bin or place that a pixel sees, and its weight (luma). */
struct orl_pixel_term {
    uint32_t which;
    float weight;
};

struct orl_pixel_terms {
    struct orl_pixel_term *at; /* in the order in which they were added */
    size_t count, room;
    uint32_t *slots; /* by which: index in at, plus one; 0: none */
    size_t n_slots;
};

void orl_pixel_terms_done(struct orl_pixel_terms *terms); /* zeros are allowed */

/* Adds the weight to the term `which`. Returns 0 or ORL_ERR_NOMEM. */
int orl_pixel_terms_add(struct orl_pixel_terms *terms, uint32_t which, double weight);
/* Samples at most `most` terms. Returns 0 or ORL_ERR_NOMEM. */
int orl_pixel_terms_thin(struct orl_pixel_terms *terms, size_t most, struct orl_random *random);
/* Removes all terms; memory is reused for the next pixel. */
void orl_pixel_terms_clear(struct orl_pixel_terms *terms);

/*
 * Samples at most `most` of n weights, none of them negative. ret_factors: factor for each weight;
 * 0: not sampled. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_threshold_sample(const double *weights, size_t n, size_t most, struct orl_random *random,
                         double *ret_factors);

#endif
