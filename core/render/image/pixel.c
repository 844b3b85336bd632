#include "render/image/pixel.h"

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
