/*
 * Quantized normals and fluxes of photons: a normal in two bytes, the flux of three channels in one
 * word.
 *
 * A normal is coded octahedrally (Cigolle et al. 2014) in 8 + 8 bits; the axes are exact. For
 * culling, codes fall into 25 bins, a 5 x 5 grid over the code's square. Photons of a map are
 * sorted by bin, and each node of its hierarchy has a mask of the bins inside. A query tests only
 * nodes that hold normals within 30 degrees of its own.
 */
#ifndef ORL_PHOTON_MAP_QUANTIZATION_H
#define ORL_PHOTON_MAP_QUANTIZATION_H

#include <math.h>
#include <stdint.h>
#include <string.h>

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

/*
 * Shared-exponent colours in one word, with three mantissas of 9 bits and an exponent of 5. Photon
 * fluxes and leaf irradiances are stored in this format. Values are relative to a unit of the
 * caller's, between 2^-24 and 65408; smaller ones lose bits, larger ones are clamped.
 */

#define ORL_FLUX_MOST 65408.0
enum { ORL_FLUX_MANTISSA_BITS = 9 };

/* Packs a colour. dither in [0,1): 0.5 rounds to nearest; uniform random numbers keep sums exact
 * on average. */
uint32_t orl_flux_pack(struct orl_rgb value, double dither);

/*
 * Packing for a set of values that may grow and get brighter. A code's exponent is counted from
 * `least`: its value is mantissa * 2^(exponent + least - 9). orl_flux_least returns the lowest
 * `least` that fits a value; use that of the brightest. Values fainter than 2^-31 of it lose bits,
 * and are 0 below 2^-40. Packing with one `least` and coarsening to a higher one gives the same
 * code as packing with the higher one.
 */
enum { ORL_FLUX_LEAST = -1000 }; /* the least of zero; below that of any float */
int orl_flux_least(double brightest);
uint32_t orl_flux_pack_from(struct orl_rgb value, int least, double dither);
uint32_t orl_flux_coarsen(uint32_t code, int by); /* by >= 0: increase of `least` */

/* Returns the factor from values of orl_flux_unpack to fluxes, for codes with this `least`. */
static inline double orl_flux_unit(int least)
{
    return ldexp(1, least + 15);
}

static inline struct orl_rgb orl_flux_unpack(uint32_t code)
{
    /* 2^(exponent - 24) as the bits of a double, because this is in the innermost loop. */
    const uint64_t bits = (uint64_t)((code >> 27) + 1023 - 24) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return (struct orl_rgb){(code & 511U) * scale, (code >> 9 & 511U) * scale,
                            (code >> 18 & 511U) * scale};
}

#endif
