#include "render/image/adaptive_tile.h"

#include <stdlib.h>

#include "render/image/adaptive_tile_pixels.h"

static void trace_centre_ray(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    static const double middle[2] = {0.5, 0.5};
    const struct orl_film *film = tile_state->painter->painting->film;
    const int64_t column = (int64_t)tile_state->tile->x0 + x,
                  row = (int64_t)tile_state->tile->y0 + y;
    struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
    struct orl_random random = orl_tile_pixel_random(tile_state, x, y, ORL_PIXEL_RAYS);
    tile_pixel->there = column >= 0 && row >= 0 && column < film->width && row < film->height;
    tile_pixel->made = tile_pixel->exact = tile_pixel->refined = false;
    if (!tile_pixel->there)
        return;
    tile_pixel->way = 0;
    tile_pixel->shaded.has_lobes = false;
    tile_pixel->variance = 0;
    tile_pixel->rest = tile_pixel->direct = tile_pixel->lobes = orl_gray(0);
    tile_pixel->shaded.n_vertices = 0;
    if (!orl_tile_trace_ray(tile_state, x, y, middle,
                            (struct orl_lobe_share){.of = orl_tile_contains(tile_state, x, y)},
                            &random, &tile_pixel->shaded))
        return;
    const struct orl_direct_lighting direct = orl_lighting_direct(
        &tile_state->painter->lighting, &tile_pixel->shaded,
        orl_tile_pixel_sequence(tile_state, x, y),
        ORL_PIXEL_RAYS * tile_state->painter->lighting.shadow_rays, &tile_state->search->health);
    tile_pixel->way = tile_pixel->shaded.way;
    tile_pixel->rest = tile_pixel->shaded.rest;
    tile_pixel->lobes = tile_pixel->shaded.lobes;
    tile_pixel->direct = direct.radiance;
    tile_pixel->variance = direct.variance + tile_pixel->shaded.lobes_variance;
}

static void paint_pixels(const struct orl_adaptive_tile *tile_state)
{
    const struct orl_paint_env *env = tile_state->painter->painting->env;
    for (int y = -1; y <= tile_state->height && !orl_paint_cancelled(env); y++)
        for (int x = -1; x <= tile_state->width; x++)
            trace_centre_ray(tile_state, x, y);
    if (orl_paint_cancelled(env))
        return;
    orl_tile_compute_smooth(tile_state);
    orl_tile_refine_gloss(tile_state);
    orl_tile_write_pixels(tile_state);
}

void orl_tile_painter_paint(void *ctx, const struct orl_tile *tile, struct orl_search *search)
{
    const struct orl_tile_painter *painter = ctx;
    struct orl_adaptive_tile tile_state = {
        .painter = painter,
        .tile = tile,
        .search = search,
        .tile_pixels = malloc(ORL_TILE_SIDE_WITH_MARGIN * sizeof *tile_state.tile_pixels),
        .recent_records = calloc(1, sizeof *tile_state.recent_records),
        .width = (int)(tile->x1 - tile->x0),
        .height = (int)(tile->y1 - tile->y0)};
    if (tile_state.tile_pixels && tile_state.recent_records)
        paint_pixels(&tile_state);
    else
        atomic_store(painter->failed, true);
    free(tile_state.tile_pixels);
    free(tile_state.recent_records);
}
