#include "render/image/adaptive_tile_pixels.h"

/* Tolerated noise of a pixel's gloss, as a share of the pixel. It is computed as if rays were
 * random; they are stratified, so that the noise is about half of that. */
static const double tolerance = 0.04;

/* Limits of the additional gloss rays; distance, and least number, of the pixels that determine
 * them. */
enum { LEAST_MORE = 8, MOST_MORE = 64, ABOUT = 2, FEWEST_ABOUT = 4 };

/* Gloss statistics of the pixels about one. */
struct gloss_statistics {
    double variance, luma; /* sums over the pixels */
    uint32_t count;
};

static struct orl_rgb radiance_of(const struct orl_tile_pixel *tile_pixel)
{
    return orl_rgb_add(orl_rgb_add(tile_pixel->rest, tile_pixel->direct),
                       orl_rgb_add(tile_pixel->lobes, tile_pixel->smooth.radiance));
}

/* Collects the statistics of the pixels with the same path signature, or of all with lobes. */
static struct gloss_statistics collect_gloss(const struct orl_adaptive_tile *tile_state, int x,
                                             int y, bool same)
{
    const uint64_t way = orl_tile_pixel_at(tile_state, x, y)->way;
    struct gloss_statistics heard = {.count = 0};
    for (int v = y - ABOUT; v <= y + ABOUT; v++) {
        for (int u = x - ABOUT; u <= x + ABOUT; u++) {
            if ((u == x && v == y) || !orl_tile_contains(tile_state, u, v))
                continue;
            const struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, u, v);
            if (!tile_pixel->shaded.has_lobes || (same && tile_pixel->way != way))
                continue;
            heard.variance += tile_pixel->shaded.gloss_variance;
            heard.luma += orl_luma(radiance_of(tile_pixel));
            heard.count++;
        }
    }
    return heard;
}

/* Returns the number of additional rays, by the noise of the pixels about. The pixel's own rays do
 * not decide: if few things are bright, rays that missed them would show too little noise. */
static uint32_t more_for(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    struct gloss_statistics heard = collect_gloss(tile_state, x, y, true);
    if (heard.count < FEWEST_ABOUT)
        heard = collect_gloss(tile_state, x, y, false);
    if (heard.count == 0)
        return LEAST_MORE;
    const double luma = heard.luma / heard.count, allowed = tolerance * luma;
    const double times = heard.variance / heard.count / (allowed * allowed);
    const double rays = tile_state->painter->shader.gloss_samples * (times - 1);
    uint32_t more = 0;
    if (!(rays > 0) || !(luma > 0))
        return 0;
    for (more = LEAST_MORE; more < MOST_MORE && more < rays;)
        more *= 2;
    return more;
}

static void add_gloss_rays(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    static const double middle[2] = {0.5, 0.5};
    struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
    struct orl_adaptive_tile again = *tile_state;
    struct orl_tile_painter with_more = *tile_state->painter;
    struct orl_random random = orl_random_stream(tile_state->painter->seed, ORL_PURPOSE_GLOSS,
                                                 orl_tile_pixel_index(tile_state, x, y));
    struct orl_shaded_ray shaded;
    const double first = tile_state->painter->shader.gloss_samples,
                 share = tile_pixel->more / (first + tile_pixel->more);
    with_more.shader.gloss_samples = tile_pixel->more;
    with_more.shader.only_gloss = true;
    again.painter = &with_more;
    if (!orl_tile_trace_ray(&again, x, y, middle, (struct orl_lobe_share){.of = 1}, &random,
                            &shaded))
        return;
    const struct orl_rgb change =
        orl_rgb_add(shaded.gloss, orl_rgb_scale(tile_pixel->shaded.gloss, -1));
    tile_pixel->lobes = orl_rgb_add(tile_pixel->lobes, orl_rgb_scale(change, share));
    const double before = tile_pixel->shaded.gloss_variance;
    const double variance =
        share * share * shaded.gloss_variance + (1 - share) * (1 - share) * before;
    tile_pixel->variance += variance - before;
    tile_pixel->shaded.lobes_variance += variance - before;
}

void orl_tile_refine_gloss(const struct orl_adaptive_tile *tile_state)
{
    for (int y = 0; y < tile_state->height; y++)
        for (int x = 0; x < tile_state->width; x++) {
            struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
            tile_pixel->more = tile_pixel->shaded.has_lobes ? more_for(tile_state, x, y) : 0;
        }
    for (int y = 0;
         y < tile_state->height && !orl_paint_cancelled(tile_state->painter->painting->env); y++)
        for (int x = 0; x < tile_state->width; x++)
            if (orl_tile_pixel_at(tile_state, x, y)->more > 0)
                add_gloss_rays(tile_state, x, y);
}
