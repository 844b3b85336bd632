/*
 * A tensor tree of rank 3: a function of two directions that does not change when both are turned
 * about the axis. Kept as a full grid, at most 2^7 x 2^8 x 2^8 floats; look-up is an index.
 *
 * Axes. The first is 0.5 - 0.5 sin(theta) of A, of which only the lower half is used; the other two
 * are B on the Shirley-Chiu square after turning both directions until A, as the light travels,
 * points along +x. Bit 0 of a child's number is A, bit 1 B.x, bit 2 B.y.
 *
 * Draws. That map sends the circle of radius r to the border of the square of half side r, and
 * equal angles to equal lengths of it. So as A turns about the axis for a given B, B runs round the
 * cells along a ring, each for an angle in proportion to its share of the ring's length: all
 * integrals over either direction are sums over cells, exactly, and so are the draws.
 *
 * Invariants: values are finite and not negative (scan.h). Immutable once finished; any number of
 * threads may read. Reference: Shirley and Chiu 1997.
 */
#ifndef ORL_BSDF_ISO_H
#define ORL_BSDF_ISO_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/vec.h>

#include "bsdf/tree.h"

struct orl_iso {
    unsigned half;   /* rings of either direction; the square has 2 half cells a side */
    float *values;   /* [ring of A][B.x][B.y]; owned, as all below */
    double *rows;    /* [ring of A][B.x]: running sums of the values of rows */
    double *edges;   /* [ring of A][ring of B]: sum over the ring's cells but for its corners */
    double *corners; /* [ring of A][ring of B]: sum over the ring's four corners */
    size_t leaves;   /* in the file */
    size_t clamped;  /* negative values set to zero */
    float minimum;
    float *canvas;  /* while building: the grid at the finest size there may be */
    unsigned depth; /* of the deepest leaf so far */
    bool plain;     /* to be evaluated only: there are no sums */
};

/* A direction as it is seen along the axis; which side of the surface does not matter. */
struct orl_round {
    double radius, azimuth;
};
struct orl_round orl_round_of(struct orl_vec3 direction);

/* ---- Building -------------------------------------------------------------------------------- */

int orl_iso_init(struct orl_iso *iso, struct orl_error *err);
/*
 * Sets the 8^log2_side values of a grid, the last axis running fastest. Its cell is at place[],
 * counted in cells of 2^-level.
 */
void orl_iso_fill(struct orl_iso *iso, const unsigned place[3], unsigned level, const float *values,
                  unsigned log2_side);
int orl_iso_finish(struct orl_iso *iso, struct orl_error *err);
void orl_iso_done(struct orl_iso *iso); /* NULL and half-built are allowed */

/* ---- Reading: as the functions of the same names in tree.h ----------------------------------- */

double orl_iso_eval(const struct orl_iso *iso, struct orl_round a, struct orl_round b);
double orl_iso_total(const struct orl_iso *iso, enum orl_tree_axis given, struct orl_round place);
double orl_iso_draw(const struct orl_iso *iso, enum orl_tree_axis given, struct orl_round place,
                    const double u[2], struct orl_vec3 *ret_direction);

/* The ring of a direction as A; with it, the cell [B.x][B.y] of a pair. */
unsigned orl_iso_ring(const struct orl_iso *iso, struct orl_round a);
size_t orl_iso_cell(const struct orl_iso *iso, struct orl_round a, struct orl_round b,
                    unsigned *ret_ring);

/* What of a value counts, by ring of A and cell of B. */
typedef double (*orl_iso_part)(const void *ctx, unsigned ring, size_t cell, double value);

/*
 * For a given B: the integral over A of part, which is 0 but for rings within reach of B's and,
 * from there on the square where that matters, cells within reach + 1 of the line of the straight
 * ones.
 */
double orl_iso_integral_near(const struct orl_iso *iso, struct orl_round b, unsigned reach,
                             orl_iso_part part, const void *ctx);

/* Memory held. */
size_t orl_iso_bytes(const struct orl_iso *iso);

#endif
