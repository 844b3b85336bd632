/*
 * Piecewise-constant distributions over the unit square: rows are sampled by their sums, then cells
 * in a row.
 */
#ifndef ORL_PHOTON_FLIGHT_TABLE_H
#define ORL_PHOTON_FLIGHT_TABLE_H

#include "photon/flight/emit.h"

/*
 * Makes the table from side_x * side_y values (row by row), mixed with floor_share of uniform.
 * Returns 0, or ORL_ERR_NOMEM, in which case the table is empty.
 */
int orl_table_init(struct orl_table *table, uint32_t side_x, uint32_t side_y, const double *values,
                   double floor_share);
void orl_table_done(struct orl_table *table);

/* Samples a point of the square with two uniform numbers. Returns its pdf (1 for a uniform
 * distribution). */
double orl_table_sample(const struct orl_table *table, const double u[2], double ret_point[2]);

/* Samples the table for many pairs of numbers, as orl_table_sample does for one; fastest in groups
 * of ORL_TABLE_ABREAST. */
enum { ORL_TABLE_ABREAST = 16 };
void orl_table_sample_many(const struct orl_table *table, const double (*u)[2], size_t n,
                           double (*ret_points)[2], double *ret_densities);

#endif
