/*
 * BSDF values between directions that are used many times: each direction is located in the data
 * once. All directions are in the surface's frame and point away from it, as in oriel/bsdf/bsdf.h.
 */
#ifndef ORL_BSDF_LOCATED_DIRECTION_H
#define ORL_BSDF_LOCATED_DIRECTION_H

#include <oriel/bsdf/bsdf.h>

#include "bsdf/data.h"

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

#endif
