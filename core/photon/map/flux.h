/*
 * Shared-exponent colours in one word: three mantissas of 9 bits and an exponent of 5, as photon
 * fluxes and leaf irradiances are kept. Values are relative to a unit of the caller's, between
 * 2^-24 and 65408; smaller ones fade out, larger ones are cut.
 */
#ifndef ORL_PHOTON_MAP_FLUX_H
#define ORL_PHOTON_MAP_FLUX_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <oriel/vec.h>

#define ORL_FLUX_MOST 65408.0
enum { ORL_FLUX_MANTISSA_BITS = 9 };

/* dither in [0,1): 0.5 rounds to nearest; uniform random numbers keep sums exact on average. */
uint32_t orl_flux_pack(struct orl_rgb value, double dither);

/*
 * The same for values of which more may come, and brighter ones. A code's exponent is counted from
 * `least`: its value is mantissa * 2^(exponent + least - 9). orl_flux_least is the lowest that fits
 * a value; it is to be that of the brightest. What is fainter than 2^-31 of it loses bits, and is
 * gone at 2^-40. To pack with one `least` and to coarsen the code to a higher one gives the code
 * that packing with the higher one gives.
 */
enum { ORL_FLUX_LEAST = -1000 }; /* below that of any float; of zero */
int orl_flux_least(double brightest);
uint32_t orl_flux_pack_from(struct orl_rgb value, int least, double dither);
uint32_t orl_flux_coarsen(uint32_t code, int by); /* by >= 0: how much higher */

/* The unit that orl_flux_unpack's values of such codes are in. */
static inline double orl_flux_unit(int least)
{
    return ldexp(1, least + 15);
}

static inline struct orl_rgb orl_flux_unpack(uint32_t code)
{
    /* 2^(exponent - 24), written down as a double's bits: this is in the innermost loop. */
    const uint64_t bits = (uint64_t)((code >> 27) + 1023 - 24) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return (struct orl_rgb){(code & 511U) * scale, (code >> 9 & 511U) * scale,
                            (code >> 18 & 511U) * scale};
}

#endif
