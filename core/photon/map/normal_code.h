/*
 * Normals in two bytes, and bins of normals.
 *
 * A normal is coded octahedrally (Cigolle et al. 2014) in 8 + 8 bits; the axes are exact. For
 * culling, codes fall into 25 bins, a 5 x 5 grid over the code's square. Photons of a map are
 * sorted by bin, and each node of its hierarchy has a mask of the bins inside. A query visits only
 * nodes that hold normals within 30 degrees of its own.
 */
#ifndef ORL_PHOTON_MAP_NORMAL_CODE_H
#define ORL_PHOTON_MAP_NORMAL_CODE_H

#include <stdint.h>

#include <oriel/base/vec.h>

enum { ORL_NORMAL_BINS_SIDE = 5, ORL_NORMAL_BINS = ORL_NORMAL_BINS_SIDE * ORL_NORMAL_BINS_SIDE };

uint16_t orl_normal_encode(struct orl_vec3 unit);
struct orl_vec3 orl_normal_decode(uint16_t code);

static inline uint32_t orl_normal_bin(uint16_t code)
{
    const uint32_t side = ORL_NORMAL_BINS_SIDE, u = code & 255U, v = (uint32_t)code >> 8;
    return u * side / 256 + v * side / 256 * side;
}

/* For each bin, the cone of its normals, widened by 30 degrees. */
struct orl_normal_bins {
    struct orl_vec3 axis[ORL_NORMAL_BINS];
    double least_cosine[ORL_NORMAL_BINS];
};
void orl_normal_bins_init(struct orl_normal_bins *normal_bins);

/* Returns a mask of the bins that may hold normals within 30 degrees of this one. */
uint32_t orl_normal_bins_mask(const struct orl_normal_bins *normal_bins, struct orl_vec3 normal);

#endif
