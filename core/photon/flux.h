/*
 * Shared-exponent colours in one word: three mantissas of 9 bits and an exponent of 5, as photon
 * fluxes and leaf irradiances are kept. Values are relative to a unit of the caller's, between
 * 2^-24 and 65408; smaller ones fade out, larger ones are cut.
 */
#ifndef ORL_PHOTON_FLUX_H
#define ORL_PHOTON_FLUX_H

#include <stdint.h>
#include <string.h>

#include <oriel/vec.h>

#define ORL_FLUX_MOST 65408.0

/* dither in [0,1): 0.5 rounds to nearest; uniform random numbers keep sums exact on average. */
uint32_t orl_flux_pack(struct orl_rgb value, double dither);

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
