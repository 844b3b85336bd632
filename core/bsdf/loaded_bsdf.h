/*
 * Ways to read a loaded BSDF often and fast, for the rest of core: directions located once, tables
 * for light from a narrow cone, and a file to be mapped by later jobs.
 */
#ifndef ORL_BSDF_LOADED_BSDF_H
#define ORL_BSDF_LOADED_BSDF_H

#include <stdint.h>

#include <oriel/bsdf/bsdf.h>

#include "bsdf/document.h"

/*
 * BSDF values between directions that are used many times: each direction is located in the data
 * once. All directions are in the surface's frame and point away from it, as in oriel/bsdf/bsdf.h.
 */

struct orl_bsdf_direction {
    struct orl_vec3 at; /* unit */
    struct orl_coords coords;
};
struct orl_bsdf_direction orl_bsdf_locate(const struct orl_bsdf *bsdf, struct orl_vec3 direction);

/* A direction from which light comes. */
struct orl_bsdf_incidence {
    struct orl_bsdf_direction from;
    double gain;        /* divisor of all values, which keeps R + T from being above 1 */
    double transmitted; /* directional transmittance as filed, before the division */
};
struct orl_bsdf_incidence orl_bsdf_locate_incident(const struct orl_bsdf *bsdf, struct orl_vec3 in);

/* Returns f, like orl_bsdf_eval, for an out on the other side of the surface. ret_pdf: pdf per
 * steradian of sampling out among all transmitted directions, like orl_bsdf_pdf. */
struct orl_rgb orl_bsdf_transmit(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *in,
                                 const struct orl_bsdf_direction *out, double *ret_pdf);

/* Returns true if both directions are in one cell of the data for incident light: f and its pdf are
 * then equal for every out. Returns false if that is unknown. */
bool orl_bsdf_in_one_cell(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *a,
                          const struct orl_bsdf_incidence *b);

/*
 * Fast sampling of transmission for light from a narrow cone, such as the sun's. If the cone falls
 * into a few cells of a tensor tree, the transmission of each is tabulated beforehand. Sampling is
 * then a table look-up instead of a descent of the tree.
 *
 * Each table is an alias table (Walker 1977, built as by Vose 1991) over the leaves in the cell, by
 * value times size. Its probabilities equal those of the values to 1e-7. Light from outside the
 * tabulated cells is sampled by orl_bsdf_sample.
 *
 * Borrows the BSDF. Immutable once built; any number of threads may sample it.
 */

struct orl_cone_table;

/*
 * Builds tables for the cone about the unit direction in. Directions are as for orl_bsdf_sample.
 * *ret_table is NULL if tables would not help: other kinds of data, colour, or too many cells.
 * Returns 0 or ORL_ERR_NOMEM.
 */
int orl_cone_table_new(const struct orl_bsdf *bsdf, struct orl_vec3 in, double half_angle_rad,
                       struct orl_cone_table **ret_table);
void orl_cone_table_free(struct orl_cone_table *cone_table); /* NULL is allowed */

/* Samples like orl_bsdf_sample with ORL_BSDF_TRANSMIT. Returns false if nothing is transmitted. */
bool orl_cone_table_sample(const struct orl_cone_table *cone_table, struct orl_vec3 in,
                           const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight);

/*
 * A file that holds a loaded BSDF in its memory layout. It is mapped without parsing XML, and its
 * pages are shared between threads and processes.
 *
 * It is a sealed file (base/io/checked_file.h): struct orl_bsdf with offsets in place of its
 * pointers, then the arrays that they point to.
 *
 * A change of the loaded data or of their memory layout needs a new version.
 */

enum { ORL_COMPILED_VERSION = 3, ORL_COMPILED_DIGEST = 32 };

/* Writes the whole file; does not sync it. content: SHA-256 of the XML. Returns 0, ORL_ERR_IO or
 * ORL_ERR_NOMEM. */
int orl_bsdf_write(const struct orl_bsdf *bsdf, const unsigned char content[ORL_COMPILED_DIGEST],
                   const char *path, uint64_t *ret_bytes, struct orl_error *err);

/* Maps a file. *ret_bsdf is owned. The file may be removed or replaced while it is mapped. */
int orl_bsdf_open(const char *path, const unsigned char content[ORL_COMPILED_DIGEST],
                  struct orl_bsdf **ret_bsdf, struct orl_error *err);

#endif
