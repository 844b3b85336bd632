/*
 * Data shared by the steps of a tile (adaptive_tile.h): its pixels and a margin of one pixel, each
 * with the ray through its centre; the naming of random numbers; and the tracing of a ray through a
 * pixel. Pixel coordinates count from the tile's corner: the margin's are -1 and the last.
 *
 * Threads: a tile's cells belong to its thread.
 */
#ifndef ORL_RENDER_IMAGE_ADAPTIVE_TILE_PIXELS_H
#define ORL_RENDER_IMAGE_ADAPTIVE_TILE_PIXELS_H

#include "render/image/adaptive_tile.h"
#include "render/image/pixel.h"

enum { ORL_TILE_SIDE_WITH_MARGIN = ORL_PAINT_TILE + 2 };

/* A pixel, with the ray through its centre. */
struct orl_tile_pixel {
    bool there;   /* the pixel is in the picture */
    bool made;    /* the smooth part is known */
    bool exact;   /* the smooth part was computed here, not interpolated */
    bool refined; /* more rays are to be sent */
    uint64_t way;
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

/* One look of several that share a pixel's lobe rays: it sends one in `of` of them; 0: none. */
struct orl_lobe_share {
    uint32_t of, look;
};

/* Traces the ray through a position in a pixel; returns false if it lies outside the view. */
bool orl_tile_trace_ray(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const double place[2], struct orl_lobe_share share,
                        struct orl_random *random, struct orl_shaded_ray *ret_shaded);

/* Second step (adaptive_tile_smooth.c): computes the smooth part at all pixels of the tile. */
void orl_tile_compute_smooth(const struct orl_adaptive_tile *tile_state);

/* Third step (adaptive_tile_gloss.c): sends more rays for gloss that would be noisy. */
void orl_tile_refine_gloss(const struct orl_adaptive_tile *tile_state);

/* Last step (adaptive_tile_edges.c): writes the tile's pixels to the film, those on edges from more
 * rays. */
void orl_tile_write_pixels(const struct orl_adaptive_tile *tile_state);

#endif
