#include "render/image/mosaic.h"

#include <stdlib.h>

#include "render/image/mosaic_cells.h"

static void trace_centre_ray(const struct orl_tile_cells *mosaic, int x, int y)
{
    static const double middle[2] = {0.5, 0.5};
    const struct orl_film *film = mosaic->m->painting->film;
    const int64_t column = (int64_t)mosaic->tile->x0 + x, row = (int64_t)mosaic->tile->y0 + y;
    struct orl_cell *cell = orl_cell_at(mosaic, x, y);
    struct orl_random random = orl_cell_numbers(mosaic, x, y, ORL_PIXEL_RAYS);
    cell->there = column >= 0 && row >= 0 && column < film->width && row < film->height;
    cell->made = cell->exact = cell->refined = false;
    if (!cell->there)
        return;
    cell->way = 0;
    cell->shaded.has_lobes = false;
    cell->variance = 0;
    cell->rest = cell->direct = cell->lobes = orl_gray(0);
    cell->shaded.n_vertices = 0;
    if (!orl_cell_look(mosaic, x, y, middle,
                       (struct orl_lobe_share){.of = orl_cell_in_tile(mosaic, x, y)}, &random,
                       &cell->shaded))
        return;
    const struct orl_shadowed direct = orl_lighting_direct(
        &mosaic->m->lighting, &cell->shaded, orl_cell_sequence(mosaic, x, y),
        ORL_PIXEL_RAYS * mosaic->m->lighting.shadow_rays, &mosaic->search->health);
    cell->way = cell->shaded.way;
    cell->rest = cell->shaded.rest;
    cell->lobes = cell->shaded.lobes;
    cell->direct = direct.radiance;
    cell->variance = direct.variance + cell->shaded.lobes_variance;
}

static void paint_cells(const struct orl_tile_cells *mosaic)
{
    const struct orl_paint_env *env = mosaic->m->painting->env;
    for (int y = -1; y <= mosaic->height && !orl_paint_cancelled(env); y++)
        for (int x = -1; x <= mosaic->width; x++)
            trace_centre_ray(mosaic, x, y);
    if (orl_paint_cancelled(env))
        return;
    orl_mosaic_fill(mosaic);
    orl_mosaic_polish(mosaic);
    orl_mosaic_settle(mosaic);
}

void orl_mosaic_paint(void *ctx, const struct orl_tile *tile, struct orl_search *search)
{
    const struct orl_mosaic *m = ctx;
    struct orl_tile_cells mosaic = {.m = m,
                                    .tile = tile,
                                    .search = search,
                                    .cells = malloc(ORL_CELLS_SIDE * sizeof *mosaic.cells),
                                    .strays = calloc(1, sizeof *mosaic.strays),
                                    .width = (int)(tile->x1 - tile->x0),
                                    .height = (int)(tile->y1 - tile->y0)};
    if (mosaic.cells && mosaic.strays)
        paint_cells(&mosaic);
    else
        atomic_store(m->failed, true);
    free(mosaic.cells);
    free(mosaic.strays);
}
