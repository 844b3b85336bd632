/*
 * Tensor tree of rank 3: a function of two directions that is invariant under rotation of both
 * about the axis. It is stored as a full grid of at most 2^7 x 2^8 x 2^8 floats; look-up is an
 * index.
 *
 * Axes. The first is 0.5 - 0.5 sin(theta) of A; only its lower half is used. The other two are B on
 * the Shirley-Chiu square, after turning both directions until A, as the light travels, points
 * along +x. Bit 0 of a child's number is A, bit 1 B.x, bit 2 B.y.
 *
 * Sampling. The map sends the circle of radius r to the border of the square of half side r, and
 * equal angles to equal lengths. If A turns about the axis for a given B, B moves along a ring of
 * cells. The angle of A over which B stays in a cell is proportional to the cell's share of the
 * ring's length. Integrals over either direction are thus exact sums over cells, and sampling is
 * exact too.
 *
 * Invariants: values are finite and not negative (xml/data_text.h). Immutable once finished; any
 * number of threads may read. Reference: Shirley and Chiu 1997.
 */
#ifndef ORL_BSDF_TREE_ISO_H
#define ORL_BSDF_TREE_ISO_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "bsdf/tree/tree.h"

struct orl_iso {
    unsigned half;   /* rings of either direction; the square has 2 * half cells a side */
    float *values;   /* [ring of A][B.x][B.y]; owned, like all pointers below */
    double *rows;    /* [ring of A][B.x]: running sums of the values of rows */
    double *edges;   /* [ring of A][ring of B]: sum over the ring's cells except its corners */
    double *corners; /* [ring of A][ring of B]: sum over the ring's four corners */
    size_t leaves;   /* number of leaves in the file */
    size_t clamped;  /* negative values set to zero */
    float minimum;
    float *finest_grid; /* while building: the grid at the finest possible size */
    unsigned depth;     /* level of the deepest leaf so far */
    bool eval_only;     /* true for a tree that is only evaluated: it has no sums */
};

/* Polar coordinates of a direction projected along the axis, the same on both sides of the
 * surface. */
struct orl_disk_polar {
    double radius, azimuth;
};
struct orl_disk_polar orl_disk_polar_of(struct orl_vec3 direction);

/* ---- Building -------------------------------------------------------------------------------- */

int orl_iso_init(struct orl_iso *iso, struct orl_error *err);
/*
 * Fills a cell of the grid with 8^log2_side values, the last axis varying fastest. The cell is at
 * place[], in units of 2^-level.
 */
void orl_iso_fill(struct orl_iso *iso, const unsigned place[3], unsigned level, const float *values,
                  unsigned log2_side);
int orl_iso_finish(struct orl_iso *iso, struct orl_error *err);
void orl_iso_done(struct orl_iso *iso); /* a partly built tree is allowed */

/* ---- Reading: like the functions of the same names in tree.h -------------------------------- */

double orl_iso_eval(const struct orl_iso *iso, struct orl_disk_polar a, struct orl_disk_polar b);
double orl_iso_total(const struct orl_iso *iso, enum orl_tree_axis given,
                     struct orl_disk_polar place);
double orl_iso_sample(const struct orl_iso *iso, enum orl_tree_axis given,
                      struct orl_disk_polar place, const double u[2],
                      struct orl_vec3 *ret_direction);

/* orl_iso_ring returns the ring of a direction as A. orl_iso_cell also returns the cell [B.x][B.y]
 * of a pair. */
unsigned orl_iso_ring(const struct orl_iso *iso, struct orl_disk_polar a);
size_t orl_iso_cell(const struct orl_iso *iso, struct orl_disk_polar a, struct orl_disk_polar b,
                    unsigned *ret_ring);

/* Returns the part of a value that counts, by ring of A and cell of B. */
typedef double (*orl_iso_part)(const void *ctx, unsigned ring, size_t cell, double value);

/*
 * Returns the integral of part over A for a given B. part must be 0 except near the straight
 * direction. On A: rings within reach of B's. On the square: cells within reach + 1 of the line of
 * straight ones; not required for rings of B within reach of the centre.
 */
double orl_iso_integral_near(const struct orl_iso *iso, struct orl_disk_polar b, unsigned reach,
                             orl_iso_part part, const void *ctx);

/* Returns the memory used, bytes. */
size_t orl_iso_bytes(const struct orl_iso *iso);

#endif
