/*
 * A BSDF between directions that are asked for many times: each is placed in the data once. All
 * directions are in the surface's frame, and point away from it, as in oriel/bsdf.h.
 */
#ifndef ORL_BSDF_PLACED_H
#define ORL_BSDF_PLACED_H

#include <oriel/bsdf.h>

#include "bsdf/data.h"

struct orl_bsdf_direction {
    struct orl_vec3 at; /* unit */
    struct orl_coords coords;
};
struct orl_bsdf_direction orl_bsdf_place(const struct orl_bsdf *bsdf, struct orl_vec3 direction);

/* A direction that light comes from. */
struct orl_bsdf_incidence {
    struct orl_bsdf_direction from;
    double gain;        /* what all values are divided by, so that no more light leaves than came */
    double transmitted; /* directional transmittance, as filed */
};
struct orl_bsdf_incidence orl_bsdf_place_incident(const struct orl_bsdf *bsdf, struct orl_vec3 in);

/* Returns f, as orl_bsdf_eval, for an out on the other side of the surface. ret_pdf: per
 * steradian, of sampling it among all transmitted directions, as orl_bsdf_pdf. */
struct orl_rgb orl_bsdf_transmit(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *in,
                                 const struct orl_bsdf_direction *out, double *ret_pdf);

/* Returns true if both directions are in one cell of the data for incident light: then f and its
 * pdf are the same for both, whatever is asked. False if this cannot be told. */
bool orl_bsdf_in_one_cell(const struct orl_bsdf *bsdf, const struct orl_bsdf_incidence *a,
                          const struct orl_bsdf_incidence *b);

#endif
