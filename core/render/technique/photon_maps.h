/*
 * Methods of the techniques that read photon maps: gather, direct and precomputed. They differ in
 * the estimator of indirect light at surfaces (orl_indirect_estimator, render/gather/gather.h),
 * which each of their files defines, and share all else:
 *   E(x) = E_direct(x) + E_caustic(x) + E_rest(x)
 * Every light path belongs to one of the three terms (render/gather/gather.h). Shadow rays give
 * E_direct, without bias. The density of caustic photons gives E_caustic at surfaces: the fluxes of
 * the k nearest photons over the area of their disc, with a bias in proportion to the disc's area
 * and to the curvature of the light, and a relative variance of about 1 / k. At sensors in free
 * space no photon is stored. There photons that are traced for that purpose measure E_caustic by
 * their flux through a disc (render/gather/sensor_flux.h). The estimator gives E_rest.
 *
 * References: Jensen 2001, chapters 7 to 9 (photon maps); Grobe 2019 (these techniques with BSDFs
 * of high resolution, and their abbreviations GCx and xCP).
 */
#ifndef ORL_RENDER_TECHNIQUE_PHOTON_MAPS_H
#define ORL_RENDER_TECHNIQUE_PHOTON_MAPS_H

#include "render/technique/technique.h"

/* The estimators of the three techniques. */
extern const struct orl_indirect_estimator orl_indirect_gathered, orl_indirect_density,
    orl_indirect_records;

extern const struct orl_technique_methods orl_photon_map_methods;

#endif
