#include <string.h>

#include "photon/map/quantization.h"

uint16_t orl_normal_encode(struct orl_vec3 n)
{
    const double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    /* Values that would round to zero become +0, so that the downward axis has only one code. */
    double u = fabs(n.x) < sum / 512 ? 0.0 : n.x / sum, v = fabs(n.y) < sum / 512 ? 0.0 : n.y / sum;
    if (n.z < 0) {
        const double fold = (1 - fabs(v)) * copysign(1.0, u);
        v = (1 - fabs(u)) * copysign(1.0, v);
        u = fold;
    }
    return (uint16_t)((unsigned)lrint(127 * u + 127) | (unsigned)lrint(127 * v + 127) << 8);
}

struct orl_vec3 orl_normal_decode(uint16_t code)
{
    double u = ((code & 255) - 127) / 127.0, v = ((code >> 8) - 127) / 127.0;
    const double z = 1 - fabs(u) - fabs(v);
    if (z < 0) {
        const double fold = (1 - fabs(v)) * copysign(1.0, u);
        v = (1 - fabs(u)) * copysign(1.0, v);
        u = fold;
    }
    return orl_normalize(orl_v3(u, v, z));
}

/* Codes are sampled with this step. A bin is 51 codes wide, and the margin covers the codes
 * between. */
enum { STEP = 3 };
static const double margin_rad = 0.04;

void orl_normal_bins_init(struct orl_normal_bins *normal_bins)
{
    double angle[ORL_NORMAL_BINS] = {0};
    memset(normal_bins, 0, sizeof *normal_bins);
    for (uint32_t v = 0; v < 256; v += STEP) {
        for (uint32_t u = 0; u < 256; u += STEP) {
            const uint16_t code = (uint16_t)(u | v << 8);
            struct orl_vec3 *axis = &normal_bins->axis[orl_normal_bin(code)];
            *axis = orl_add(*axis, orl_normal_decode(code));
        }
    }
    for (int i = 0; i < ORL_NORMAL_BINS; i++)
        normal_bins->axis[i] = orl_normalize(normal_bins->axis[i]);
    for (uint32_t v = 0; v < 256; v += STEP) {
        for (uint32_t u = 0; u < 256; u += STEP) {
            const uint16_t code = (uint16_t)(u | v << 8);
            const uint32_t bin = orl_normal_bin(code);
            const double cosine = orl_dot(normal_bins->axis[bin], orl_normal_decode(code));
            angle[bin] = fmax(angle[bin], acos(fmin(cosine, 1)));
        }
    }
    for (int i = 0; i < ORL_NORMAL_BINS; i++)
        normal_bins->least_cosine[i] = cos(fmin(angle[i] + margin_rad + ORL_PI / 6, ORL_PI));
}

uint32_t orl_normal_bins_mask(const struct orl_normal_bins *normal_bins, struct orl_vec3 normal)
{
    uint32_t mask = 0;
    for (uint32_t i = 0; i < ORL_NORMAL_BINS; i++)
        mask |= (uint32_t)(orl_dot(normal_bins->axis[i], normal) >= normal_bins->least_cosine[i])
                << i;
    return mask;
}

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
