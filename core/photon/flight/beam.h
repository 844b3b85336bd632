/*
 * A parallel beam as wide as the scene: where distant light that comes from one direction starts.
 */
#ifndef ORL_PHOTON_FLIGHT_BEAM_H
#define ORL_PHOTON_FLIGHT_BEAM_H

#include "scene/geometry/geometry.h"

/*
 * The scene's box as seen from far away: a point on the faces that look towards the light, uniform
 * by projected area. Returns that area.
 */
double orl_beam_point(const struct orl_geometry *geometry, struct orl_vec3 towards,
                      const double u[2], struct orl_vec3 *ret_point);

#endif
