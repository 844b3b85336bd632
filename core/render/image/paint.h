/* Paints pixels in tiles on all cores, for every technique. The value and standard error of a pixel
 * depend on its position alone, so that any crew may paint tiles in any order. */
#ifndef ORL_RENDER_IMAGE_PAINT_H
#define ORL_RENDER_IMAGE_PAINT_H

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>

#include "photon/density/density_search.h"
#include "render/film/film.h"
#include "render/film/view.h"
#include "scene/geometry/geometry.h"

struct orl_paint_env {
    struct orl_thread_pool *pool;
    struct orl_search *searches; /* one per crew member */
    atomic_bool *cancel;
    uint64_t index; /* index of the view in the job; names its random numbers */
    void (*progress)(void *ctx, double fraction);
    void (*phase)(void *ctx, double from,
                  double to); /* begins a phase of the progress, with work of one kind */
    void *ctx;
};

struct orl_painting {
    const struct orl_paint_env *env;
    const struct orl_geometry *geometry; /* rays are in its coordinates */
    const struct orl_view *view;         /* in the coordinates of the files */
    struct orl_film *film;
    bool irradiance; /* if true, pixels are irradiances of the surfaces seen, W/m2 */
    /* offset of all rays, in pixels right and down: pictures with different offsets are combined,
     * so that features between fixed rays appear in one of them */
    double shift[2];
    /* Factor of the rays for records and panes' lobes over the usual number; 0: 1 (image.h). */
    double rays;
};

static inline bool orl_paint_cancelled(const struct orl_paint_env *env)
{
    return atomic_load_explicit(env->cancel, memory_order_relaxed);
}

/* Returns the ray through a position in the picture, in pixels from its upper left. Returns false
 * outside the view, or if the ray meets nothing before the aft clipping plane (-va). */
bool orl_paint_ray(const struct orl_painting *painting, double x, double y,
                   struct orl_vec3 *ret_origin, struct orl_vec3 *ret_direction);

/* The pixels [x0, x1) x [y0, y1). */
struct orl_tile {
    uint32_t x0, y0, x1, y1;
};
enum { ORL_PAINT_TILE = 32 }; /* largest side */

/* Paints every tile; progress goes from `before` to 1. Returns 0 or ORL_ERR_CANCELLED. */
typedef void orl_paint_tile(void *ctx, const struct orl_tile *tile, struct orl_search *search);
int orl_paint_tiles(const struct orl_painting *painting, orl_paint_tile *tile, void *ctx,
                    double before);

/* Paints pixel by pixel; otherwise like orl_paint_tiles. */
typedef struct orl_pixel orl_paint_pixel(void *ctx, uint32_t x, uint32_t y,
                                         struct orl_search *search);
int orl_paint(const struct orl_painting *painting, orl_paint_pixel *pixel, void *ctx,
              double before);

#endif
