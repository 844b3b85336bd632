/*
 * Functions of materials, stored as patterns (enum orl_pattern_role): directions of a prism's rays,
 * and values of lobes. Their inputs have Radiance's names for functions of materials.
 */
#ifndef ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_H
#define ORL_SCENE_MATERIAL_FUNCTION_BRDF_FUNCTION_BRDF_H

#include "scene/geometry/geometry.h"

struct orl_pattern;

/* Prism: a direction in which an eye ray continues, and the share of the radiance that comes back
 * along it. */
enum { ORL_PRISM_RAYS = 2 };
struct orl_prism_ray {
    double share;
    struct orl_vec3 towards; /* unit */
    int number;              /* index of the function */
};

/* Finds the outgoing rays of a ray that travels in a unit direction; leaves out those without a
 * value. Returns their number. */
int orl_function_brdf_prism_rays(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                 struct orl_vec3 ray,
                                 struct orl_prism_ray ret_rays[ORL_PRISM_RAYS]);

/* Directions of light and eye, unit, pointing away from the surface. */
struct orl_lobe_pair {
    struct orl_vec3 light, eye;
};
enum { ORL_LOBE_PAIRS_MAX = 8 };

/*
 * Evaluates the lobe functions for at most ORL_LOBE_PAIRS_MAX pairs: 1/sr per channel, at least 0,
 * and 0 where a function has no value. color: the material's colour at the hit.
 */
void orl_function_brdf_eval(const struct orl_pattern *pattern, const struct orl_hit *hit,
                            struct orl_rgb color, const struct orl_lobe_pair *pairs, size_t n,
                            struct orl_rgb *ret_values);

#endif
