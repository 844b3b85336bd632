/*
 * Sums of photons by the batch they were emitted in. Every batch has a random sequence of its own
 * (emit.h), so that whatever is linear in the photons comes as the sum of 16 independent draws of
 * the same thing: their spread gives its variance, at the price of no further search.
 *
 * Where an estimate's radius follows its photons the parts are draws given that radius: as many
 * photons in all are then shared out among the batches, and the spread is that of so many photons.
 */
#ifndef ORL_PHOTON_MAP_BATCHES_H
#define ORL_PHOTON_MAP_BATCHES_H

#include "photon/map/map_layout.h"

struct orl_batches {
    double luma[ORL_MAP_BATCHES]; /* the parts; together the luma of the whole */
};

/* Of the sum of the parts. */
static inline double orl_batches_variance(const struct orl_batches *batches)
{
    static const double n = ORL_MAP_BATCHES;
    double mean = 0, square = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        mean += batches->luma[i] / n;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        square += (batches->luma[i] - mean) * (batches->luma[i] - mean);
    return square * n / (n - 1);
}

/* The third cumulant of that sum. */
double orl_batches_third(const struct orl_batches *batches);

static inline void orl_batches_add(struct orl_batches *sum, const struct orl_batches *more,
                                   double factor)
{
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum->luma[i] += more->luma[i] * factor;
}

/*
 * What a difference of two estimates from the same photons is worth: as much as it is thought to be
 * beyond its scatter, nothing within it (the positive part of James and Stein's shrinkage).
 */
double orl_batches_beyond_scatter(const struct orl_batches *difference);

/* For keeping: the parts in 255ths of the largest; and back, given what they add up to. */
void orl_batches_pack(const struct orl_batches *batches, uint8_t ret_shares[ORL_MAP_BATCHES]);
struct orl_batches orl_batches_unpack(const uint8_t shares[ORL_MAP_BATCHES], double luma);

/* The batch of a photon of a map. */
static inline uint32_t orl_photon_batch(const struct orl_photon_map *map, uint32_t index)
{
    const uint32_t *leaf = map->places + (size_t)(index / ORL_MAP_LEAF) * ORL_LEAF_WORDS;
    return leaf[index % ORL_MAP_LEAF] >> 20 & (ORL_MAP_BATCHES - 1);
}

#endif
