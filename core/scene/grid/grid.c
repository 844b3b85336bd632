#include "scene/grid/grid.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include <oriel/base/limits.h>

void orl_grid_free(struct orl_grid *grid)
{
    if (!grid)
        return;
    for (uint32_t i = 0; i < ORL_GRID_AXES; i++)
        free(grid->axes[i].places);
    free(grid->values);
    free(grid);
}

size_t orl_grid_bytes(const struct orl_grid *grid)
{
    size_t bytes = sizeof *grid + grid->n_values * sizeof *grid->values;
    for (uint32_t i = 0; i < grid->n_axes; i++)
        bytes += grid->axes[i].places ? grid->axes[i].n * sizeof(double) : 0;
    return bytes;
}

/* ---- Interpolation --------------------------------------------------------------------------- */

/* Two neighbours on an axis, and the weights of their values. */
struct neighbours {
    uint32_t first;
    double share[2];
};

/* Returns the interval of unevenly spaced points that holds x, or the nearest one. */
static uint32_t interval_of(const struct orl_grid_axis *axis, double x)
{
    uint32_t low = 0, high = axis->n - 1;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if ((axis->places[middle] <= x) == (axis->size > 0))
            low = middle;
        else
            high = middle;
    }
    return low;
}

static struct neighbours neighbours_of(const struct orl_grid_axis *axis, double x)
{
    struct neighbours n;
    double t; /* position between the first point (0) and the second (1) */
    if (axis->places) {
        n.first = interval_of(axis, x);
        const double a = axis->places[n.first], b = axis->places[n.first + 1];
        t = (x - a) / (b - a);
    } else {
        const double at = (x - axis->origin) / axis->size * (axis->n - 1);
        n.first = at > 0 ? (at < axis->n - 2 ? (uint32_t)at : axis->n - 2) : 0;
        t = at - n.first;
    }
    if (t > 2) {
        n.share[0] = -1 / (t + 1);
        n.share[1] = 2 / (t + 1);
    } else if (t < -1) {
        n.share[1] = 1 / t;
        n.share[0] = -2 / t;
    } else {
        n.share[0] = 1 - t;
        n.share[1] = t;
    }
    return n;
}

void orl_grid_at(const struct orl_grid *grid, const double *place,
                 double ret_values[ORL_GRID_CHANNELS])
{
    struct neighbours around[ORL_GRID_AXES];
    for (uint32_t i = 0; i < grid->n_axes; i++)
        around[i] = neighbours_of(&grid->axes[i], place[i]);
    for (uint32_t c = 0; c < grid->channels; c++)
        ret_values[c] = 0;
    for (uint32_t corner = 0; corner < 1U << grid->n_axes; corner++) {
        size_t at = 0;
        double share = 1;
        for (uint32_t i = 0; i < grid->n_axes; i++) {
            const uint32_t side = corner >> i & 1;
            at = at * grid->axes[i].n + around[i].first + side;
            share *= around[i].share[side];
        }
        for (uint32_t c = 0; c < grid->channels; c++)
            ret_values[c] += share * (double)grid->values[at * grid->channels + c];
    }
}

/* ---- Pictures -------------------------------------------------------------------------------- */

struct orl_grid *orl_grid_new(size_t n_values, uint32_t channels)
{
    struct orl_grid *const grid = calloc(1, sizeof *grid);
    if (!grid)
        return NULL;
    grid->n_values = n_values;
    grid->channels = channels;
    grid->values = calloc(n_values, sizeof *grid->values);
    if (grid->values)
        return grid;
    free(grid);
    return NULL;
}

int orl_grid_fail(const char *name, int code, struct orl_error *err, const char *what)
{
    orl_error_set(err, code, "%s", what);
    orl_error_at(err, name, 0, NULL);
    return code;
}

int orl_grid_new_picture(const char *name, uint32_t width, uint32_t height, double aspect,
                         struct orl_grid **ret_grid, struct orl_error *err)
{
    const uint64_t values = (uint64_t)ORL_GRID_CHANNELS * width * height;
    const bool large =
        width > ORL_LIMIT_IMAGE_SIDE || height > ORL_LIMIT_IMAGE_SIDE || values > ORL_GRID_VALUES;
    if (large || width < 2 || height < 2) {
        const int code = large ? ORL_ERR_LIMIT : ORL_ERR_SYNTAX;
        orl_error_set(
            err, code,
            "the picture has %u x %u pixels: it must have at least 2 x 2, and at most %lu M", width,
            height, (ORL_GRID_VALUES >> 20) / ORL_GRID_CHANNELS);
        orl_error_at(err, name, 0, NULL);
        return code;
    }
    struct orl_grid *const grid = orl_grid_new(values, ORL_GRID_CHANNELS);
    if (!grid)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    const double up = aspect * height / width; /* height of the picture in units of its width */
    grid->n_axes = 2;
    grid->axes[0] = (struct orl_grid_axis){.size = up >= 1 ? up : 1, .n = height};
    grid->axes[1] = (struct orl_grid_axis){.size = up >= 1 ? 1 : 1 / up, .n = width};
    *ret_grid = grid;
    return 0;
}

float *orl_grid_pixel(struct orl_grid *grid, uint32_t x, uint32_t y)
{
    const size_t width = grid->axes[1].n, row = grid->axes[0].n - 1 - y;
    return grid->values + (row * width + x) * grid->channels;
}
