#include "render/image/mosaic_cells.h"

/* Tolerated noise of a pixel's gloss, as a share of the pixel. It is computed as if rays were
 * random; they are stratified, so that the noise is about half of that. */
static const double tolerance = 0.04;

/* Limits of the additional gloss rays; distance, and least number, of the pixels that determine
 * them. */
enum { LEAST_MORE = 8, MOST_MORE = 64, ABOUT = 2, FEWEST_ABOUT = 4 };

/* Gloss statistics of the pixels about one. */
struct hearsay {
    double variance, luma; /* sums over the pixels */
    uint32_t count;
};

static struct orl_rgb radiance_of(const struct orl_cell *cell)
{
    return orl_rgb_add(orl_rgb_add(cell->rest, cell->direct),
                       orl_rgb_add(cell->lobes, cell->smooth.radiance));
}

/* Collects the statistics of the pixels with the same path signature, or of all with lobes. */
static struct hearsay collect_gloss(const struct orl_tile_cells *mosaic, int x, int y, bool same)
{
    const uint64_t way = orl_cell_at(mosaic, x, y)->way;
    struct hearsay heard = {.count = 0};
    for (int v = y - ABOUT; v <= y + ABOUT; v++) {
        for (int u = x - ABOUT; u <= x + ABOUT; u++) {
            if ((u == x && v == y) || !orl_cell_in_tile(mosaic, u, v))
                continue;
            const struct orl_cell *cell = orl_cell_at(mosaic, u, v);
            if (!cell->shaded.has_lobes || (same && cell->way != way))
                continue;
            heard.variance += cell->shaded.gloss_variance;
            heard.luma += orl_luma(radiance_of(cell));
            heard.count++;
        }
    }
    return heard;
}

/* Returns the number of additional rays, by the noise of the pixels about. The pixel's own rays do
 * not decide: if few things are bright, rays that missed them would show too little noise. */
static uint32_t more_for(const struct orl_tile_cells *mosaic, int x, int y)
{
    struct hearsay heard = collect_gloss(mosaic, x, y, true);
    if (heard.count < FEWEST_ABOUT)
        heard = collect_gloss(mosaic, x, y, false);
    if (heard.count == 0)
        return LEAST_MORE;
    const double luma = heard.luma / heard.count, allowed = tolerance * luma;
    const double times = heard.variance / heard.count / (allowed * allowed);
    const double rays = mosaic->m->shader.gloss_samples * (times - 1);
    uint32_t more = 0;
    if (!(rays > 0) || !(luma > 0))
        return 0;
    for (more = LEAST_MORE; more < MOST_MORE && more < rays;)
        more *= 2;
    return more;
}

static void add_gloss_rays(const struct orl_tile_cells *mosaic, int x, int y)
{
    static const double middle[2] = {0.5, 0.5};
    struct orl_cell *cell = orl_cell_at(mosaic, x, y);
    struct orl_tile_cells again = *mosaic;
    struct orl_mosaic with_more = *mosaic->m;
    struct orl_random random =
        orl_random_stream(mosaic->m->seed, ORL_PURPOSE_GLOSS, orl_cell_index(mosaic, x, y));
    struct orl_shaded shaded;
    const double first = mosaic->m->shader.gloss_samples, share = cell->more / (first + cell->more);
    with_more.shader.gloss_samples = cell->more;
    with_more.shader.only_gloss = true;
    again.m = &with_more;
    if (!orl_cell_look(&again, x, y, middle, (struct orl_lobe_share){.of = 1}, &random, &shaded))
        return;
    const struct orl_rgb change = orl_rgb_add(shaded.gloss, orl_rgb_scale(cell->shaded.gloss, -1));
    cell->lobes = orl_rgb_add(cell->lobes, orl_rgb_scale(change, share));
    const double before = cell->shaded.gloss_variance;
    const double variance =
        share * share * shaded.gloss_variance + (1 - share) * (1 - share) * before;
    cell->variance += variance - before;
    cell->shaded.lobes_variance += variance - before;
}

void orl_mosaic_polish(const struct orl_tile_cells *mosaic)
{
    for (int y = 0; y < mosaic->height; y++)
        for (int x = 0; x < mosaic->width; x++) {
            struct orl_cell *cell = orl_cell_at(mosaic, x, y);
            cell->more = cell->shaded.has_lobes ? more_for(mosaic, x, y) : 0;
        }
    for (int y = 0; y < mosaic->height && !orl_paint_cancelled(mosaic->m->painting->env); y++)
        for (int x = 0; x < mosaic->width; x++)
            if (orl_cell_at(mosaic, x, y)->more > 0)
                add_gloss_rays(mosaic, x, y);
}
