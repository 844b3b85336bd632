/*
 * Colours and shares of a material at a hit; the only place that evaluates patterns of materials.
 * Used by the kinds of material (kinds.h); other code calls scatter.h, where that is fast enough.
 */
#ifndef ORL_SCENE_MATERIAL_COLOR_AT_H
#define ORL_SCENE_MATERIAL_COLOR_AT_H

#include "scene/geometry/geometry.h"
#include "scene/material/patterns/pattern.h"

/* Returns the reflectance as written, or the radiance of a light, times the pattern. */
static inline struct orl_rgb orl_color_at(const struct orl_material *material,
                                          const struct orl_hit *hit)
{
    if (material->pattern)
        return orl_patterned(material->color, orl_pattern_at(material->pattern, hit));
    return material->color;
}

/* Mixture: the share of each material in the light towards that direction. Sum: both are 1. */
static inline void orl_mixture_shares_at(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 towards,
                                         double ret_shares[2])
{
    ret_shares[0] = ret_shares[1] = 1;
    if (!material->mix)
        return;
    ret_shares[0] = orl_smaller(orl_pattern_towards(material->mix, hit, towards).r, 1);
    ret_shares[1] = 1 - ret_shares[0];
}

/* Glass: returns the factor by which the pattern reduces the transmitted light. */
static inline struct orl_rgb orl_glass_pattern_at(const struct orl_material *material,
                                                  const struct orl_hit *hit)
{
    return orl_patterned(orl_gray(1), orl_pattern_at(material->pattern, hit));
}

/* Glass: returns the transmissivity (one pass at normal incidence), without the pattern. */
static inline struct orl_rgb orl_transmissivity_at(const struct orl_material *material,
                                                   const struct orl_hit *hit)
{
    (void)hit;
    return material->transmissivity;
}

#endif
