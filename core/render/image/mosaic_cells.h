/*
 * Data shared by the steps of a tile (mosaic.h): its pixels and a margin of one pixel, each with
 * the ray through its centre; the naming of random numbers; and the tracing of a ray through a
 * pixel. Pixel coordinates count from the tile's corner: the margin's are -1 and the last.
 *
 * Threads: a tile's cells belong to its thread.
 */
#ifndef ORL_RENDER_IMAGE_MOSAIC_CELLS_H
#define ORL_RENDER_IMAGE_MOSAIC_CELLS_H

#include "render/image/mosaic.h"
#include "render/image/pixel.h"

enum { ORL_CELLS_SIDE = ORL_PAINT_TILE + 2 };

/* A pixel, with the ray through its centre. */
struct orl_cell {
    bool there;   /* the pixel is in the picture */
    bool made;    /* the smooth part is known */
    bool exact;   /* the smooth part was computed here, not interpolated */
    bool refined; /* more rays are to be sent */
    uint64_t way;
    struct orl_rgb rest, direct, lobes;
    double variance; /* variance of direct and lobes */
    uint32_t more;   /* number of additional rays for its gloss */
    struct orl_smooth smooth;
    struct orl_shaded shaded;
};

/* State of a tile as it is painted. */
struct orl_tile_cells {
    const struct orl_mosaic *m;
    const struct orl_tile *tile;
    struct orl_search *search;
    struct orl_cell (*cells)[ORL_CELLS_SIDE]; /* rows, from the margin's on */
    struct orl_strays *strays;
    int width, height; /* size of the tile */
};

static inline struct orl_cell *orl_cell_at(const struct orl_tile_cells *mosaic, int x, int y)
{
    return &mosaic->cells[y + 1][x + 1];
}

static inline bool orl_cell_in_tile(const struct orl_tile_cells *mosaic, int x, int y)
{
    return x >= 0 && y >= 0 && x < mosaic->width && y < mosaic->height;
}

static inline uint64_t orl_cell_index(const struct orl_tile_cells *mosaic, int x, int y)
{
    const uint64_t width = mosaic->m->painting->film->width;
    return (uint64_t)((int64_t)mosaic->tile->y0 + y) * width +
           (uint64_t)((int64_t)mosaic->tile->x0 + x);
}

/* Returns the random stream of a pixel's ray; the centre ray is the last. */
static inline struct orl_random orl_cell_numbers(const struct orl_tile_cells *mosaic, int x, int y,
                                                 uint32_t ray)
{
    const uint64_t cell = orl_cell_index(mosaic, x, y);
    return orl_random_stream(mosaic->m->seed, ORL_PURPOSE_PIXEL,
                             ray > ORL_PIXEL_RAYS ? orl_mix64(cell) + ray
                                                  : cell * (ORL_PIXEL_RAYS + 1) + ray);
}

/* Returns the name of the sequence of a pixel's shadow rays. */
static inline uint32_t orl_cell_sequence(const struct orl_tile_cells *mosaic, int x, int y)
{
    return (uint32_t)orl_mix64(mosaic->m->seed * 5 + orl_cell_index(mosaic, x, y));
}

/* One look of several that share a pixel's lobe rays: it sends one in `of` of them; 0: none. */
struct orl_lobe_share {
    uint32_t of, look;
};

/* Traces the ray through a position in a pixel; returns false if it lies outside the view. */
bool orl_cell_look(const struct orl_tile_cells *mosaic, int x, int y, const double place[2],
                   struct orl_lobe_share share, struct orl_random *random,
                   struct orl_shaded *ret_shaded);

/* Second step (mosaic_smooth.c): computes the smooth part at all pixels of the tile. */
void orl_mosaic_fill(const struct orl_tile_cells *mosaic);

/* Third step (mosaic_gloss.c): sends more rays for gloss that would be noisy. */
void orl_mosaic_polish(const struct orl_tile_cells *mosaic);

/* Last step (mosaic_edges.c): writes the tile's pixels to the film, those on edges from more
 * rays. */
void orl_mosaic_settle(const struct orl_tile_cells *mosaic);

#endif
