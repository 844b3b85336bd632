/*
 * A material's own functions, as patterns hold them: where a prism sends rays to, and the values of
 * lobes. Inputs are Radiance's names for functions of materials.
 */
#ifndef ORL_SCENE_MATERIAL_OWN_H
#define ORL_SCENE_MATERIAL_OWN_H

#include "scene/geometry/geometry.h"

struct orl_pattern;

/* Shares of glazing by the angle (glazing.c); where a prism sends to; values of lobes. */
enum orl_own_kind { ORL_OWN_NOTHING, ORL_OWN_ANGLES, ORL_OWN_WAYS, ORL_OWN_LOBES };

/* Of a prism: where an eye's ray goes on to, and what share of radiance comes back along it. */
enum { ORL_PRISM_WAYS = 2 };
struct orl_own_way {
    double share;
    struct orl_vec3 towards; /* unit */
    int number;              /* which of the functions said so */
};

/* The ways of a ray that travels so (unit); those that have a value. */
int orl_own_ways(const struct orl_pattern *pattern, const struct orl_hit *hit, struct orl_vec3 ray,
                 struct orl_own_way ret_ways[ORL_PRISM_WAYS]);

/* Directions of light and of an eye, unit, away from the surface. */
struct orl_lobe_pair {
    struct orl_vec3 light, eye;
};
enum { ORL_LOBES_ABREAST = 8 };

/*
 * What lobes' functions give for such pairs, at most ORL_LOBES_ABREAST: 1/sr, of each channel, not
 * below 0; 0 where one has no value. color: of the material at the hit.
 */
void orl_own_lobes(const struct orl_pattern *pattern, const struct orl_hit *hit,
                   struct orl_rgb color, const struct orl_lobe_pair *pairs, size_t n,
                   struct orl_rgb *ret_values);

#endif
