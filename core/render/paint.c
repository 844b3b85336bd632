#include "render/paint.h"

enum { TILE = 16, TILES_A_ROUND = 64 };

struct tiles {
    const struct orl_painting *painting;
    orl_paint_pixel *pixel;
    void *ctx;
    size_t first, across;
};

bool orl_paint_ray(const struct orl_painting *painting, double x, double y,
                   struct orl_vec3 *ret_origin, struct orl_vec3 *ret_direction)
{
    const struct orl_film *film = painting->film;
    if (!orl_view_ray(painting->view, x / film->width, 1 - y / film->height, ret_origin,
                      ret_direction))
        return false;
    *ret_origin = orl_sub(*ret_origin, painting->geometry->center);
    return true;
}

static void paint_tile(void *arg, size_t index, uint32_t member)
{
    const struct tiles *tiles = arg;
    const struct orl_painting *painting = tiles->painting;
    const struct orl_film *film = painting->film;
    struct orl_search *search = &painting->env->searches[member];
    const size_t tile = tiles->first + index;
    const uint32_t x0 = (uint32_t)(tile % tiles->across) * TILE;
    const uint32_t y0 = (uint32_t)(tile / tiles->across) * TILE;
    for (uint32_t y = y0; y < y0 + TILE && y < film->height; y++) {
        for (uint32_t x = x0; x < x0 + TILE && x < film->width; x++) {
            if (orl_paint_cancelled(painting->env))
                return;
            const struct orl_pixel pixel = tiles->pixel(tiles->ctx, x, y, search);
            orl_film_set(painting->film, x, y, &pixel, &search->health);
        }
    }
}

int orl_paint(const struct orl_painting *painting, orl_paint_pixel *pixel, void *ctx, double before)
{
    const struct orl_film *film = painting->film;
    struct tiles tiles = {.painting = painting, .pixel = pixel, .ctx = ctx};
    tiles.across = (film->width + TILE - 1) / TILE;
    const size_t all = tiles.across * ((film->height + TILE - 1) / TILE);
    for (tiles.first = 0; tiles.first < all; tiles.first += TILES_A_ROUND) {
        const size_t left = all - tiles.first;
        orl_crew_for(painting->env->crew, left < TILES_A_ROUND ? left : TILES_A_ROUND, paint_tile,
                     &tiles);
        if (orl_paint_cancelled(painting->env))
            return ORL_ERR_CANCELLED;
        painting->env->progress(painting->env->ctx,
                                before + (1 - before) * (double)tiles.first / (double)all);
    }
    return 0;
}
