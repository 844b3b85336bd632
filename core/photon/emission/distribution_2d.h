/*
 * Piecewise-constant distributions over the unit square: rows are sampled by their sums, then cells
 * in a row.
 */
#ifndef ORL_PHOTON_EMISSION_DISTRIBUTION_2D_H
#define ORL_PHOTON_EMISSION_DISTRIBUTION_2D_H

#include "photon/emission/emit.h"

/*
 * Makes the table from side_x * side_y values (row by row), mixed with floor_share of uniform.
 * Returns 0, or ORL_ERR_NOMEM, in which case the table is empty.
 */
int orl_distribution_2d_init(struct orl_distribution_2d *distribution, uint32_t side_x,
                             uint32_t side_y, const double *values, double floor_share);
void orl_distribution_2d_done(struct orl_distribution_2d *distribution);

/* Samples a point of the square with two uniform numbers. Returns its pdf (1 for a uniform
 * distribution). */
double orl_distribution_2d_sample(const struct orl_distribution_2d *distribution, const double u[2],
                                  double ret_point[2]);

/* Samples the table for many pairs of numbers, as orl_distribution_2d_sample does for one; fastest
 * in groups of ORL_DISTRIBUTION_2D_LANES. */
enum { ORL_DISTRIBUTION_2D_LANES = 16 };
void orl_distribution_2d_sample_many(const struct orl_distribution_2d *distribution,
                                     const double (*u)[2], size_t n, double (*ret_points)[2],
                                     double *ret_pdfs);

#endif
