#include "render/picture/display.h"

#include <stdlib.h>

#include <oriel/base/vec.h>

/* Share of the light that the eye scatters (the 0.087 of Holladay's formula, less the part that
 * falls beyond the picture; as in Radiance's pcond). */
static const double scattered = 0.08;

void orl_view_degrees(const struct orl_view *view, double *ret_width, double *ret_height)
{
    const double assumed = 40;
    *ret_width = view->horizontal;
    *ret_height = view->vertical;
    if (view->type == 'v') {
        *ret_width = orl_length(view->h) / ORL_DEG_TO_RAD;
        *ret_height = orl_length(view->v) / ORL_DEG_TO_RAD;
    } else if (view->type == 'l') {
        *ret_width = assumed;
        *ret_height = assumed * view->vertical / view->horizontal;
    }
}

static uint32_t side_of(double degrees, uint32_t pixels)
{
    const double most = pixels < ORL_FOVEA_SIDE ? pixels : ORL_FOVEA_SIDE;
    return (uint32_t)fmax(fmin(round(degrees), most), 1);
}

/* Returns the first pixel of sample i of n. */
static uint32_t edge_of(uint32_t i, uint32_t n, uint32_t pixels)
{
    return (uint32_t)((uint64_t)i * pixels / n);
}

static void average_sample(const struct orl_film *film, struct orl_fovea *fovea, uint32_t x,
                           uint32_t y)
{
    const uint32_t x0 = edge_of(x, fovea->width, film->width);
    const uint32_t x1 = edge_of(x + 1, fovea->width, film->width);
    const uint32_t y0 = edge_of(y, fovea->height, film->height);
    const uint32_t y1 = edge_of(y + 1, fovea->height, film->height);
    double sum[3] = {0};
    for (uint32_t v = y0; v < y1; v++)
        for (uint32_t u = x0; u < x1; u++)
            for (int c = 0; c < 3; c++)
                sum[c] += (double)film->pixels[(size_t)v * film->width + u][c];
    for (int c = 0; c < 3; c++)
        fovea->pixels[(size_t)y * fovea->width + x][c] =
            (float)(sum[c] / ((double)(x1 - x0) * (y1 - y0)));
}

int orl_fovea_init(struct orl_fovea *fovea, const struct orl_film *film,
                   const struct orl_view *view)
{
    double across, down;
    orl_view_degrees(view, &across, &down);
    *fovea = (struct orl_fovea){.width = side_of(across, film->width),
                                .height = side_of(down, film->height)};
    fovea->pixels = calloc((size_t)fovea->width * fovea->height, sizeof *fovea->pixels);
    if (!fovea->pixels)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < fovea->height; y++)
        for (uint32_t x = 0; x < fovea->width; x++)
            average_sample(film, fovea, x, y);
    return 0;
}

void orl_fovea_done(struct orl_fovea *fovea)
{
    free(fovea->pixels);
    free(fovea->veiling);
    *fovea = (struct orl_fovea){.width = 0};
}

/* ---- Veil ------------------------------------------------------------------------------------ */

/* Returns the directions of the samples, zero where the view shows nothing; NULL if out of memory.
 * The caller frees them. */
static struct orl_vec3 *list_directions(const struct orl_fovea *fovea, const struct orl_view *view)
{
    struct orl_vec3 *ways = calloc((size_t)fovea->width * fovea->height, sizeof *ways);
    for (uint32_t y = 0; ways && y < fovea->height; y++)
        for (uint32_t x = 0; x < fovea->width; x++) {
            struct orl_vec3 origin, way;
            if (orl_view_ray(view, (x + 0.5) / fovea->width, 1 - (y + 0.5) / fovea->height, &origin,
                             &way))
                ways[(size_t)y * fovea->width + x] = way;
        }
    return ways;
}

/* Computes the light scattered into a sample from all others. Their weight is cos t / t^2, with t^2
 * approximated by twice the versine of t. */
static void scatter_into(struct orl_fovea *fovea, const struct orl_vec3 *ways, size_t at)
{
    const size_t n = (size_t)fovea->width * fovea->height;
    double sum[3] = {0}, weights = 0;
    for (size_t i = 0; i < n; i++) {
        const double cosine = orl_dot(ways[at], ways[i]);
        if (i == at || cosine <= 0)
            continue;
        const double weight = cosine / fmax(2 * (1 - cosine), 1e-9);
        for (int c = 0; c < 3; c++)
            sum[c] += weight * (double)fovea->pixels[i][c];
        weights += weight;
    }
    for (int c = 0; c < 3; c++)
        fovea->veiling[at][c] = weights > 0 ? (float)(scattered * sum[c] / weights) : 0;
}

int orl_fovea_add_veiling(struct orl_fovea *fovea, const struct orl_view *view)
{
    const size_t n = (size_t)fovea->width * fovea->height;
    struct orl_vec3 *ways = list_directions(fovea, view);
    fovea->veiling = calloc(n, sizeof *fovea->veiling);
    if (ways && fovea->veiling) {
        for (size_t i = 0; i < n; i++)
            scatter_into(fovea, ways, i);
        for (size_t i = 0; i < n; i++)
            for (int c = 0; c < 3; c++)
                fovea->pixels[i][c] =
                    (float)((1 - scattered) * (double)fovea->pixels[i][c]) + fovea->veiling[i][c];
    }
    free(ways);
    return ways && fovea->veiling ? 0 : ORL_ERR_NOMEM;
}

/* Returns the samples and weights about a position along one side. */
static void locate_samples(double at, uint32_t count, uint32_t *ret_low, uint32_t *ret_high,
                           double *ret_share)
{
    const double place = fmin(fmax(at * count - 0.5, 0), count - 1.0);
    *ret_low = (uint32_t)place;
    *ret_high = *ret_low + 1 < count ? *ret_low + 1 : *ret_low;
    *ret_share = place - *ret_low;
}

static void interpolate(const struct orl_fovea *fovea, float (*const samples)[3], double x,
                        double y, float ret_rgb[3])
{
    uint32_t x0, x1, y0, y1;
    double u, v;
    locate_samples(x, fovea->width, &x0, &x1, &u);
    locate_samples(y, fovea->height, &y0, &y1, &v);
    const size_t upper = (size_t)y0 * fovea->width, lower = (size_t)y1 * fovea->width;
    for (int c = 0; c < 3; c++) {
        const double a =
            (1 - u) * (double)samples[upper + x0][c] + u * (double)samples[upper + x1][c];
        const double b =
            (1 - u) * (double)samples[lower + x0][c] + u * (double)samples[lower + x1][c];
        ret_rgb[c] = (float)((1 - v) * a + v * b);
    }
}

void orl_fovea_mix_veiling(const struct orl_fovea *fovea, double x, double y, float rgb[3])
{
    float veiling[3];
    interpolate(fovea, fovea->veiling, x, y, veiling);
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)((1 - scattered) * (double)rgb[c]) + veiling[c];
}

void orl_fovea_at(const struct orl_fovea *fovea, double x, double y, float ret_rgb[3])
{
    interpolate(fovea, fovea->pixels, x, y, ret_rgb);
}
