#include "photon/flux.h"

enum { MANTISSA_BITS = 9, MANTISSA_MASK = 511, MOST_EXPONENT = 31 };

static uint32_t mantissa(double value, int exponent, double dither)
{
    const double m = ldexp(value, MANTISSA_BITS - exponent) + dither;
    return m < MANTISSA_MASK ? (uint32_t)m : MANTISSA_MASK;
}

/* exponent: as it is stored, 0..31. */
static uint32_t code_of(const uint32_t m[3], int exponent)
{
    return m[0] | m[1] << MANTISSA_BITS | m[2] << 2 * MANTISSA_BITS |
           (uint32_t)exponent << 3 * MANTISSA_BITS;
}

/* A touch more than the value, so that rounding up does not overflow the mantissa. */
static int exponent_of(double most)
{
    int exponent;
    frexp(most * (1 + 0x1p-9), &exponent);
    return exponent;
}

uint32_t orl_flux_pack(struct orl_rgb value, double dither)
{
    const double most = orl_rgb_max(value);
    if (!(most > 0))
        return 0;
    int exponent = exponent_of(most);
    exponent = exponent < -15 ? -15 : exponent > 16 ? 16 : exponent;
    const uint32_t m[3] = {mantissa(value.r, exponent, dither), mantissa(value.g, exponent, dither),
                           mantissa(value.b, exponent, dither)};
    return code_of(m, exponent + 15);
}

int orl_flux_least(double brightest)
{
    return brightest > 0 ? exponent_of(brightest) - MOST_EXPONENT : ORL_FLUX_LEAST;
}

/* Lowers an exponent by shifting it out of the mantissas when it would be negative. */
static uint32_t shifted(const uint32_t m[3], int exponent)
{
    const int out = exponent >= 0 ? 0 : exponent < -MANTISSA_BITS ? MANTISSA_BITS : -exponent;
    const uint32_t left[3] = {m[0] >> out, m[1] >> out, m[2] >> out};
    return code_of(left, exponent > 0 ? exponent : 0);
}

uint32_t orl_flux_pack_from(struct orl_rgb value, int least, double dither)
{
    const double most = orl_rgb_max(value);
    if (!(most > 0))
        return 0;
    const int exponent = exponent_of(most);
    const uint32_t m[3] = {mantissa(value.r, exponent, dither), mantissa(value.g, exponent, dither),
                           mantissa(value.b, exponent, dither)};
    return shifted(m, exponent - least);
}

uint32_t orl_flux_coarsen(uint32_t code, int by)
{
    const uint32_t m[3] = {code & MANTISSA_MASK, code >> MANTISSA_BITS & MANTISSA_MASK,
                           code >> 2 * MANTISSA_BITS & MANTISSA_MASK};
    return code == 0 ? 0 : shifted(m, (int)(code >> 3 * MANTISSA_BITS) - by);
}
