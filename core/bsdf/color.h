/*
 * Colour of BSDF values. A file gives luminance (Visible) and beside it CIE X and Z (matrices) or
 * the chromaticity u', v' (CIE 1976, tensor trees). What is kept of the latter is a tint: RGB of
 * luma 1, in four bytes, by which a luminance is multiplied. Luminance alone decides where draws
 * go, so the luma of every value is exactly what the Visible channel says.
 *
 * RGB is Radiance's: primaries (x, y) = (.640, .330), (.290, .600), (.150, .060), equal-energy
 * white. Colours outside that triangle are moved to its edge at equal luminance.
 *
 * Tints are two 16-bit shares of the luminance, red's and blue's; green has the rest. So a channel
 * that is dark is exactly 0. Grey has a code of its own: it is exactly grey.
 */
#ifndef ORL_BSDF_COLOR_H
#define ORL_BSDF_COLOR_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/vec.h>

struct orl_tint {
    uint32_t code;
};
static const struct orl_tint orl_tint_gray = {UINT32_MAX};

/* The tint of a tristimulus value; Y is positive. Counts one outside the triangle in *outside. */
struct orl_tint orl_tint_of_xyz(double x, double y, double z, size_t *outside);
/* Of a chromaticity. One that is none (v' not positive) is grey. */
struct orl_tint orl_tint_of_uv(double u, double v, size_t *outside);
/* Of RGB of any luma above 0. */
struct orl_tint orl_tint_of_rgb(struct orl_rgb color);

struct orl_rgb orl_tint_rgb(struct orl_tint tint);

/* X and Z of a colour, Y being its luma, from which orl_tint_of_xyz has its tint again. */
void orl_color_xz(struct orl_rgb color, double *ret_x, double *ret_z);
/* Its chromaticity, from which orl_tint_of_uv has its tint again; black is grey. */
void orl_color_uv(struct orl_rgb color, double *ret_u, double *ret_v);

static inline struct orl_rgb orl_tinted(struct orl_tint tint, double luminance)
{
    return tint.code == orl_tint_gray.code ? orl_gray(luminance)
                                           : orl_rgb_scale(orl_tint_rgb(tint), luminance);
}

#endif
