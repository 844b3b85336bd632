/*
 * Suns seen straight, or through panes that do not turn them aside: their light in a picture is
 * their luminance times their solid angle, whatever the size of its pixels.
 *
 * A sun's disc is half a degree wide, about a pixel of a fisheye: rays through pixels meet it or
 * miss it by chance. Where a sun is small among pixels, these rays therefore pass it over
 * (ORL_SUNS_APART), and rays of its own go to even places of its disc; what each brings is put into
 * the pixel that it goes through, by that pixel's solid angle. Suns that cover many pixels, and
 * those seen in mirrors, are left to the pixels' rays.
 */
#ifndef ORL_RENDER_IMAGE_DISCS_H
#define ORL_RENDER_IMAGE_DISCS_H

#include "render/image/paint.h"
#include "render/image/shade.h"

/* How rays of the picture's pixels are to see suns. */
enum orl_suns orl_discs_suns(const struct orl_world *world, const struct orl_painting *painting);

/* Adds the suns to a picture whose pixels have been painted without. outside: where the eye is. */
void orl_discs_paint(const struct orl_shader *shader, const struct orl_painting *painting,
                     bool outside);

#endif
