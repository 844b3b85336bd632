/*
 * Suns and small lamps seen straight, or through panes that do not turn them aside: their light in
 * a picture is their luminance times their solid angle, whatever the size of its pixels.
 *
 * A sun's disc is half a degree wide, about a pixel of a fisheye: rays through pixels meet it or
 * miss it by chance, and so they do a bulb across a room; between rays at fixed places it is not
 * there at all. Where a sun or a lamp is small among pixels these rays therefore pass it over
 * (ORL_SUNS_APART, orl_shader.lamps_apart), and rays of its own go to even places of it; what each
 * brings is put into the pixel that it goes through, by that pixel's solid angle. Those that cover
 * many pixels, and those seen in mirrors, are left to the pixels' rays.
 */
#ifndef ORL_RENDER_IMAGE_DISCS_H
#define ORL_RENDER_IMAGE_DISCS_H

#include "render/image/paint.h"
#include "render/image/shade.h"

/* What the rays of the picture's pixels are to pass over. */
struct orl_small_lights {
    enum orl_suns suns;
    bool *lamps; /* by facet, owned; NULL: none */
};

/* ORL_ERR_NOMEM; orl_discs_done in either case. */
int orl_discs_init(struct orl_small_lights *discs, const struct orl_world *world,
                   const struct orl_painting *painting);
void orl_discs_done(struct orl_small_lights *discs);

/* Adds them to a picture whose pixels have been painted without. outside: where the eye is. */
void orl_discs_paint(const struct orl_small_lights *discs, const struct orl_shader *shader,
                     const struct orl_painting *painting, bool outside);

#endif
