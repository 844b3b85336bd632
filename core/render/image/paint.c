#include "render/image/paint.h"

#include <math.h>
#include <stdatomic.h>

#include "base/scatter.h"

enum { TILES_A_ROUND = 64 };

struct tiles {
    const struct orl_painting *painting;
    orl_paint_tile *paint;
    void *ctx;
    size_t first, across, all, stride;
    atomic_size_t done;
    double before; /* of the view */
};

/* Whether a view that is cut off in the distance has something before that. */
static bool lies_within(const struct orl_painting *painting, double x, double y,
                        struct orl_vec3 origin, struct orl_vec3 direction)
{
    const struct orl_film *film = painting->film;
    struct orl_hit hit;
    if (!(painting->view->aft > 0))
        return true;
    return orl_geometry_intersect(
        painting->geometry, origin, direction,
        orl_view_reach(painting->view, x / film->width, 1 - y / film->height), &hit);
}

bool orl_paint_ray(const struct orl_painting *painting, double x, double y,
                   struct orl_vec3 *ret_origin, struct orl_vec3 *ret_direction)
{
    const struct orl_film *film = painting->film;
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

/* By the lead, which alone tells: tiles that are done, and how much of its own. */
static void tell(const struct tiles *tiles, double of_own)
{
    const struct orl_paint_env *env = tiles->painting->env;
    const double done = ((double)atomic_load(&tiles->done) + of_own) / (double)tiles->all;
    env->progress(env->ctx, tiles->before + (1 - tiles->before) * fmin(done, 1));
}

static void paint_tile(void *arg, size_t index, uint32_t member)
{
    struct tiles *tiles = arg;
    const struct orl_painting *painting = tiles->painting;
    const size_t tile = orl_scatter(tiles->first + index, tiles->stride, tiles->all);
    const uint32_t x = (uint32_t)(tile % tiles->across) * ORL_PAINT_TILE;
    const uint32_t y = (uint32_t)(tile / tiles->across) * ORL_PAINT_TILE;
    const struct orl_tile at = {x, y, least(x + ORL_PAINT_TILE, painting->film->width),
                                least(y + ORL_PAINT_TILE, painting->film->height)};
    if (orl_paint_cancelled(painting->env))
        return;
    tiles->paint(tiles->ctx, &at, &painting->env->searches[member]);
    atomic_fetch_add(&tiles->done, 1);
    if (member == 0)
        tell(tiles, 0);
}

static int paint_all(struct tiles *tiles)
{
    const struct orl_painting *painting = tiles->painting;
    const struct orl_film *film = painting->film;
    tiles->across = (film->width + ORL_PAINT_TILE - 1) / ORL_PAINT_TILE;
    tiles->all = tiles->across * ((film->height + ORL_PAINT_TILE - 1) / ORL_PAINT_TILE);
    tiles->stride = orl_scatter_stride(tiles->all);
    for (tiles->first = 0; tiles->first < tiles->all; tiles->first += TILES_A_ROUND) {
        const size_t left = tiles->all - tiles->first;
        orl_crew_for(painting->env->crew, left < TILES_A_ROUND ? left : TILES_A_ROUND, paint_tile,
                     tiles);
        if (orl_paint_cancelled(painting->env))
            return ORL_ERR_CANCELLED;
    }
    painting->env->progress(painting->env->ctx, 1);
    return 0;
}

int orl_paint_tiles(const struct orl_painting *painting, orl_paint_tile *paint, void *ctx,
                    double before)
{
    struct tiles tiles = {.painting = painting, .paint = paint, .ctx = ctx, .before = before};
    return paint_all(&tiles);
}

struct pixels {
    const struct orl_painting *painting;
    const struct tiles *tiles;
    orl_paint_pixel *pixel;
    void *ctx;
};

static void paint_pixels(void *ctx, const struct orl_tile *tile, struct orl_search *search)
{
    const struct pixels *pixels = ctx;
    for (uint32_t y = tile->y0; y < tile->y1; y++) {
        for (uint32_t x = tile->x0; x < tile->x1; x++) {
            if (orl_paint_cancelled(pixels->painting->env))
                return;
            const struct orl_pixel pixel = pixels->pixel(pixels->ctx, x, y, search);
            orl_film_set(pixels->painting->film, x, y, &pixel, &search->health);
        }
        if (search == &pixels->painting->env->searches[0] && y + 1 < tile->y1)
            tell(pixels->tiles, (double)(y + 1 - tile->y0) / (tile->y1 - tile->y0));
    }
}

int orl_paint(const struct orl_painting *painting, orl_paint_pixel *pixel, void *ctx, double before)
{
    struct pixels pixels = {painting, NULL, pixel, ctx};
    struct tiles tiles = {
        .painting = painting, .paint = paint_pixels, .ctx = &pixels, .before = before};
    pixels.tiles = &tiles;
    return paint_all(&tiles);
}
