#include "render/image/pixel.h"

enum { SIDE = 4 };

/* Rays that differ by no more than this share of their mean agree. */
static const double even_enough = 0.15;

void orl_pixel_place(uint32_t ray, double *ret_x, double *ret_y)
{
    static const uint8_t order[ORL_PIXEL_RAYS] = {1, 7, 8, 14, 2, 4, 11, 13,
                                                  0, 6, 9, 15, 3, 5, 10, 12};
    static const uint8_t across[SIDE] = {1, 3, 0, 2}, down[SIDE] = {2, 0, 3, 1};
    const uint32_t column = order[ray] % SIDE, row = order[ray] / SIDE;
    *ret_x = (column + (across[row] + 0.5) / SIDE) / SIDE;
    *ret_y = (row + (down[column] + 0.5) / SIDE) / SIDE;
}

void orl_pixel_add(struct orl_pixel_rays *tally, const struct orl_shade *shade)
{
    const double luma = orl_luma(shade->radiance);
    tally->sum = orl_rgb_add(tally->sum, shade->radiance);
    tally->squares += luma * luma;
    tally->least = tally->rays == 0 ? luma : fmin(tally->least, luma);
    tally->most = fmax(tally->most, luma);
    tally->rest_error += shade->rest_error;
    tally->caustic_error += shade->caustic_error;
    tally->ray_error += shade->ray_error;
    tally->rays++;
}

bool orl_pixel_is_uneven(const struct orl_pixel_rays *tally)
{
    return tally->most - tally->least > even_enough * orl_luma(tally->sum) / tally->rays;
}

struct orl_pixel orl_pixel_settle(const struct orl_pixel_rays *tally)
{
    const double n = tally->rays, mean = orl_luma(tally->sum) / n;
    const double spread = tally->rays > 1 ? fmax(tally->squares / n - mean * mean, 0) / (n - 1) : 0;
    const double rest = tally->rest_error / n, caustic = tally->caustic_error / n;
    const double rays = tally->ray_error / n;
    return (struct orl_pixel){orl_rgb_scale(tally->sum, 1 / n),
                              sqrt(spread + rest * rest + caustic * caustic + rays * rays)};
}
