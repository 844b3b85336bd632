/*
 * Colour of BSDF values. A file gives luminance (Visible) and beside it CIE X and Z (matrices) or
 * the chromaticity u', v' (CIE 1976, tensor trees). Colour is stored as a tint: RGB of luma 1 in
 * four bytes, by which the luminance is multiplied. Sampling uses luminance only. The luma of every
 * value is exactly that of the Visible channel.
 *
 * RGB is Radiance's: primaries (x, y) = (.640, .330), (.290, .600), (.150, .060), equal-energy
 * white. Colours outside that triangle are moved to its edge at equal luminance.
 *
 * A tint holds two 16-bit shares of the luminance, for red and blue; green has the rest. A channel
 * that is dark is therefore exactly 0. Grey has its own code and is exactly grey.
 */
#ifndef ORL_BSDF_COLOR_H
#define ORL_BSDF_COLOR_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

struct orl_tint {
    uint32_t code;
};
static const struct orl_tint orl_tint_gray = {UINT32_MAX};

/* Returns the tint of a tristimulus value; y must be positive. Increments *outside if the colour is
 * outside the triangle. */
struct orl_tint orl_tint_of_xyz(double x, double y, double z, size_t *outside);
/* Returns the tint of a chromaticity u', v'. An invalid one (v' not positive) gives grey. */
struct orl_tint orl_tint_of_uv(double u, double v, size_t *outside);
/* Returns the tint of an RGB colour of positive luma. */
struct orl_tint orl_tint_of_rgb(struct orl_rgb color);

struct orl_rgb orl_tint_rgb(struct orl_tint tint);

/* Returns X and Z of a colour whose Y is its luma; the inverse of orl_tint_of_xyz. */
void orl_color_xz(struct orl_rgb color, double *ret_x, double *ret_z);
/* Returns the chromaticity of a colour, the inverse of orl_tint_of_uv; that of grey for black. */
void orl_color_uv(struct orl_rgb color, double *ret_u, double *ret_v);

static inline struct orl_rgb orl_tinted(struct orl_tint tint, double luminance)
{
    return tint.code == orl_tint_gray.code ? orl_gray(luminance)
                                           : orl_rgb_scale(orl_tint_rgb(tint), luminance);
}

#endif
