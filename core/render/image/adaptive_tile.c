/* Paints a tile: the first step, smooth light at the corners of squares, and more rays for gloss.
 * adaptive_tile_edges.c has the last step. */
#include "render/image/adaptive_tile.h"

#include <stdlib.h>

/* ---- Smooth light ---------------------------------------------------------------------------- */

/* Width of the largest squares, in pixels. */
enum { WIDEST = 8 };

/* Tolerated interpolation error: the first share of the pixel, or its standard error, but at most
 * the second share. */
static const double smooth_tolerance = 0.02, most_tolerance = 0.06;

/* Squares whose corners differ by more than this share of their mean are divided even if the centre
 * agrees: near an abrupt end of light it may agree by chance. */
static const double steep = 0.5;

static void make_exact(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
    struct orl_random random = orl_tile_pixel_random(tile_state, x, y, ORL_PIXEL_RAYS);
    if (tile_pixel->exact || !tile_pixel->there)
        return;
    tile_pixel->smooth =
        orl_lighting_smooth(&tile_state->painter->lighting, &tile_pixel->shaded,
                            tile_state->recent_records, &random, tile_state->search);
    tile_pixel->made = tile_pixel->exact = true;
}

/* Inclusive corners of a square of pixels. */
struct square {
    int x0, y0, x1, y1;
};

/* Adds a share of one estimate to another. */
static void add_smooth(struct orl_smooth_lighting *sum, const struct orl_smooth_lighting *more,
                       double share)
{
    sum->radiance = orl_rgb_add(sum->radiance, orl_rgb_scale(more->radiance, share));
    sum->caustic += share * more->caustic;
    sum->rest_error += share * more->rest_error;
    sum->caustic_error += share * more->caustic_error;
    sum->reach = fmin(sum->reach, more->reach);
}

/* Interpolates between the corners, by shares of the way across and down. */
static struct orl_smooth_lighting interpolate_corners(const struct orl_adaptive_tile *tile_state,
                                                      const struct square *s, double across,
                                                      double down)
{
    struct orl_smooth_lighting sum = {.reach = INFINITY};
    add_smooth(&sum, &orl_tile_pixel_at(tile_state, s->x0, s->y0)->smooth,
               (1 - across) * (1 - down));
    add_smooth(&sum, &orl_tile_pixel_at(tile_state, s->x1, s->y0)->smooth, across * (1 - down));
    add_smooth(&sum, &orl_tile_pixel_at(tile_state, s->x0, s->y1)->smooth, (1 - across) * down);
    add_smooth(&sum, &orl_tile_pixel_at(tile_state, s->x1, s->y1)->smooth, across * down);
    return sum;
}

static double share_of(int at, int from, int to)
{
    return to > from ? (double)(at - from) / (to - from) : 0;
}

/* Returns true if corners and centre see the same, and the corners' interpolation agrees with the
 * centre. */
static bool is_smooth(const struct orl_adaptive_tile *tile_state, const struct square *s)
{
    const int x = (s->x0 + s->x1) / 2, y = (s->y0 + s->y1) / 2;
    const int xs[4] = {s->x0, s->x1, s->x0, s->x1}, ys[4] = {s->y0, s->y0, s->y1, s->y1};
    const struct orl_tile_pixel *middle = orl_tile_pixel_at(tile_state, x, y);
    if (middle->shaded.textured)
        return false;
    for (int i = 0; i < 4; i++)
        if (!orl_tile_pixel_at(tile_state, xs[i], ys[i])->there ||
            orl_tile_pixel_at(tile_state, xs[i], ys[i])->path_signature != middle->path_signature)
            return false;
    double least = INFINITY, most = 0, sum = 0;
    for (int i = 0; i < 4; i++) {
        make_exact(tile_state, xs[i], ys[i]);
        const double corner =
            orl_luma(orl_tile_pixel_at(tile_state, xs[i], ys[i])->smooth.radiance);
        least = fmin(least, corner);
        most = fmax(most, corner);
        sum += corner;
    }
    if (most - least > steep * sum / 4)
        return false;
    make_exact(tile_state, x, y);
    const struct orl_smooth_lighting guess =
        interpolate_corners(tile_state, s, share_of(x, s->x0, s->x1), share_of(y, s->y0, s->y1));
    const double luma = orl_luma(middle->smooth.radiance);
    const double all = luma + orl_luma(middle->rest) + orl_luma(middle->direct);
    const double error = hypot(middle->smooth.rest_error, middle->smooth.caustic_error);
    return fabs(orl_luma(guess.radiance) - luma) <=
           fmax(smooth_tolerance * all, fmin(error, most_tolerance * all));
}

static void interpolate_square(const struct orl_adaptive_tile *tile_state, const struct square *s)
{
    const uint64_t path_signature = orl_tile_pixel_at(tile_state, s->x0, s->y0)->path_signature;
    for (int y = s->y0; y <= s->y1; y++) {
        for (int x = s->x0; x <= s->x1; x++) {
            struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
            if (tile_pixel->made)
                continue;
            if (tile_pixel->path_signature != path_signature) {
                make_exact(tile_state, x, y);
                continue;
            }
            tile_pixel->smooth = interpolate_corners(tile_state, s, share_of(x, s->x0, s->x1),
                                                     share_of(y, s->y0, s->y1));
            tile_pixel->made = true;
        }
    }
}

static void fill_square(const struct orl_adaptive_tile *tile_state, const struct square *s)
{
    const int x = (s->x0 + s->x1) / 2, y = (s->y0 + s->y1) / 2;
    const bool wide = s->x1 - s->x0 > 1, high = s->y1 - s->y0 > 1;
    if (!wide && !high) {
        make_exact(tile_state, s->x0, s->y0);
        make_exact(tile_state, s->x1, s->y0);
        make_exact(tile_state, s->x0, s->y1);
        make_exact(tile_state, s->x1, s->y1);
        return;
    }
    if (is_smooth(tile_state, s)) {
        interpolate_square(tile_state, s);
        return;
    }
    fill_square(tile_state, &(struct square){s->x0, s->y0, wide ? x : s->x1, high ? y : s->y1});
    if (wide)
        fill_square(tile_state, &(struct square){x, s->y0, s->x1, high ? y : s->y1});
    if (high)
        fill_square(tile_state, &(struct square){s->x0, y, wide ? x : s->x1, s->y1});
    if (wide && high)
        fill_square(tile_state, &(struct square){x, y, s->x1, s->y1});
}

static int smaller_of(int a, int b)
{
    return a < b ? a : b;
}

/* Performs the second step: computes the smooth part at all pixels of the tile. Squares share their
 * corners, also with those of neighbouring tiles: hence the margin. */
static void orl_tile_compute_smooth(const struct orl_adaptive_tile *tile_state)
{
    const int last_x = orl_tile_pixel_at(tile_state, tile_state->width, 0)->there
                           ? tile_state->width
                           : tile_state->width - 1;
    const int last_y = orl_tile_pixel_at(tile_state, 0, tile_state->height)->there
                           ? tile_state->height
                           : tile_state->height - 1;
    for (int y = 0; y < tile_state->height; y += WIDEST)
        for (int x = 0; x < tile_state->width; x += WIDEST)
            fill_square(tile_state, &(struct square){x, y, smaller_of(x + WIDEST, last_x),
                                                     smaller_of(y + WIDEST, last_y)});
}

/* ---- Gloss ----------------------------------------------------------------------------------- */

/* Tolerated noise of a pixel's gloss, as a share of the pixel. It is computed as if rays were
 * random; they are stratified, so that the noise is about half of that. */
static const double gloss_tolerance = 0.04;

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
    const uint64_t path_signature = orl_tile_pixel_at(tile_state, x, y)->path_signature;
    struct gloss_statistics heard = {.count = 0};
    for (int v = y - ABOUT; v <= y + ABOUT; v++) {
        for (int u = x - ABOUT; u <= x + ABOUT; u++) {
            if ((u == x && v == y) || !orl_tile_contains(tile_state, u, v))
                continue;
            const struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, u, v);
            if (!tile_pixel->shaded.has_lobes ||
                (same && tile_pixel->path_signature != path_signature))
                continue;
            heard.variance += tile_pixel->shaded.gloss_variance;
            heard.luma += orl_luma(radiance_of(tile_pixel));
            heard.count++;
        }
    }
    return heard;
}

/* Returns the number of additional rays, by the noise of the pixels about. The pixel's own rays do
 * not decide: if few surfaces are bright, rays that missed them would show too little noise. */
static uint32_t more_for(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    struct gloss_statistics heard = collect_gloss(tile_state, x, y, true);
    if (heard.count < FEWEST_ABOUT)
        heard = collect_gloss(tile_state, x, y, false);
    if (heard.count == 0)
        return LEAST_MORE;
    const double luma = heard.luma / heard.count, allowed = gloss_tolerance * luma;
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

/* Performs the third step: sends more rays for gloss that would be noisy. */
static void orl_tile_refine_gloss(const struct orl_adaptive_tile *tile_state)
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

/* ---- The tile -------------------------------------------------------------------------------- */

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
    tile_pixel->path_signature = 0;
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
    tile_pixel->path_signature = tile_pixel->shaded.path_signature;
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
        .tile_pixels = calloc(ORL_TILE_SIDE_WITH_MARGIN, sizeof *tile_state.tile_pixels),
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
