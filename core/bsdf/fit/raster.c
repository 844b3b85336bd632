/* Raster of directions out, to which Gaussians of light are added. */
#include "bsdf/fit/fit.h"

#include <stdlib.h>
#include <string.h>

#include "base/multiversion.h"
#include "bsdf/fit/scan/scan_light.h"

enum { TILE_POINTS = ORL_FIT_TILE_CELLS * ORL_FIT_CELL_POINTS, TILES_GROUPED = 16 };

/* ---- Making it ------------------------------------------------------------------------------- */

/* Sets sample points in Morton order on the square of projected solid angles. */
static void set_points(struct orl_fit_raster *s, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 d = orl_morton_direction((uint32_t)i, s->levels + 2, 0.5, 0.5);
        s->x[i] = (float)d.x;
        s->y[i] = (float)d.y;
        s->z[i] = (float)d.z;
    }
}

/* Returns a bounding sphere of consecutive points. */
static struct orl_fit_sphere sphere_of(const struct orl_fit_raster *s, size_t first, size_t count)
{
    struct orl_vec3 sum = {0};
    double radius = 0;
    for (size_t i = first; i < first + count; i++)
        sum = orl_add(sum, orl_v3((double)s->x[i], (double)s->y[i], (double)s->z[i]));
    sum = orl_normalize(sum);
    for (size_t i = first; i < first + count; i++)
        radius = fmax(radius, orl_length(orl_sub(
                                  orl_v3((double)s->x[i], (double)s->y[i], (double)s->z[i]), sum)));
    return (struct orl_fit_sphere){(float)sum.x, (float)sum.y, (float)sum.z,
                                   (float)(radius * 1.001)};
}

static void set_spheres(struct orl_fit_raster *s)
{
    for (size_t t = 0; t < s->n_tiles; t++)
        s->tiles[t] = sphere_of(s, t * TILE_POINTS, TILE_POINTS);
    for (size_t t = 0; t < s->n_tiles; t += TILES_GROUPED) {
        const size_t tiles = s->n_tiles - t < TILES_GROUPED ? s->n_tiles - t : TILES_GROUPED;
        s->groups[t / TILES_GROUPED] = sphere_of(s, t * TILE_POINTS, tiles * TILE_POINTS);
    }
}

int orl_fit_raster_make(unsigned levels, struct orl_fit_raster *ret_raster, struct orl_error *err)
{
    const size_t cells = (size_t)1 << 2 * levels, points = cells * ORL_FIT_CELL_POINTS;
    struct orl_fit_raster s = {
        .levels = levels, .n_cells = cells, .n_tiles = cells / ORL_FIT_TILE_CELLS};
    s.area = ORL_PI / (double)cells;
    s.spacing = sqrt(ORL_PI / (double)points);
    s.x = malloc(3 * points * sizeof *s.x);
    s.tiles = malloc(s.n_tiles * sizeof *s.tiles);
    s.groups = malloc((s.n_tiles / TILES_GROUPED + 1) * sizeof *s.groups);
    if (!s.x || !s.tiles || !s.groups) {
        orl_fit_raster_done(&s);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for exit directions");
    }
    s.y = s.x + points;
    s.z = s.y + points;
    set_points(&s, points);
    set_spheres(&s);
    *ret_raster = s;
    return 0;
}

void orl_fit_raster_done(struct orl_fit_raster *raster)
{
    free(raster->x);
    free(raster->tiles);
    free(raster->groups);
    memset(raster, 0, sizeof *raster);
}

bool orl_fit_accumulator_make(const struct orl_fit_raster *raster,
                              struct orl_fit_accumulator *ret_accumulator)
{
    struct orl_fit_accumulator accumulator = {
        .accumulated = malloc(raster->n_tiles * sizeof *accumulator.accumulated),
        .tiles = malloc(raster->n_tiles * sizeof *accumulator.tiles),
        .value = malloc(raster->n_cells * sizeof *accumulator.value)};
    *ret_accumulator = accumulator;
    if (accumulator.accumulated && accumulator.tiles && accumulator.value)
        return true;
    orl_fit_accumulator_done(ret_accumulator);
    return false;
}

void orl_fit_accumulator_done(struct orl_fit_accumulator *accumulator)
{
    free(accumulator->accumulated);
    free(accumulator->tiles);
    free(accumulator->value);
    memset(accumulator, 0, sizeof *accumulator);
}

/* ---- Rasterising ----------------------------------------------------------------------------- */

static const double end_of_sigma2 = 12; /* squared radius of the kernel, in squared sigmas */
/* Gaussians whose kernel radius is below this many point distances use points of their own. */
static const double least_points = 2.5;

/* Sums the kernel of a Gaussian (x, y, z, 1 / squared radius) over the points of a tile's cells.
 * With fold, adds the kernel of its image below the horizon. The sixteen terms of a cell are added
 * in a fixed order. */
ORL_FOR_WIDE_VECTORS
static double accumulate_tile(const struct orl_fit_raster *s, size_t tile, const float gaussian[4],
                              bool fold, float accumulated[ORL_FIT_TILE_CELLS])
{
    double all = 0;
    for (size_t cell = 0; cell < ORL_FIT_TILE_CELLS; cell++) {
        const size_t first = tile * TILE_POINTS + cell * ORL_FIT_CELL_POINTS;
        const float *x = s->x + first, *y = s->y + first, *z = s->z + first;
        float sums[ORL_FIT_CELL_POINTS];
        for (int i = 0; i < ORL_FIT_CELL_POINTS; i++) {
            const float dx = x[i] - gaussian[0], dy = y[i] - gaussian[1], dz = z[i] - gaussian[2];
            const float q = 1 - (dx * dx + dy * dy + dz * dz) * gaussian[3], p = q > 0 ? q : 0;
            sums[i] = (p * p) * (p * p);
        }
        for (int i = 0; i < ORL_FIT_CELL_POINTS && fold; i++) {
            const float dx = x[i] - gaussian[0], dy = y[i] - gaussian[1], up = z[i] + gaussian[2];
            const float q = 1 - (dx * dx + dy * dy + up * up) * gaussian[3], p = q > 0 ? q : 0;
            sums[i] += (p * p) * (p * p);
        }
        for (int half = ORL_FIT_CELL_POINTS / 2; half > 0; half /= 2)
            for (int i = 0; i < half; i++)
                sums[i] += sums[i + half];
        accumulated[cell] = sums[0];
        all += (double)sums[0];
    }
    return all;
}

static bool reaches(const struct orl_fit_sphere *sphere, const float gaussian[4], float end)
{
    const float dx = sphere->x - gaussian[0], dy = sphere->y - gaussian[1],
                dz = sphere->z - gaussian[2];
    const float up = sphere->z + gaussian[2], flat = dx * dx + dy * dy, most = end + sphere->radius;
    return flat + dz * dz < most * most || flat + up * up < most * most;
}

static size_t cell_of(const struct orl_fit_raster *s, struct orl_vec3 d)
{
    const struct orl_square q = orl_disk_to_square(d.x, d.y);
    const uint32_t side = 1U << s->levels;
    return orl_morton_spread(orl_square_index(q.x, side)) |
           orl_morton_spread(orl_square_index(q.y, side)) << 1;
}

/* Adds a Gaussian that is too narrow for the sample points, by points of its own that are closer
 * together. */
static void splat_points(const struct orl_fit_raster *s, const struct orl_fit_gaussian *gaussian,
                         double sigma, struct orl_fit_accumulator *accumulator)
{
    enum { MOST = 6, POINTS = (2 * MOST + 1) * (2 * MOST + 1) };
    const double wanted = ceil(3 * sigma / (0.8 * s->spacing));
    const int reach = wanted < MOST ? (int)wanted : MOST, side = 2 * reach + 1;
    const double step = reach > 0 ? 3 * sigma / reach : 0;
    const struct orl_frame frame =
        orl_frame_about(orl_v3((double)gaussian->x, (double)gaussian->y, (double)gaussian->z));
    size_t cells[POINTS];
    double weights[POINTS], sum = 0;
    for (int i = 0; i < side * side; i++) {
        const int row = i / side;
        const double u = step * (i % side - reach), v = step * (row - reach);
        const double q = 1 - (u * u + v * v) / (end_of_sigma2 * sigma * sigma), p = q > 0 ? q : 0;
        struct orl_vec3 at = orl_normalize(orl_to_world(&frame, orl_v3(u, v, 1)));
        at.z = fabs(at.z);
        cells[i] = cell_of(s, at);
        weights[i] = (p * p) * (p * p) * (at.z + 1e-6);
        sum += weights[i];
    }
    for (int i = 0; i < side * side; i++)
        accumulator->value[cells[i]] += weights[i] / sum * (double)gaussian->mass / s->area;
}

static void splat_gaussian(const struct orl_fit_raster *s, const struct orl_fit_gaussian *gaussian,
                           double sigma, struct orl_fit_accumulator *accumulator)
{
    const double end = sqrt(end_of_sigma2) * sigma;
    const float kernel[4] = {gaussian->x, gaussian->y, gaussian->z, (float)(1 / (end * end))};
    const bool fold = (double)gaussian->z < end;
    size_t reached = 0;
    double sum = 0;
    for (size_t t = 0; t < s->n_tiles; t++) {
        if (t % TILES_GROUPED == 0 && !reaches(&s->groups[t / TILES_GROUPED], kernel, (float)end)) {
            t += TILES_GROUPED - 1;
            continue;
        }
        if (!reaches(&s->tiles[t], kernel, (float)end))
            continue;
        sum += accumulate_tile(s, t, kernel, fold, accumulator->accumulated[reached]);
        accumulator->tiles[reached++] = (uint32_t)t;
    }
    if (!(sum > 0)) {
        splat_points(s, gaussian, sigma, accumulator);
        return;
    }
    const double scale = (double)gaussian->mass / (sum * s->area);
    for (size_t k = 0; k < reached; k++)
        for (size_t c = 0; c < ORL_FIT_TILE_CELLS; c++)
            accumulator->value[(size_t)accumulator->tiles[k] * ORL_FIT_TILE_CELLS + c] +=
                scale * (double)accumulator->accumulated[k][c];
}

void orl_fit_rasterize(const struct orl_fit_raster *raster, const struct orl_fit_light *light,
                       double blur_rad, struct orl_fit_accumulator *accumulator)
{
    for (size_t i = 0; i < raster->n_cells; i++)
        accumulator->value[i] = light->floor;
    for (size_t i = 0; i < light->n; i++) {
        const struct orl_fit_gaussian *gaussian = &light->gaussians[i];
        const double sigma = hypot((double)gaussian->sigma_rad, blur_rad);
        /* Towards the horizon, points are farther apart as seen from the surface. */
        if (sigma * sqrt(end_of_sigma2) * orl_larger(0.1, (double)gaussian->z) <
            least_points * raster->spacing)
            splat_points(raster, gaussian, sigma, accumulator);
        else
            splat_gaussian(raster, gaussian, sigma, accumulator);
    }
}
