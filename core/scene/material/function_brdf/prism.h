/*
 * Tests of a prism's functions before rendering. Scattering itself is in kinds.h.
 */
#ifndef ORL_SCENE_MATERIAL_FUNCTION_BRDF_PRISM_H
#define ORL_SCENE_MATERIAL_FUNCTION_BRDF_PRISM_H

#include "scene/geometry/geometry.h"

struct orl_prism_statistics {
    double all, irreversible; /* sums of eye rays' shares: all, and of irreversible ways */
    double max_seen;          /* largest sum of radiance shares, for an eye ray */
    double max_sent;          /* largest sum of flux shares, for light */
};

/* Adds the findings of rays from all directions at one place. */
void orl_prism_measure(const struct orl_material *material, const struct orl_hit *hit,
                       struct orl_prism_statistics *statistics);

#endif
