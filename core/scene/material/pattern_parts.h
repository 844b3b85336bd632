/*
 * What the files that evaluate patterns share: a function's inputs, and what a value is worth.
 * Internal to pattern*.c and own.c.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERN_PARTS_H
#define ORL_SCENE_MATERIAL_PATTERN_PARTS_H

#include "function/ray_names.h"
#include "scene/material/pattern.h"

/* Whether all of the function has a value at the hit; where it has none the colour stays. */
enum orl_pattern_worth { ORL_WORTH_VALUE, ORL_WORTH_NONE, ORL_WORTH_TOO_LONG };

/* A direction, in the function's frame, from that input on (ray_names.h). */
void orl_pattern_take(const struct orl_pattern *pattern, double *inputs, enum orl_ray_input first,
                      struct orl_vec3 direction);
/* All of a place, seen from there. */
void orl_pattern_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double inputs[ORL_RAY_INPUTS]);
enum orl_pattern_worth orl_pattern_run(const struct orl_function *function, const double *inputs,
                                       double *ret_values);

/* Its factor, with those under it. */
enum orl_pattern_worth orl_pattern_factor(const struct orl_pattern *pattern,
                                          const struct orl_hit *hit, struct orl_vec3 towards,
                                          struct orl_rgb *ret_factor);
/* Where distant light is met that comes from there. */
struct orl_hit orl_pattern_hit_of_sky(struct orl_vec3 direction);

#endif
