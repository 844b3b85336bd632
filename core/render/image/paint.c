#include "render/image/image.h"

#include <math.h>
#include <stdatomic.h>

#include "base/sampling/sampling.h"

/* Tiles are small if pixels are painted one by one, so that all threads finish at about the same
 * time. */
enum { SMALL_TILE = 16 };

struct tiles {
    const struct orl_painting *painting;
    orl_paint_tile *paint;
    void *ctx;
    uint32_t side;
    size_t across, all, stride;
    bool by_pixel;      /* true if the paint function counts its pixels itself */
    atomic_size_t done; /* number of pixels painted */
    double before;      /* progress of the view before painting */
};

/* Returns true if the view has no aft clipping plane, or the ray meets something before it. */
static bool lies_within(const struct orl_painting *painting, double x, double y,
                        struct orl_vec3 origin, struct orl_vec3 direction)
{
    const struct orl_film *film = painting->film;
    struct orl_hit hit;
    if (!(painting->view->aft > 0))
        return true;
    return orl_geometry_intersect(
        painting->geometry, origin, direction,
        orl_view_clip_distance(painting->view, x / film->width, 1 - y / film->height), &hit);
}

bool orl_paint_ray(const struct orl_painting *painting, double x, double y,
                   struct orl_vec3 *ret_origin, struct orl_vec3 *ret_direction)
{
    const struct orl_film *film = painting->film;
    x += painting->shift[0];
    y += painting->shift[1];
    if (!orl_view_ray(painting->view, x / film->width, 1 - y / film->height, ret_origin,
                      ret_direction))
        return false;
    *ret_origin = orl_sub(*ret_origin, painting->geometry->center);
    return lies_within(painting, x, y, *ret_origin, *ret_direction);
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Counts painted pixels; any thread may call it, but only the calling thread of the loop reports
 * progress. */
static void count_pixels(struct tiles *tiles, size_t pixels, bool report)
{
    const struct orl_paint_env *env = tiles->painting->env;
    const struct orl_film *film = tiles->painting->film;
    const size_t done = atomic_fetch_add(&tiles->done, pixels) + pixels;
    const double share = (double)done / ((double)film->width * film->height);
    if (report)
        env->progress(env->ctx, tiles->before + (1 - tiles->before) * share);
}

static void paint_tile(void *arg, size_t index, uint32_t member)
{
    struct tiles *tiles = arg;
    const struct orl_painting *painting = tiles->painting;
    const size_t tile = orl_golden_order(index, tiles->stride, tiles->all);
    const uint32_t x = (uint32_t)(tile % tiles->across) * tiles->side;
    const uint32_t y = (uint32_t)(tile / tiles->across) * tiles->side;
    const struct orl_tile at = {x, y, least(x + tiles->side, painting->film->width),
                                least(y + tiles->side, painting->film->height)};
    if (orl_paint_cancelled(painting->env))
        return;
    tiles->paint(tiles->ctx, &at, &painting->env->searches[member]);
    if (!tiles->by_pixel)
        count_pixels(tiles, (size_t)(at.x1 - at.x0) * (at.y1 - at.y0), member == 0);
}

static int paint_all(struct tiles *tiles)
{
    const struct orl_painting *painting = tiles->painting;
    const struct orl_film *film = painting->film;
    tiles->across = (film->width + tiles->side - 1) / tiles->side;
    tiles->all = tiles->across * ((film->height + tiles->side - 1) / tiles->side);
    tiles->stride = orl_golden_stride(tiles->all);
    painting->env->progress(painting->env->ctx, tiles->before); /* end the previous phase */
    painting->env->phase(painting->env->ctx, tiles->before, 1);
    orl_parallel_for(painting->env->pool, tiles->all, paint_tile, tiles);
    if (orl_paint_cancelled(painting->env))
        return ORL_ERR_CANCELLED;
    painting->env->progress(painting->env->ctx, 1);
    return 0;
}

int orl_paint_tiles(const struct orl_painting *painting, orl_paint_tile *paint, void *ctx,
                    double before)
{
    struct tiles tiles = {
        .painting = painting, .paint = paint, .ctx = ctx, .side = ORL_PAINT_TILE, .before = before};
    return paint_all(&tiles);
}

struct pixels {
    struct tiles *tiles;
    orl_paint_pixel *pixel;
    void *ctx;
};

static void paint_pixels(void *ctx, const struct orl_tile *tile, struct orl_search *search)
{
    const struct pixels *pixels = ctx;
    const struct orl_painting *painting = pixels->tiles->painting;
    for (uint32_t y = tile->y0; y < tile->y1; y++) {
        for (uint32_t x = tile->x0; x < tile->x1; x++) {
            if (orl_paint_cancelled(painting->env))
                return;
            const struct orl_pixel pixel = pixels->pixel(pixels->ctx, x, y, search);
            orl_film_set(painting->film, x, y, &pixel, &search->health);
        }
        count_pixels(pixels->tiles, tile->x1 - tile->x0, search == &painting->env->searches[0]);
    }
}

int orl_paint(const struct orl_painting *painting, orl_paint_pixel *pixel, void *ctx, double before)
{
    struct pixels pixels = {NULL, pixel, ctx};
    struct tiles tiles = {.painting = painting,
                          .paint = paint_pixels,
                          .ctx = &pixels,
                          .side = SMALL_TILE,
                          .by_pixel = true,
                          .before = before};
    pixels.tiles = &tiles;
    return paint_all(&tiles);
}
