/*
 * A pixel's rays: where they go, how many of them it takes, and what they come to.
 *
 * A pixel that its neighbours leave in doubt (mosaic.h) sends rays to four by four places, in sets
 * of four that have one ray in every row and column. All sixteen differ in height and in breadth,
 * so that each tells of a level or an upright edge (as in Chiu, Shirley and Wang 1994, shuffled
 * such that slanting edges are told as well). Where the first four agree they will do; where they
 * do not, as on edges, or where a shadow ends, all sixteen are followed. Of bright things beside
 * dark ones, a sunlit ledge thinner than a pixel, even sixteen are off by a tenth of the contrast;
 * where that is more than twice the pixel's own light 48 more follow, of a lattice by the golden
 * ratio. Places are not jittered: beside a sky hundreds of times brighter, chance coverage frays an
 * edge.
 *
 * Threads: plain values; everybody has their own.
 */
#ifndef ORL_RENDER_IMAGE_PIXEL_H
#define ORL_RENDER_IMAGE_PIXEL_H

#include <stdbool.h>

#include "render/film/film.h"

enum { ORL_PIXEL_MOST_RAYS = 64, ORL_PIXEL_RAYS = 16, ORL_PIXEL_FIRST_RAYS = 4 };

/* Where a ray goes: in pixels, from the pixel's corner. */
void orl_pixel_place(uint32_t ray, double *ret_x, double *ret_y);

/* Of a ray: radiance, and the standard errors of its luma by the photons' two ways and by what
 * rays there were for lobes and lamps. */
struct orl_shade {
    struct orl_rgb radiance;
    double rest_error, caustic_error, ray_error;
};

/* What is known of a pixel when some of its rays are in. Zero at first. */
struct orl_pixel_rays {
    struct orl_rgb sum;
    double squares, rest_error, caustic_error, ray_error; /* sums */
    double least, most;                                   /* luma of a ray */
    uint32_t rays;
};

void orl_pixel_add(struct orl_pixel_rays *tally, const struct orl_shade *shade);

/* How many rays it takes by what these have seen. */
uint32_t orl_pixel_wants(const struct orl_pixel_rays *tally);

/*
 * The mean of the rays. Photons err alike on all of them, the two ways by chances of their own; on
 * top of that comes how far rays lie apart: noise of shadow rays and of lobes, and edges that a few
 * rays may miss.
 */
struct orl_pixel orl_pixel_settle(const struct orl_pixel_rays *tally);

#endif
