#include "render/image/adaptive_tile_pixels.h"

/* Width of the largest squares, in pixels. */
enum { WIDEST = 8 };

/* Tolerated interpolation error: the first share of the pixel, or its standard error, but at most
 * the second share. */
static const double tolerance = 0.02, most_tolerance = 0.06;

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
            orl_tile_pixel_at(tile_state, xs[i], ys[i])->way != middle->way)
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
           fmax(tolerance * all, fmin(error, most_tolerance * all));
}

static void interpolate_square(const struct orl_adaptive_tile *tile_state, const struct square *s)
{
    const uint64_t way = orl_tile_pixel_at(tile_state, s->x0, s->y0)->way;
    for (int y = s->y0; y <= s->y1; y++) {
        for (int x = s->x0; x <= s->x1; x++) {
            struct orl_tile_pixel *tile_pixel = orl_tile_pixel_at(tile_state, x, y);
            if (tile_pixel->made)
                continue;
            if (tile_pixel->way != way) {
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

/* Squares share their corners, also with those of neighbouring tiles: hence the margin. */
void orl_tile_compute_smooth(const struct orl_adaptive_tile *tile_state)
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
