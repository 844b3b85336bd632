#include "photon/flight/table.h"

#include <stdlib.h>
#include <string.h>

int orl_table_init(struct orl_table *table, uint32_t side_x, uint32_t side_y, const double *values,
                   double floor_share)
{
    const size_t cells = (size_t)side_x * side_y;
    double sum = 0;
    *table = (struct orl_table){.side_x = side_x, .side_y = side_y};
    table->weight = malloc(cells * sizeof *table->weight);
    table->row_below = malloc((side_y + 1) * sizeof *table->row_below);
    table->cell_below = malloc((size_t)side_y * (side_x + 1) * sizeof *table->cell_below);
    if (!table->weight || !table->row_below || !table->cell_below) {
        orl_table_done(table);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < cells; i++)
        sum += values[i];
    table->mean = sum / (double)cells;
    const double uniform = (sum > 0 ? floor_share : 1.0) / (double)cells;
    const double scale = sum > 0 ? (1 - floor_share) / sum : 0;
    table->row_below[0] = 0;
    for (uint32_t y = 0; y < side_y; y++) {
        double *const below = table->cell_below + (size_t)y * (side_x + 1);
        below[0] = 0;
        for (uint32_t x = 0; x < side_x; x++) {
            const size_t i = (size_t)y * side_x + x;
            table->weight[i] = values[i] * scale + uniform;
            below[x + 1] = below[x] + table->weight[i];
        }
        table->row_below[y + 1] = table->row_below[y] + below[side_x];
    }
    return 0;
}

void orl_table_done(struct orl_table *table)
{
    free(table->weight);
    free(table->row_below);
    free(table->cell_below);
    memset(table, 0, sizeof *table);
}

/*
 * The last i < n with below[i] <= at, and the position within step i. Halved without branches:
 * which half it is, is chance.
 */
static uint32_t find_step(const double *below, uint32_t n, double at, double *ret_within)
{
    uint32_t low = 0;
    for (uint32_t left = n; left > 1; left -= left / 2)
        low += (below[low + left / 2] <= at) * (left / 2);
    const double width = below[low + 1] - below[low];
    *ret_within = width > 0 ? fmin((at - below[low]) / width, 1 - 0x1p-53) : 0.5;
    return low;
}

double orl_table_sample(const struct orl_table *table, const double u[2], double ret_point[2])
{
    double within_x, within_y;
    const uint32_t y = find_step(table->row_below, table->side_y,
                                 u[1] * table->row_below[table->side_y], &within_y);
    const double *const below = table->cell_below + (size_t)y * (table->side_x + 1);
    const uint32_t x = find_step(below, table->side_x, u[0] * below[table->side_x], &within_x);
    ret_point[0] = (x + within_x) / table->side_x;
    ret_point[1] = (y + within_y) / table->side_y;
    return table->weight[(size_t)y * table->side_x + x] * table->side_x * table->side_y;
}
