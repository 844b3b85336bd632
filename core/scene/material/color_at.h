/*
 * What a material is made of at a hit: the one place where patterns have their say. For the kinds
 * of material (kinds.h); others ask scatter.h, where that is quick enough.
 */
#ifndef ORL_SCENE_MATERIAL_COLOR_AT_H
#define ORL_SCENE_MATERIAL_COLOR_AT_H

#include "scene/geometry/geometry.h"
#include "scene/material/pattern.h"

/* Reflectance as written; of lights, radiance. */
static inline struct orl_rgb orl_color_at(const struct orl_material *material,
                                          const struct orl_hit *hit)
{
    if (material->pattern)
        return orl_patterned(material->color, orl_pattern_at(material->pattern, hit));
    return material->color;
}

/* Of a mixture: how much of the light towards there each of both sends; of a sum all. */
static inline void orl_shares_at(const struct orl_material *material, const struct orl_hit *hit,
                                 struct orl_vec3 towards, double ret_shares[2])
{
    ret_shares[0] = ret_shares[1] = 1;
    if (!material->mix)
        return;
    ret_shares[0] = orl_smaller(orl_pattern_towards(material->mix, hit, towards).r, 1);
    ret_shares[1] = 1 - ret_shares[0];
}

/* Of glass: what its pattern leaves of the light that it lets through. */
static inline struct orl_rgb orl_left_at(const struct orl_material *material,
                                         const struct orl_hit *hit)
{
    return orl_patterned(orl_gray(1), orl_pattern_at(material->pattern, hit));
}

/* Of glass: of one pass at normal incidence, without its pattern. */
static inline struct orl_rgb orl_transmissivity_at(const struct orl_material *material,
                                                   const struct orl_hit *hit)
{
    (void)hit;
    return material->transmissivity;
}

#endif
