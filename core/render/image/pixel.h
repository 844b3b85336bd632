/*
 * A pixel's rays: their positions, their number, and their mean.
 *
 * A pixel that its neighbours leave in doubt (adaptive_tile.h) sends rays through a grid of four by
 * four positions. They form sets of four with one ray in every row and column. All sixteen differ
 * in height and in breadth, so that each adds information about a horizontal or a vertical edge (as
 * in Chiu, Shirley and Wang 1994). Their order is shuffled to resolve slanting edges as well. Four
 * suffice if they agree; if not, as on edges, or where a shadow ends, all sixteen are sent. Even
 * sixteen are off by a tenth of the contrast for bright things beside dark ones, such as a sunlit
 * ledge thinner than a pixel. If that is more than twice the pixel's own light, 48 more follow, on
 * a golden-ratio lattice. Positions are not jittered: beside a sky hundreds of times brighter,
 * random coverage frays an edge.
 *
 * Threads: plain values, not shared.
 */
#ifndef ORL_RENDER_IMAGE_PIXEL_H
#define ORL_RENDER_IMAGE_PIXEL_H

#include <stdbool.h>

#include "render/film/film.h"

enum { ORL_PIXEL_MOST_RAYS = 64, ORL_PIXEL_RAYS = 16, ORL_PIXEL_FIRST_RAYS = 4 };

/* Sets the position of a ray, in pixels from the pixel's corner. */
void orl_pixel_ray_position(uint32_t ray, double *ret_x, double *ret_y);

/* The radiance of a ray, and the standard errors of its luma: by the photons' two ways, and by the
 * rays for lobes and lamps. */
struct orl_ray_radiance {
    struct orl_rgb radiance;
    double rest_error, caustic_error, ray_error;
};

/* Sums over a pixel's rays so far; zero at first. */
struct orl_pixel_rays {
    struct orl_rgb sum;
    double squares, rest_error, caustic_error, ray_error; /* sums */
    double least, most;                                   /* range of the rays' luma */
    uint32_t rays;
};

void orl_pixel_add(struct orl_pixel_rays *tally, const struct orl_ray_radiance *ray_radiance);

/* Returns the number of rays that the pixel needs, by those so far. */
uint32_t orl_pixel_rays_needed(const struct orl_pixel_rays *tally);

/*
 * Returns the mean of the rays. The photons' errors are the same for all of them, and independent
 * between the two ways. The spread of the rays adds to these: noise of shadow rays and of lobes,
 * and edges that a few rays may miss.
 */
struct orl_pixel orl_pixel_resolve(const struct orl_pixel_rays *tally);

#endif
