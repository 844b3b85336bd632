/*
 * Sums of photons by the batch in which they were emitted. Every batch has its own random sequence
 * (emit.h). So quantities that are linear in the photons are sums of 16 independent samples. The
 * spread of the samples gives the variance without a further search.
 *
 * If an estimate's radius depends on its photons, the parts are samples given that radius: a fixed
 * number of photons is distributed over the batches, and the spread is that of this number of
 * photons.
 */
#ifndef ORL_PHOTON_MAP_BATCHES_H
#define ORL_PHOTON_MAP_BATCHES_H

#include "photon/map/map_layout.h"

struct orl_batches {
    double luma[ORL_MAP_BATCHES]; /* the parts; their sum is the luma of the whole */
};

/* Returns the variance of the sum of the parts. */
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

/* Returns the third cumulant of the sum of the parts. */
double orl_batches_third_cumulant(const struct orl_batches *batches);

static inline void orl_batches_add(struct orl_batches *sum, const struct orl_batches *more,
                                   double factor)
{
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum->luma[i] += more->luma[i] * factor;
}

/*
 * Returns the part of a difference of two estimates from the same photons that exceeds its scatter;
 * 0 if the difference is within its scatter (positive-part James-Stein shrinkage).
 */
double orl_batches_shrink(const struct orl_batches *difference);

/* Convert the parts to and from 8 bits: 255ths of the largest part. Unpacking scales them to the
 * sum luma. */
void orl_batches_pack(const struct orl_batches *batches, uint8_t ret_shares[ORL_MAP_BATCHES]);
struct orl_batches orl_batches_unpack(const uint8_t shares[ORL_MAP_BATCHES], double luma);

/* Returns the batch of a photon of a map. */
static inline uint32_t orl_photon_batch(const struct orl_photon_map *map, uint32_t index)
{
    const uint32_t *leaf = map->places + (size_t)(index / ORL_MAP_LEAF) * ORL_LEAF_WORDS;
    return leaf[index % ORL_MAP_LEAF] >> 20 & (ORL_MAP_BATCHES - 1);
}

#endif
