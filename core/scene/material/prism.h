/*
 * Tests of a prism's functions before rendering. Scattering itself is in kinds.h.
 */
#ifndef ORL_SCENE_MATERIAL_PRISM_H
#define ORL_SCENE_MATERIAL_PRISM_H

#include "scene/geometry/geometry.h"

struct orl_prism_findings {
    double all, one_way; /* sums of eye rays' shares: all, and of irreversible ways */
    double most_seen;    /* largest sum of radiance shares, for an eye ray */
    double most_sent;    /* largest sum of flux shares, for light */
};

/* Adds the findings of rays from all directions at one place. */
void orl_prism_look(const struct orl_material *material, const struct orl_hit *hit,
                    struct orl_prism_findings *findings);

#endif
