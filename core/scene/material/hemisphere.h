/*
 * Maps the unit square to the hemisphere: uniform numbers to cosine-weighted directions.
 */
#ifndef ORL_SCENE_MATERIAL_HEMISPHERE_H
#define ORL_SCENE_MATERIAL_HEMISPHERE_H

#include "bsdf/tree/shirley.h"

/* Returns the unit vector with z >= 0 for (u, v) in [0,1]^2; equal areas map to equal projected
 * solid angles. */
static inline struct orl_vec3 orl_hemisphere_point(double u, double v)
{
    return orl_square_to_hemisphere((struct orl_square){2 * u - 1, 2 * v - 1});
}

/* orl_hemisphere_point about a unit normal. */
static inline struct orl_vec3 orl_hemisphere_about(struct orl_vec3 normal, double u, double v)
{
    const struct orl_frame frame = orl_frame_about(normal);
    return orl_to_world(&frame, orl_hemisphere_point(u, v));
}

#endif
