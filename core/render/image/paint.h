/*
 * Pixels in tiles, by all cores: what images of every technique share. What a pixel is, value and
 * standard error, is a function of its place alone, so that tiles may be painted in any order by
 * any crew.
 */
#ifndef ORL_RENDER_IMAGE_PAINT_H
#define ORL_RENDER_IMAGE_PAINT_H

#include <stdatomic.h>

#include <oriel/crew.h>

#include "photon/density/search.h"
#include "render/film/film.h"
#include "render/film/view.h"
#include "scene/geometry/geometry.h"

struct orl_paint_env {
    struct orl_crew *crew;
    struct orl_search *searches; /* one per crew member */
    atomic_bool *cancel;
    uint64_t index; /* of the view in the job: names its random numbers */
    void (*progress)(void *ctx, double fraction);
    void (*phase)(void *ctx, double from, double to); /* work of one kind begins */
    void *ctx;
};

struct orl_painting {
    const struct orl_paint_env *env;
    const struct orl_geometry *geometry; /* whose coordinates the rays are in */
    const struct orl_view *view;         /* in the files' coordinates */
    struct orl_film *film;
    bool irradiance; /* of what is seen, W/m2, instead of its radiance */
    double shift[2]; /* pixels, right and down, that all rays are moved by: of one of several
                        pictures that become one, which places between fixed rays are to be in */
    double rays; /* of records and of panes' lobes, over the usual number; 0: that one (image.h) */
};

static inline bool orl_paint_cancelled(const struct orl_paint_env *env)
{
    return atomic_load_explicit(env->cancel, memory_order_relaxed);
}

/* The ray through a place of the picture, in pixels from its upper left; false outside the view, or
 * where all of it lies beyond -va. */
bool orl_paint_ray(const struct orl_painting *painting, double x, double y,
                   struct orl_vec3 *ret_origin, struct orl_vec3 *ret_direction);

/* The pixels [x0, x1) x [y0, y1). */
struct orl_tile {
    uint32_t x0, y0, x1, y1;
};
enum { ORL_PAINT_TILE = 32 }; /* the most of a side */

/* Paints every tile; progress goes from `before` to 1. Returns 0 or ORL_ERR_CANCELLED. */
typedef void orl_paint_tile(void *ctx, const struct orl_tile *tile, struct orl_search *search);
int orl_paint_tiles(const struct orl_painting *painting, orl_paint_tile *tile, void *ctx,
                    double before);

/* The same pixel by pixel. */
typedef struct orl_pixel orl_paint_pixel(void *ctx, uint32_t x, uint32_t y,
                                         struct orl_search *search);
int orl_paint(const struct orl_painting *painting, orl_paint_pixel *pixel, void *ctx,
              double before);

#endif
