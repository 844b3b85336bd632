/*
 * Colours of a scale, sRGB: palettes by name (oriel/picture.h).
 *
 * ORL_PALETTE_EVEN, in CIELAB: lightness from 14 to 91 in even steps, hue from violet by way of
 * teal to yellow so that steps differ alike, chroma as far as sRGB goes but 60 at most. The others
 * are what falsecolor shows under those names: its functions give linear values, shown with a gamma
 * of 2.2.
 */
#ifndef ORL_RENDER_PICTURE_PALETTE_H
#define ORL_RENDER_PICTURE_PALETTE_H

#include <oriel/picture.h>

/* share: 0 at the scale's lower end, 1 at its top; beyond is as the ends are. */
void orl_palette_color(enum orl_palette palette, double share, unsigned char ret_srgb[3]);

#endif
