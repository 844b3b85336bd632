/*
 * Near-field occlusion test: places between slats, in a mug, or under a low shelf, where a density
 * estimate is as wide as the gap. There the same objects occlude both the light and the viewer, at
 * the same scale. For example, only the edge of a slat's underside is visible; it is darker or
 * brighter than the slat. An estimate averages over the whole slat and is wrong by that difference,
 * whatever its number of photons. Light is neither created nor lost, but the visible part is not
 * the averaged part. Readers of densities must continue the path from there instead.
 *
 * Threads: a pure function of its arguments.
 */
#ifndef ORL_PHOTON_DENSITY_NEAR_OCCLUSION_H
#define ORL_PHOTON_DENSITY_NEAR_OCCLUSION_H

#include "photon/surface/footprint.h"

/*
 * Returns true if surfaces nearer than twice `radius` block at least 3/16 of the light of a uniform
 * sky on the surface point, as sampled by rays. Panes do not block.
 */
bool orl_near_occlusion_test(const struct orl_surface_point *surface_point, double radius);

#endif
