/*
 * Terms of one pixel while its rays are followed: a weight for each bin or place seen. Adding is of
 * constant cost. A pixel that sees more than a bounded number of things keeps some of them, chosen
 * at random without bias.
 *
 * The choice is threshold sampling (Duffield, Lund and Thorup 2007, "Priority sampling for
 * estimation of arbitrary subset sums", J. ACM 54(6)), with systematic draws: weights above a
 * threshold are kept as they are; each of the others is kept with a probability in proportion to
 * its weight, which then becomes the threshold. The sum of the weights does not change.
 *
 * Threads: one pixel at a time, of one thread.
 */
#ifndef ORL_ANNUAL_SEAT_TERMS_H
#define ORL_ANNUAL_SEAT_TERMS_H

#include <stddef.h>
#include <stdint.h>

#include "base/random.h"

/* A bin or place that a pixel sees, and its weight, luma. */
struct orl_seat_term {
    uint32_t which;
    float weight;
};

struct orl_seat_terms {
    struct orl_seat_term *at; /* of the pixel, in the order in which they were found */
    size_t count, room;
    uint32_t *slots; /* by which: the position in at, plus one; 0: none */
    size_t n_slots;
};

void orl_seat_terms_done(struct orl_seat_terms *terms); /* zeros are fine */

/* Adds the weight to the term of that name. Returns 0 or ORL_ERR_NOMEM. */
int orl_seat_terms_add(struct orl_seat_terms *terms, uint32_t which, double weight);
/* Leaves at most that many terms. Returns 0 or ORL_ERR_NOMEM. */
int orl_seat_terms_thin(struct orl_seat_terms *terms, size_t most, struct orl_random *random);
/* Removes all terms; memory is kept for the next pixel. */
void orl_seat_terms_clear(struct orl_seat_terms *terms);

/*
 * Chooses at most that many of n weights, none of them negative. ret_factors: by which each weight
 * is multiplied; 0: it is not chosen. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_seat_choose(const double *weights, size_t n, size_t most, struct orl_random *random,
                    double *ret_factors);

#endif
