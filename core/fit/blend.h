/*
 * The light that leaves a place between incident directions: lobes of each corner, moved as the
 * plans to the others say, and weighted.
 *
 * A lobe moves with its cluster, its offset from there and its width scaled as the clusters' widths
 * are; clusters by the mean of where corners have them and where slopes at the corners say that
 * they would be. So at a corner the result is that corner's own shape, and it changes continuously
 * between. Beyond the border what stands out is turned with the straight direction; the rest stays.
 *
 * Ownership: of lobes the caller's, by _done.
 */
#ifndef ORL_FIT_BLEND_H
#define ORL_FIT_BLEND_H

#include "fit/plans.h"

/* A Gaussian of light. */
struct orl_fit_ray {
    float x, y, z, mass, sigma_rad;
};

struct orl_fit_light {
    struct orl_fit_ray *rays; /* owned */
    size_t n, room;
    double floor; /* 1/sr, beside them */
};

/* Replaces what *light holds. False: no memory. */
bool orl_fit_blend(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                   const struct orl_fit_place *place, struct orl_fit_light *light);
void orl_fit_light_done(struct orl_fit_light *light);

#endif
