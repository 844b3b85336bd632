#include "render/picture/acuity.h"

#include <stdlib.h>

#include "render/picture/tonemap_ward_larson.h"

/* Makes a level from the finer one: means of two by two pixels, of fewer at the edges. */
static int halve_level(struct orl_blur *blur, int level)
{
    const uint32_t w = blur->levels[level - 1].width, h = blur->levels[level - 1].height;
    float(*const from)[3] = blur->levels[level - 1].pixels;
    const uint32_t width = (w + 1) / 2, height = (h + 1) / 2;
    float(*to)[3] = calloc((size_t)width * height, sizeof *to);
    blur->levels[level].width = width;
    blur->levels[level].height = height;
    blur->levels[level].pixels = to;
    if (!to)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const uint32_t x0 = 2 * x, x1 = x0 + 1 < w ? x0 + 1 : x0;
            const uint32_t y0 = 2 * y, y1 = y0 + 1 < h ? y0 + 1 : y0;
            for (int c = 0; c < 3; c++)
                to[(size_t)y * width + x][c] =
                    0.25F * (from[(size_t)y0 * w + x0][c] + from[(size_t)y0 * w + x1][c] +
                             from[(size_t)y1 * w + x0][c] + from[(size_t)y1 * w + x1][c]);
        }
    return 0;
}

int orl_blur_init(struct orl_blur *blur, const struct orl_film *film, const struct orl_view *view)
{
    double across, down;
    orl_view_degrees(view, &across, &down);
    *blur = (struct orl_blur){.film = film, .pixels_a_degree = film->width / across, .n_levels = 1};
    blur->levels[0].width = film->width;
    blur->levels[0].height = film->height;
    blur->levels[0].pixels = film->pixels;
    /* The coarsest level resolves two cycles a degree, the least acuity. */
    while (exp2(blur->n_levels - 1) < blur->pixels_a_degree && blur->n_levels < ORL_ACUITY_LEVELS)
        if (halve_level(blur, blur->n_levels++) < 0)
            return ORL_ERR_NOMEM;
    return 0;
}

void orl_blur_done(struct orl_blur *blur)
{
    for (int i = 1; i < blur->n_levels; i++)
        free(blur->levels[i].pixels);
    blur->n_levels = 0;
}

/* Interpolates between the pixels of a level. */
static void read_level(const struct orl_blur *blur, int level, double x, double y, double ret[3])
{
    const uint32_t w = blur->levels[level].width, h = blur->levels[level].height;
    const double scale = exp2(-level);
    const double px = fmin(fmax(x * scale - 0.5, 0), w - 1.0);
    const double py = fmin(fmax(y * scale - 0.5, 0), h - 1.0);
    const uint32_t x0 = (uint32_t)px, x1 = x0 + 1 < w ? x0 + 1 : x0;
    const uint32_t y0 = (uint32_t)py, y1 = y0 + 1 < h ? y0 + 1 : y0;
    const double u = px - x0, v = py - y0;
    float(*const from)[3] = blur->levels[level].pixels;
    for (int c = 0; c < 3; c++) {
        const double a = (1 - u) * (double)from[(size_t)y0 * w + x0][c] +
                         u * (double)from[(size_t)y0 * w + x1][c];
        const double b = (1 - u) * (double)from[(size_t)y1 * w + x0][c] +
                         u * (double)from[(size_t)y1 * w + x1][c];
        ret[c] = (1 - v) * a + v * b;
    }
}

void orl_blur_at(const struct orl_blur *blur, const struct orl_fovea *fovea, uint32_t x, uint32_t y,
                 float ret_rgb[3])
{
    float about[3];
    double fine[3], coarse[3];
    orl_fovea_at(fovea, (x + 0.5) / blur->film->width, (y + 0.5) / blur->film->height, about);
    /* Half a cycle is the smallest visible detail. */
    const double pixels = blur->pixels_a_degree / (2 * orl_acuity(orl_luminance(about)));
    const double level = fmin(fmax(log2(pixels), 0), blur->n_levels - 1.0);
    const int low = (int)level, high = low + 1 < blur->n_levels ? low + 1 : low;
    read_level(blur, low, x + 0.5, y + 0.5, fine);
    read_level(blur, high, x + 0.5, y + 0.5, coarse);
    for (int c = 0; c < 3; c++)
        ret_rgb[c] = (float)(fine[c] + (level - low) * (coarse[c] - fine[c]));
}
