/*
 * Shared-exponent colours in one word, with three mantissas of 9 bits and an exponent of 5. Photon
 * fluxes and leaf irradiances are stored in this format. Values are relative to a unit of the
 * caller's, between 2^-24 and 65408; smaller ones lose bits, larger ones are clamped.
 */
#ifndef ORL_PHOTON_MAP_FLUX_H
#define ORL_PHOTON_MAP_FLUX_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <oriel/base/vec.h>

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
