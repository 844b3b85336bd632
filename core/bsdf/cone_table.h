/*
 * Fast sampling of transmission for light from a narrow cone, such as the sun's. If the cone falls
 * into a few cells of a tensor tree, the transmission of each is tabulated beforehand. Sampling is
 * then a table look-up instead of a descent of the tree.
 *
 * Each table is an alias table (Walker 1977, built as by Vose 1991) over the leaves that the cell
 * meets, by value times size; its probabilities equal the values' own to 1e-7. Light from outside
 * the tabulated cells is sampled by orl_bsdf_sample.
 *
 * Borrows the BSDF. Immutable once built; any number of threads may sample it.
 */
#ifndef ORL_BSDF_CONE_TABLE_H
#define ORL_BSDF_CONE_TABLE_H

#include <oriel/bsdf/bsdf.h>

struct orl_cone_table;

/*
 * Builds tables for the cone about the unit direction in; directions as for orl_bsdf_sample.
 * *ret_incident is NULL if tables would not help: other kinds of data, colour, or too many cells.
 * Returns 0 or ORL_ERR_NOMEM.
 */
int orl_cone_table_new(const struct orl_bsdf *bsdf, struct orl_vec3 in, double half_angle_rad,
                       struct orl_cone_table **ret_table);
void orl_cone_table_free(struct orl_cone_table *cone_table); /* NULL is allowed */

/* Samples like orl_bsdf_sample with ORL_BSDF_TRANSMIT. Returns false if nothing is transmitted. */
bool orl_cone_table_sample(const struct orl_cone_table *cone_table, struct orl_vec3 in,
                           const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight);

#endif
