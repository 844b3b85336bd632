/* A tile of a view from photon maps: the rays of a pixel, the four steps that paint the tile, and
 * the data that they share. */
#ifndef ORL_RENDER_IMAGE_ADAPTIVE_TILE_H
#define ORL_RENDER_IMAGE_ADAPTIVE_TILE_H

#include <stdbool.h>

#include "render/film/film.h"
#include "render/image/image.h"
#include "render/image/lighting.h"

/*
 * A pixel's rays: their positions, their number, and their mean.
 *
 * A pixel that its neighbours leave in doubt sends rays through a grid of four by four positions.
 * They form sets of four with one ray in every row and column. All sixteen differ
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

/*
 * A tile of a view from photon maps, painted in four steps of different density:
 *   one ray through the centre of every pixel, and its shadow rays;
 *   the smooth part (lighting.h) at the corners of squares of pixels whose rays have the same path
 *   signature (shade.h). It is interpolated to the pixels between if the square's centre agrees;
 *   otherwise squares are quartered, down to single pixels;
 *   more rays for gloss, if the pixels about one show noise;
 *   more rays through a pixel if neighbours see other surfaces, shadows end, or the caustic
 *   part is steep. They take the smooth part from the nearest pixel that sees the same.
 * A pixel that finds there something that none of its neighbours has seen makes these send more
 * rays as well, so that things narrower than a pixel are followed. So does one that finds a
 * shadow's edge; the pixels about it send all of a pixel's rays, so that penumbras are sampled from
 * end to end.
 *
 * A tile is a function of the view and its position alone; threads share only constant data.
 */

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

/*
 * Data shared by the steps of a tile: its pixels and a margin of one pixel, each
 * with the ray through its centre; the naming of random numbers; and the tracing of a ray through a
 * pixel. Pixel coordinates count from the tile's corner: the margin's are -1 and the last.
 *
 * Threads: a tile's cells belong to its thread.
 */

enum { ORL_TILE_SIDE_WITH_MARGIN = ORL_PAINT_TILE + 2 };

/* A pixel, with the ray through its centre. */
struct orl_tile_pixel {
    bool there;   /* the pixel is in the picture */
    bool made;    /* the smooth part is known */
    bool exact;   /* the smooth part was computed here, not interpolated */
    bool refined; /* more rays are to be sent */
    uint64_t path_signature;
    struct orl_rgb rest, direct, lobes;
    double variance; /* variance of direct and lobes */
    uint32_t more;   /* number of additional rays for its gloss */
    struct orl_smooth_lighting smooth;
    struct orl_shaded_ray shaded;
};

/* State of a tile as it is painted. */
struct orl_adaptive_tile {
    const struct orl_tile_painter *painter;
    const struct orl_tile *tile;
    struct orl_search *search;
    struct orl_tile_pixel (
        *tile_pixels)[ORL_TILE_SIDE_WITH_MARGIN]; /* rows, from the margin's on */
    struct orl_recent_records *recent_records;
    int width, height; /* size of the tile */
};

static inline struct orl_tile_pixel *orl_tile_pixel_at(const struct orl_adaptive_tile *tile_state,
                                                       int x, int y)
{
    return &tile_state->tile_pixels[y + 1][x + 1];
}

static inline bool orl_tile_contains(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    return x >= 0 && y >= 0 && x < tile_state->width && y < tile_state->height;
}

static inline uint64_t orl_tile_pixel_index(const struct orl_adaptive_tile *tile_state, int x,
                                            int y)
{
    const uint64_t width = tile_state->painter->painting->film->width;
    return (uint64_t)((int64_t)tile_state->tile->y0 + y) * width +
           (uint64_t)((int64_t)tile_state->tile->x0 + x);
}

/* Returns the random stream of a pixel's ray; the centre ray is the last. */
static inline struct orl_random orl_tile_pixel_random(const struct orl_adaptive_tile *tile_state,
                                                      int x, int y, uint32_t ray)
{
    const uint64_t tile_pixel = orl_tile_pixel_index(tile_state, x, y);
    return orl_random_stream(tile_state->painter->seed, ORL_PURPOSE_PIXEL,
                             ray > ORL_PIXEL_RAYS ? orl_mix64(tile_pixel) + ray
                                                  : tile_pixel * (ORL_PIXEL_RAYS + 1) + ray);
}

/* Returns the name of the sequence of a pixel's shadow rays. */
static inline uint32_t orl_tile_pixel_sequence(const struct orl_adaptive_tile *tile_state, int x,
                                               int y)
{
    return (uint32_t)orl_mix64(tile_state->painter->seed * 5 +
                               orl_tile_pixel_index(tile_state, x, y));
}

/* Index of one of several view rays that share a pixel's lobe rays. It sends one in `of` of them;
 * 0: none. */
struct orl_lobe_share {
    uint32_t of, look;
};

/* Traces the ray through a position in a pixel; returns false if it lies outside the view. */
bool orl_tile_trace_ray(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const double place[2], struct orl_lobe_share share,
                        struct orl_random *random, struct orl_shaded_ray *ret_shaded);

/* Performs the last step (adaptive_tile_edges.c): writes the tile's pixels to the film, those on
 * edges from more rays. */
void orl_tile_write_pixels(const struct orl_adaptive_tile *tile_state);

#endif
