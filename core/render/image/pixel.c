/* Rays of a pixel: their positions, their mean and its error; and the ray through one point of a
 * pixel. */
#include "render/image/adaptive_tile.h"

enum { SIDE = 4 };

/* Rays that differ by at most this share of their mean agree. */
static const double even_enough = 0.15;

/* Rays that differ by more than this multiple of their mean are too few. */
static const double stark = 0.6;

/* Sets the position of a ray after the usual ones: one column for each, heights by the golden
 * ratio. */
static void place_more(uint32_t ray, double *ret_x, double *ret_y)
{
    static const double golden = 0.61803398874989485;
    const uint32_t i = ray - ORL_PIXEL_RAYS;
    *ret_x = (i + 0.5) / (ORL_PIXEL_MOST_RAYS - ORL_PIXEL_RAYS);
    *ret_y = fmod(0.5 + i * golden, 1);
}

void orl_pixel_ray_position(uint32_t ray, double *ret_x, double *ret_y)
{
    static const uint8_t order[ORL_PIXEL_RAYS] = {1, 7, 8, 14, 2, 4, 11, 13,
                                                  0, 6, 9, 15, 3, 5, 10, 12};
    static const uint8_t across[SIDE] = {1, 3, 0, 2}, down[SIDE] = {2, 0, 3, 1};
    if (ray >= ORL_PIXEL_RAYS) {
        place_more(ray, ret_x, ret_y);
        return;
    }
    const uint32_t column = order[ray] % SIDE, row = order[ray] / SIDE;
    *ret_x = (column + (across[row] + 0.5) / SIDE) / SIDE;
    *ret_y = (row + (down[column] + 0.5) / SIDE) / SIDE;
}

void orl_pixel_add(struct orl_pixel_rays *tally, const struct orl_ray_radiance *ray_radiance)
{
    const double luma = orl_luma(ray_radiance->radiance);
    tally->sum = orl_rgb_add(tally->sum, ray_radiance->radiance);
    tally->squares += luma * luma;
    tally->least = tally->rays == 0 ? luma : fmin(tally->least, luma);
    tally->most = fmax(tally->most, luma);
    tally->rest_error += ray_radiance->rest_error;
    tally->caustic_error += ray_radiance->caustic_error;
    tally->ray_error += ray_radiance->ray_error;
    tally->rays++;
}

uint32_t orl_pixel_rays_needed(const struct orl_pixel_rays *tally)
{
    const double spread = tally->most - tally->least, mean = orl_luma(tally->sum) / tally->rays;
    if (tally->rays > ORL_PIXEL_RAYS)
        return ORL_PIXEL_MOST_RAYS;
    if (!(spread > even_enough * mean))
        return ORL_PIXEL_FIRST_RAYS;
    return tally->rays == ORL_PIXEL_RAYS && spread > stark * mean ? ORL_PIXEL_MOST_RAYS
                                                                  : ORL_PIXEL_RAYS;
}

struct orl_pixel orl_pixel_resolve(const struct orl_pixel_rays *tally)
{
    const double n = tally->rays, mean = orl_luma(tally->sum) / n;
    const double spread = tally->rays > 1 ? fmax(tally->squares / n - mean * mean, 0) / (n - 1) : 0;
    const double rest = tally->rest_error / n, caustic = tally->caustic_error / n;
    const double rays = tally->ray_error / n;
    return (struct orl_pixel){orl_rgb_scale(tally->sum, 1 / n),
                              sqrt(spread + rest * rest + caustic * caustic + rays * rays)};
}

/* Returns the largest number of additional gloss rays among a pixel and its neighbours. */
static uint32_t wanted_about(const struct orl_adaptive_tile *tile_state, int x, int y)
{
    uint32_t most = 0;
    for (int i = 0; i < 9; i++) {
        const int u = x + i % 3 - 1, v = y + i / 3 - 1;
        if (orl_tile_contains(tile_state, u, v) && orl_tile_pixel_at(tile_state, u, v)->more > most)
            most = orl_tile_pixel_at(tile_state, u, v)->more;
    }
    return most;
}

/* Sets up one of several view rays through a pixel, which share the points of one sequence. */
static void share_lobes(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const struct orl_lobe_share *share, struct orl_shader *shader)
{
    const uint64_t name =
        orl_mix64(tile_state->painter->seed * 7 + orl_tile_pixel_index(tile_state, x, y));
    shader->pane_samples = (shader->pane_samples + share->of - 1) / share->of;
    shader->gloss_samples = (shader->gloss_samples + share->of - 1) / share->of +
                            wanted_about(tile_state, x, y) / ORL_PIXEL_RAYS;
    shader->sequence = (uint32_t)(name >> 32) | 1;
    shader->first_gloss = share->look * shader->gloss_samples;
}

bool orl_tile_trace_ray(const struct orl_adaptive_tile *tile_state, int x, int y,
                        const double place[2], struct orl_lobe_share share,
                        struct orl_random *random, struct orl_shaded_ray *ret_shaded)
{
    const struct orl_tile_painter *painter = tile_state->painter;
    struct orl_shader shader = painter->shader;
    struct orl_vec3 origin, direction;
    if (!orl_paint_ray(painter->painting, (double)tile_state->tile->x0 + x + place[0],
                       (double)tile_state->tile->y0 + y + place[1], &origin, &direction))
        return false;
    if (share.of > 1)
        share_lobes(tile_state, x, y, &share, &shader);
    orl_shade_ray(&shader, origin, direction, painter->outside, share.of > 0, random,
                  tile_state->search, ret_shaded);
    ret_shaded->rest = orl_health_filter(&tile_state->search->health, ret_shaded->rest);
    ret_shaded->lobes = orl_health_filter(&tile_state->search->health, ret_shaded->lobes);
    return true;
}
