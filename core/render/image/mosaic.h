/*
 * A tile of a view from photon maps, in four steps, each as sparse as its subject allows:
 *   one ray through the middle of every pixel, and its shadow rays;
 *   what is smooth (lighting.h) at the corners of squares of pixels whose rays all went the same
 *     way (shade.h), carried over to the pixels between where the middle of the square bears it
 *     out; elsewhere squares are quartered, down to single pixels;
 *   more rays for gloss, where those about a pixel say that chance shows in it;
 *   where neighbours see other things, shadows end, or what is smooth is steep even so (caustics),
 *     more rays through the pixel (pixel.h), which take what is smooth from the pixel about them
 *     that sees the same.
 * A pixel that finds there what none of its neighbours has seen makes these look again, too: things
 * narrower than a pixel are followed along. So does one that finds a shadow's edge, and there all
 * of a pixel's rays are sent: penumbras are looked at from end to end.
 *
 * A tile is a function of the view and its place alone; threads share nothing but what is constant.
 */
#ifndef ORL_RENDER_IMAGE_MOSAIC_H
#define ORL_RENDER_IMAGE_MOSAIC_H

#include "render/image/lighting.h"
#include "render/image/paint.h"

struct orl_mosaic {
    struct orl_lighting lighting;
    struct orl_shader shader;
    const struct orl_painting *painting;
    uint64_t seed;       /* names the view's numbers */
    bool outside;        /* where the eye is */
    atomic_bool *failed; /* set when out of memory */
};

/* An orl_paint_tile; ctx: a struct orl_mosaic. */
void orl_mosaic_paint(void *ctx, const struct orl_tile *tile, struct orl_search *search);

#endif
