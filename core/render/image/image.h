/* A view: painting of pixels in tiles for every technique, small lights, and the picture from
 * photon maps. */
#ifndef ORL_RENDER_IMAGE_IMAGE_H
#define ORL_RENDER_IMAGE_IMAGE_H

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>

#include "photon/density/density_estimate.h"
#include "render/film/film.h"
#include "render/gather/gather.h"
#include "render/image/shade.h"
#include "scene/geometry/geometry.h"

/* Paints pixels in tiles on all cores, for every technique. The value and standard error of a pixel
 * depend on its position alone, so that any thread may paint tiles in any order. */

struct orl_paint_env {
    struct orl_thread_pool *pool;
    struct orl_search *searches; /* one per thread of the pool */
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
    /* Factor of the rays for records and panes' lobes over the usual number; 0: 1. */
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

/*
 * Suns and small lamps seen directly, or through panes that do not deflect them. Their light in a
 * picture is their luminance times their solid angle, for any pixel size.
 *
 * A sun's disc is half a degree wide, about a pixel of a fisheye. Pixel rays hit or miss it by
 * chance, as they do a bulb across a room; between rays at fixed positions it disappears. If a sun
 * or a lamp is small compared to pixels, pixel rays therefore ignore it (ORL_SUNS_EXCLUDED,
 * orl_shader.excluded_lamps). Rays of its own go to evenly spaced points of it. Each ray's light is
 * added to the pixel that it passes through, weighted by that pixel's solid angle. Lights that
 * cover many pixels, and those seen in mirrors, are left to pixel rays.
 */

/* Lights that pixel rays ignore. */
struct orl_small_lights {
    enum orl_sun_visibility suns;
    bool *lamps; /* by facet, owned; NULL: none */
};

/* Chooses the small lights of a view. Returns 0 or ORL_ERR_NOMEM; call orl_small_lights_done in
 * either case. */
int orl_small_lights_init(struct orl_small_lights *small_lights,
                          const struct orl_lit_scene *lit_scene,
                          const struct orl_painting *painting);
void orl_small_lights_done(struct orl_small_lights *small_lights);

/* Adds the small lights to a picture that was painted without them. outside: true if the eye is
 * outside. */
void orl_small_lights_paint(const struct orl_small_lights *small_lights,
                            const struct orl_shader *shader, const struct orl_painting *painting,
                            bool outside);

/*
 * One view from photon maps. With a final gather, irradiance records are made first, in rounds from
 * coarse to fine; then tiles are painted (adaptive_tile.h).
 *
 * A pixel's standard error contains the photons' noise, through records or densities, and the noise
 * of the rays for lobes and lamps. If the pixel has several rays it also contains their spread,
 * which counts edges as if rays were random. It does not contain errors of interpolation between
 * records or pixels, the bias of densities, or the light of omitted branches.
 */

/* Renders into the painting's film. Returns 0, ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err);

#endif
