/*
 * A tile of a view from photon maps, painted in four steps of different density:
 *   one ray through the centre of every pixel, and its shadow rays;
 *   the smooth part (lighting.h) at the corners of squares of pixels whose rays have the same path
 *   signature (shade.h). It is interpolated to the pixels between if the square's centre agrees;
 *   otherwise squares are quartered, down to single pixels;
 *   more rays for gloss, if the pixels about one show noise;
 *   more rays through a pixel (pixel.h) if neighbours see other things, shadows end, or the smooth
 *   part is steep (caustics). They take the smooth part from the nearest pixel that sees the same.
 * A pixel that finds there something that none of its neighbours has seen makes these send more
 * rays as well, so that things narrower than a pixel are followed. So does one that finds a
 * shadow's edge; the pixels about it send all of a pixel's rays, so that penumbras are sampled from
 * end to end.
 *
 * A tile is a function of the view and its position alone; threads share only constant data.
 */
#ifndef ORL_RENDER_IMAGE_ADAPTIVE_TILE_H
#define ORL_RENDER_IMAGE_ADAPTIVE_TILE_H

#include "render/image/lighting.h"
#include "render/image/paint.h"

struct orl_tile_painter {
    struct orl_lighting lighting;
    struct orl_shader shader;
    const struct orl_painting *painting;
    uint64_t seed;       /* names the view's random numbers */
    bool outside;        /* true if the eye is outside */
    atomic_bool *failed; /* set when out of memory */
};

/* Paints a tile; an orl_paint_tile whose ctx is a struct orl_tile_painter. */
void orl_tile_painter_paint(void *ctx, const struct orl_tile *tile, struct orl_search *search);

#endif
