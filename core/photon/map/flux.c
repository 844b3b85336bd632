#include "photon/map/flux.h"

enum { MANTISSA_BITS = ORL_FLUX_MANTISSA_BITS, MANTISSA_MASK = 511, MOST_EXPONENT = 31 };

/* Returns 2^exponent as a normal double; exponents here are little more than those of floats. */
static double power_of_two(int exponent)
{
    const uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

static uint32_t mantissa(double value, double scale, double dither)
{
    const double m = value * scale + dither;
    return m < MANTISSA_MASK ? (uint32_t)m : MANTISSA_MASK;
}

static void mantissas(struct orl_rgb value, int exponent, double dither, uint32_t ret_m[3])
{
    const double scale = power_of_two(MANTISSA_BITS - exponent);
    ret_m[0] = mantissa(value.r, scale, dither);
    ret_m[1] = mantissa(value.g, scale, dither);
    ret_m[2] = mantissa(value.b, scale, dither);
}

/* exponent: the stored one, 0..31. */
static uint32_t code_of(const uint32_t m[3], int exponent)
{
    return m[0] | m[1] << MANTISSA_BITS | m[2] << 2 * MANTISSA_BITS |
           (uint32_t)exponent << 3 * MANTISSA_BITS;
}

/* Returns the exponent of a slightly larger value, so that rounding up does not overflow the
 * mantissa. */
static int exponent_of(double most)
{
    const double value = most * (1 + 0x1p-9);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    /* the exponent of frexp; no float is subnormal as a double */
    return (int)(bits >> 52 & 0x7ffU) - 1022;
}

uint32_t orl_flux_pack(struct orl_rgb value, double dither)
{
    const double most = orl_rgb_max(value);
    if (!(most > 0))
        return 0;
    int exponent = exponent_of(most);
    exponent = exponent < -15 ? -15 : exponent > 16 ? 16 : exponent;
    uint32_t m[3];
    mantissas(value, exponent, dither, m);
    return code_of(m, exponent + 15);
}

int orl_flux_least(double brightest)
{
    return brightest > 0 ? exponent_of(brightest) - MOST_EXPONENT : ORL_FLUX_LEAST;
}

/* Codes mantissas with an exponent; a negative exponent becomes 0 by shifting the mantissas
 * right. */
static uint32_t shift_code(const uint32_t m[3], int exponent)
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
    uint32_t m[3];
    mantissas(value, exponent, dither, m);
    return shift_code(m, exponent - least);
}

uint32_t orl_flux_coarsen(uint32_t code, int by)
{
    const uint32_t m[3] = {code & MANTISSA_MASK, code >> MANTISSA_BITS & MANTISSA_MASK,
                           code >> 2 * MANTISSA_BITS & MANTISSA_MASK};
    return code == 0 ? 0 : shift_code(m, (int)(code >> 3 * MANTISSA_BITS) - by);
}
