/* A parallel beam as wide as the scene, in which distant light from one direction starts. */
#ifndef ORL_PHOTON_EMISSION_PARALLEL_BEAM_H
#define ORL_PHOTON_EMISSION_PARALLEL_BEAM_H

#include "scene/geometry/geometry.h"

/*
 * Samples a point on the faces of the scene's box that face the light, uniform by projected area.
 * Returns the projected area.
 */
double orl_parallel_beam_sample(const struct orl_geometry *geometry, struct orl_vec3 towards,
                                const double u[2], struct orl_vec3 *ret_point);

#endif
