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

/* Bisection step without branches, because the result is unpredictable. */
static inline uint32_t bisect_step(const double *below, uint32_t low, uint32_t half, double at)
{
    return low + (below[low + half] <= at) * half;
}

/* Returns the position within step i. */
static inline double within_step(const double *below, uint32_t i, double at)
{
    const double width = below[i + 1] - below[i], within = (at - below[i]) / width;
    const double most = 1 - 0x1p-53;
    return width > 0 ? (within < most ? within : most) : 0.5;
}

/* Samples a few points in columns: a single look-up waits for each of its steps, several at once
 * wait for memory only. */
static inline void sample_few(const struct orl_table *table, const double (*u)[2], size_t n,
                              double (*ret_points)[2], double *ret_densities)
{
    const size_t stride = table->side_x + 1;
    const double whole = table->row_below[table->side_y];
    const double *rows[ORL_TABLE_ABREAST];
    double at[ORL_TABLE_ABREAST];
    uint32_t x[ORL_TABLE_ABREAST], y[ORL_TABLE_ABREAST];
    for (size_t i = 0; i < n; i++) {
        at[i] = u[i][1] * whole;
        x[i] = y[i] = 0;
    }
    /* Finds the last row that begins no later, then the last cell of it. */
    for (uint32_t left = table->side_y; left > 1; left -= left / 2)
        for (size_t i = 0; i < n; i++)
            y[i] = bisect_step(table->row_below, y[i], left / 2, at[i]);
    for (size_t i = 0; i < n; i++) {
        rows[i] = table->cell_below + y[i] * stride;
        ret_points[i][1] = (y[i] + within_step(table->row_below, y[i], at[i])) / table->side_y;
        at[i] = u[i][0] * rows[i][table->side_x];
    }
    for (uint32_t left = table->side_x; left > 1; left -= left / 2)
        for (size_t i = 0; i < n; i++)
            x[i] = bisect_step(rows[i], x[i], left / 2, at[i]);
    for (size_t i = 0; i < n; i++) {
        ret_points[i][0] = (x[i] + within_step(rows[i], x[i], at[i])) / table->side_x;
        ret_densities[i] =
            table->weight[(size_t)y[i] * table->side_x + x[i]] * table->side_x * table->side_y;
    }
}

void orl_table_sample_many(const struct orl_table *table, const double (*u)[2], size_t n,
                           double (*ret_points)[2], double *ret_densities)
{
    for (size_t i = 0; i < n; i += ORL_TABLE_ABREAST)
        sample_few(table, u + i, n - i < ORL_TABLE_ABREAST ? n - i : ORL_TABLE_ABREAST,
                   ret_points + i, ret_densities + i);
}

double orl_table_sample(const struct orl_table *table, const double u[2], double ret_point[2])
{
    const double numbers[1][2] = {{u[0], u[1]}};
    double point[1][2], density;
    sample_few(table, numbers, 1, point, &density);
    ret_point[0] = point[0][0];
    ret_point[1] = point[0][1];
    return density;
}
