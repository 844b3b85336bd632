/*
 * Shared by the files that evaluate patterns: inputs of functions, and validity of values. Internal
 * to pattern*.c and own.c.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERNS_PATTERN_INPUTS_H
#define ORL_SCENE_MATERIAL_PATTERNS_PATTERN_INPUTS_H

#include "function/ray_names.h"
#include "scene/material/patterns/pattern.h"

/* Validity of a function's values at a hit; without a value the colour stays unchanged. */
enum orl_pattern_validity { ORL_PATTERN_VALID, ORL_PATTERN_UNDEFINED, ORL_PATTERN_TOO_LONG };

/* Stores a direction in the function's frame, from that input on (ray_names.h). */
void orl_pattern_set_direction(const struct orl_pattern *pattern, double *inputs,
                               enum orl_ray_input first, struct orl_vec3 direction);
/* Sets all inputs for a hit seen from that direction. */
void orl_pattern_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double inputs[ORL_RAY_INPUTS]);
enum orl_pattern_validity orl_pattern_run(const struct orl_function *function, const double *inputs,
                                          double *ret_values);

/* The factor with the patterns under it. */
enum orl_pattern_validity orl_pattern_factor(const struct orl_pattern *pattern,
                                             const struct orl_hit *hit, struct orl_vec3 towards,
                                             struct orl_rgb *ret_factor);
/* Returns the hit at which distant light from that direction is evaluated. */
struct orl_hit orl_pattern_hit_of_sky(struct orl_vec3 direction);

#endif
