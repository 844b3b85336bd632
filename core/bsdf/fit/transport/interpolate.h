/*
 * Interpolation between incident directions: the lobes of each corner, moved as the plans to the
 * other corners say, and weighted.
 *
 * A lobe moves with its cluster. Its offset from the cluster and its width are scaled like the
 * cluster's width. A cluster moves to a mean of its places at the corners and of the places that
 * the velocities at the corners predict. At a corner the result is therefore that corner's shape,
 * and it varies continuously between corners. Beyond the border of the mesh the narrow part is
 * turned with the straight direction; the rest stays.
 *
 * Ownership: lobes are owned by the caller, who frees them with _done.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_INTERPOLATE_H
#define ORL_BSDF_FIT_TRANSPORT_INTERPOLATE_H

#include "bsdf/fit/transport/transport_plans.h"

/* A Gaussian of light around the direction (x, y, z). */
struct orl_fit_gaussian {
    float x, y, z, mass, sigma_rad;
};

struct orl_fit_light {
    struct orl_fit_gaussian *gaussians; /* lobes; owned */
    size_t n, capacity;
    double floor; /* constant value beside the lobes, 1/sr */
};

/* Replaces the contents of *light. Returns false if out of memory. */
bool orl_fit_interpolate(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                         const struct orl_fit_location *location, struct orl_fit_light *light);
void orl_fit_light_done(struct orl_fit_light *light);

#endif
