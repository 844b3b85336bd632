/*
 * Crowded places: between slats, in a mug, under a shelf so low that a density estimate is as wide
 * as the gap. There what is in the way of the light is also in the way of who looks, and at the
 * same scale: of a slat's underside one sees the edge alone, which is darker, or brighter, than the
 * slat, and an estimate that means over the slat is off by as much, whatever the photons' number
 * says of it. No light is lost or made, but what is seen is not what was meant over. Whoever reads
 * densities is to look on from there instead.
 *
 * Threads: a pure function of its arguments.
 */
#ifndef ORL_PHOTON_DENSITY_CROWD_H
#define ORL_PHOTON_DENSITY_CROWD_H

#include "photon/surface/footprint.h"

/*
 * Whether, of the light that would come to the footing from an even sky, more than a share is from
 * what is nearer than twice that radius. Panes are not in the way.
 */
bool orl_is_crowded(const struct orl_footing *footing, double radius);

#endif
