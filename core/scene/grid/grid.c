#include "scene/grid/grid.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

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

/* ---- Interpolation ----------------------------------------------------------------------------
 */

/* Two neighbours on an axis, and the shares of their values. */
struct neighbours {
    uint32_t first;
    double share[2];
};

/* The interval of uneven points that holds x, or the one next to it. */
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
    double t; /* from the first to the second */
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
