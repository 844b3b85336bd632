/*
 * The laser cut panel of the paper's office, simulated: an acrylic slab with parallel horizontal
 * cuts, whose BSDF is written as a tensor tree that Oriel and Radiance read alike.
 *
 * Frame: that of BSDF files. z is the panel's normal, y is up, the cuts are planes of constant y.
 * A direction is a place on the unit square (Shirley and Chiu's equal-area map of the disk of x and
 * y); A is where the light travels to as it arrives, B as it leaves. On the square the panel does
 * this: light either goes on (B = A) or is thrown up or down by an odd number of cuts (B.y = -A.y).
 *
 * Cells are counted in Morton order: bits x, y of every level together, the coarsest level on top.
 * A cell of the tensor has a key of 4 bits a level: A.x, A.y, B.x, B.y from the lowest bit up,
 * which is how a tensor tree numbers its children.
 */
#ifndef ORIEL_EXAMPLE_LCP_H
#define ORIEL_EXAMPLE_LCP_H

#include <stdint.h>
#include <stdio.h>

struct lcp_settings {
    unsigned levels;   /* log2 of the cells per axis: 2 to 7 */
    uint32_t rays;     /* per incident cell */
    uint64_t seed;     /* the same seed gives the same bytes */
    double index;      /* of refraction */
    double aspect;     /* thickness of the panel over the distance of its cuts */
    double absorption; /* per thickness travelled straight through */
    double blur_deg;   /* scattering that real cuts add: root mean square angle */
    double tolerance;  /* of merging cells (lcp_tree.c) */
};

/* One cell of the tensor that is not zero. */
struct lcp_cell {
    uint32_t key;
    float value; /* 1/sr */
};

/* Cells in order of their keys. A.x and A.y are in the lower half: the rest is mirrored. */
struct lcp_tensor {
    struct lcp_cell *cells; /* owned */
    size_t count, capacity;
};

/* Traces the panel into transmission and reflection. 0, or -1 when out of memory. */
int lcp_trace(const struct lcp_settings *settings, struct lcp_tensor *ret_transmission,
              struct lcp_tensor *ret_reflection);

/* Writes a tensor as the braces of a tensor tree. */
void lcp_write_tree(FILE *out, const struct lcp_settings *settings,
                    const struct lcp_tensor *tensor);

#endif
