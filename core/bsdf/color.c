#include "bsdf/color.h"

/* Shares of red, green and blue in the luminance; their sum is 1. */
struct shares {
    double r, g, b;
};

enum { STEPS = 65535 };

/* Shares within this distance of white are white: chromaticities are printed with at least four
 * digits. */
static const double gray_tolerance = 2e-5;
/* Colours further outside the triangle are counted; less can come from printing and rounding. */
static const double outside_tolerance = 1e-3;

/* X and Z of a primary of luminance 1. */
struct primary {
    double x, z;
};
#define PRIMARY(cx, cy)                                                                            \
    {                                                                                              \
        (cx) / (cy), (1 - (cx) - (cy)) / (cy)                                                      \
    }
static const struct primary red = PRIMARY(0.640, 0.330), green = PRIMARY(0.290, 0.600),
                            blue = PRIMARY(0.150, 0.060);

static struct orl_tint encode_tint(struct shares s)
{
    const double sum = s.r + s.g + s.b;
    double r = nearbyint(s.r / sum * STEPS), b = nearbyint(s.b / sum * STEPS);
    /* Green has the rest: exactly none if its share is 0. */
    if (!(s.g > 0))
        b = STEPS - r;
    return (struct orl_tint){(uint32_t)r << 16 | (uint32_t)fmin(b, STEPS - r)};
}

static struct orl_tint tint_of_shares(struct shares s, size_t *outside)
{
    if (fabs(s.r - ORL_LUMA_R) < gray_tolerance && fabs(s.g - ORL_LUMA_G) < gray_tolerance &&
        fabs(s.b - ORL_LUMA_B) < gray_tolerance)
        return orl_tint_gray;
    *outside += fmin(s.r, fmin(s.g, s.b)) < -outside_tolerance;
    return encode_tint((struct shares){fmax(s.r, 0), fmax(s.g, 0), fmax(s.b, 0)});
}

/*
 * Shares of white that the equations below give for X = Y = Z. They differ by 1e-4 from ORL_LUMA_R,
 * _G and _B, which define luma everywhere else. Shares are rescaled so that white is white by
 * those.
 */
static const struct shares white = {0.26510582010582012, 0.67010582010582009, 0.064788359788359784};

/* Solves two equations for red and blue; green's share is 1 minus theirs. */
struct orl_tint orl_tint_of_xyz(double x, double y, double z, size_t *outside)
{
    const double dx = x / y - green.x, dz = z / y - green.z;
    const double rx = red.x - green.x, rz = red.z - green.z;
    const double bx = blue.x - green.x, bz = blue.z - green.z;
    const double d = rx * bz - bx * rz;
    const double r = (dx * bz - bx * dz) / d, b = (rx * dz - dx * rz) / d;
    return tint_of_shares((struct shares){r * (ORL_LUMA_R / white.r),
                                          (1 - r - b) * (ORL_LUMA_G / white.g),
                                          b * (ORL_LUMA_B / white.b)},
                          outside);
}

struct orl_tint orl_tint_of_uv(double u, double v, size_t *outside)
{
    if (!(v > 0))
        return orl_tint_gray;
    return orl_tint_of_xyz(2.25 * u / v, 1, (3 - 0.75 * u - 5 * v) / v, outside);
}

struct orl_tint orl_tint_of_rgb(struct orl_rgb c)
{
    const double luma = orl_luma(c);
    size_t none = 0;
    return tint_of_shares(
        (struct shares){ORL_LUMA_R * c.r / luma, ORL_LUMA_G * c.g / luma, ORL_LUMA_B * c.b / luma},
        &none);
}

struct orl_rgb orl_tint_rgb(struct orl_tint tint)
{
    const uint32_t r = tint.code >> 16, b = tint.code & 0xffff;
    if (tint.code == orl_tint_gray.code)
        return orl_gray(1);
    return (struct orl_rgb){r / (STEPS * ORL_LUMA_R), (STEPS - r - b) / (STEPS * ORL_LUMA_G),
                            b / (STEPS * ORL_LUMA_B)};
}

void orl_color_xz(struct orl_rgb c, double *ret_x, double *ret_z)
{
    const struct shares s = {white.r * c.r, white.g * c.g, white.b * c.b};
    const double sum = s.r + s.g + s.b, unit = sum > 0 ? orl_luma(c) / sum : 0;
    *ret_x = unit * (s.r * red.x + s.g * green.x + s.b * blue.x);
    *ret_z = unit * (s.r * red.z + s.g * green.z + s.b * blue.z);
}

void orl_color_uv(struct orl_rgb c, double *ret_u, double *ret_v)
{
    const double y = orl_luma(c);
    double x, z;
    orl_color_xz(c, &x, &z);
    *ret_u = y > 0 ? 4 * x / (x + 15 * y + 3 * z) : 4.0 / 19;
    *ret_v = y > 0 ? 9 * y / (x + 15 * y + 3 * z) : 9.0 / 19;
}
