#include "photon/emission/emit_sampling.h"

#include <stdlib.h>
#include <string.h>

int orl_distribution_2d_init(struct orl_distribution_2d *distribution, uint32_t side_x,
                             uint32_t side_y, const double *values, double floor_share)
{
    const size_t cells = (size_t)side_x * side_y;
    double sum = 0;
    *distribution = (struct orl_distribution_2d){.side_x = side_x, .side_y = side_y};
    distribution->weight = malloc(cells * sizeof *distribution->weight);
    distribution->row_cdf = malloc((side_y + 1) * sizeof *distribution->row_cdf);
    distribution->cell_cdf = malloc((size_t)side_y * (side_x + 1) * sizeof *distribution->cell_cdf);
    if (!distribution->weight || !distribution->row_cdf || !distribution->cell_cdf) {
        orl_distribution_2d_done(distribution);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < cells; i++)
        sum += values[i];
    distribution->mean = sum / (double)cells;
    const double uniform = (sum > 0 ? floor_share : 1.0) / (double)cells;
    const double scale = sum > 0 ? (1 - floor_share) / sum : 0;
    distribution->row_cdf[0] = 0;
    for (uint32_t y = 0; y < side_y; y++) {
        double *const cdf = distribution->cell_cdf + (size_t)y * (side_x + 1);
        cdf[0] = 0;
        for (uint32_t x = 0; x < side_x; x++) {
            const size_t i = (size_t)y * side_x + x;
            distribution->weight[i] = values[i] * scale + uniform;
            cdf[x + 1] = cdf[x] + distribution->weight[i];
        }
        distribution->row_cdf[y + 1] = distribution->row_cdf[y] + cdf[side_x];
    }
    return 0;
}

void orl_distribution_2d_done(struct orl_distribution_2d *distribution)
{
    free(distribution->weight);
    free(distribution->row_cdf);
    free(distribution->cell_cdf);
    memset(distribution, 0, sizeof *distribution);
}

uint64_t orl_distribution_2d_bytes(const struct orl_distribution_2d *distribution)
{
    const uint64_t cells = (uint64_t)distribution->side_x * distribution->side_y;
    return distribution->weight
               ? (2 * cells + 2 * (uint64_t)distribution->side_y + 1) * sizeof *distribution->weight
               : 0;
}

/* Bisection step without branches, because the result is unpredictable. */
static inline uint32_t bisect_step(const double *cdf, uint32_t low, uint32_t half, double at)
{
    return low + (cdf[low + half] <= at) * half;
}

/* Returns the position within step i. */
static inline double within_step(const double *cdf, uint32_t i, double at)
{
    const double width = cdf[i + 1] - cdf[i], within = (at - cdf[i]) / width;
    const double most = 1 - 0x1p-53;
    return width > 0 ? (within < most ? within : most) : 0.5;
}

/* Samples a few points in columns: a single look-up waits for each of its steps, several at once
 * wait for memory only. */
static inline void sample_few(const struct orl_distribution_2d *distribution, const double (*u)[2],
                              size_t n, double (*ret_points)[2], double *ret_pdfs)
{
    const size_t stride = distribution->side_x + 1;
    const double whole = distribution->row_cdf[distribution->side_y];
    const double *rows[ORL_DISTRIBUTION_2D_LANES];
    double at[ORL_DISTRIBUTION_2D_LANES];
    uint32_t x[ORL_DISTRIBUTION_2D_LANES], y[ORL_DISTRIBUTION_2D_LANES];
    for (size_t i = 0; i < n; i++) {
        at[i] = u[i][1] * whole;
        x[i] = y[i] = 0;
    }
    /* Finds the last row that begins no later, then the last cell of it. */
    for (uint32_t left = distribution->side_y; left > 1; left -= left / 2)
        for (size_t i = 0; i < n; i++)
            y[i] = bisect_step(distribution->row_cdf, y[i], left / 2, at[i]);
    for (size_t i = 0; i < n; i++) {
        rows[i] = distribution->cell_cdf + y[i] * stride;
        ret_points[i][1] =
            (y[i] + within_step(distribution->row_cdf, y[i], at[i])) / distribution->side_y;
        at[i] = u[i][0] * rows[i][distribution->side_x];
    }
    for (uint32_t left = distribution->side_x; left > 1; left -= left / 2)
        for (size_t i = 0; i < n; i++)
            x[i] = bisect_step(rows[i], x[i], left / 2, at[i]);
    for (size_t i = 0; i < n; i++) {
        ret_points[i][0] = (x[i] + within_step(rows[i], x[i], at[i])) / distribution->side_x;
        ret_pdfs[i] = distribution->weight[(size_t)y[i] * distribution->side_x + x[i]] *
                      distribution->side_x * distribution->side_y;
    }
}

void orl_distribution_2d_sample_many(const struct orl_distribution_2d *distribution,
                                     const double (*u)[2], size_t n, double (*ret_points)[2],
                                     double *ret_pdfs)
{
    for (size_t i = 0; i < n; i += ORL_DISTRIBUTION_2D_LANES)
        sample_few(distribution, u + i,
                   n - i < ORL_DISTRIBUTION_2D_LANES ? n - i : ORL_DISTRIBUTION_2D_LANES,
                   ret_points + i, ret_pdfs + i);
}

double orl_distribution_2d_sample(const struct orl_distribution_2d *distribution, const double u[2],
                                  double ret_point[2])
{
    const double numbers[1][2] = {{u[0], u[1]}};
    double point[1][2], pdf;
    sample_few(distribution, numbers, 1, point, &pdf);
    ret_point[0] = point[0][0];
    ret_point[1] = point[0][1];
    return pdf;
}
