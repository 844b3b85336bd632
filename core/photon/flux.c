#include "photon/flux.h"

static uint32_t mantissa(double value, int exponent, double dither)
{
    const double m = ldexp(value, 9 - exponent) + dither;
    return m < 511 ? (uint32_t)m : 511;
}

uint32_t orl_flux_pack(struct orl_rgb value, double dither)
{
    const double most = orl_rgb_max(value);
    int exponent;
    if (!(most > 0))
        return 0;
    /* A touch more, so that rounding up does not overflow the mantissa. */
    frexp(most * (1 + 0x1p-9), &exponent);
    exponent = exponent < -15 ? -15 : exponent > 16 ? 16 : exponent;
    return mantissa(value.r, exponent, dither) | mantissa(value.g, exponent, dither) << 9 |
           mantissa(value.b, exponent, dither) << 18 | (uint32_t)(exponent + 15) << 27;
}
