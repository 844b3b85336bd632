/*
 * Surfaces that shine, from their front: light, illum, spotlight within its cone, glow; of mixtures
 * the share that glows.
 *
 * A spotlight's irradiance falls off as if its beam started `focus` behind the lamp: a point at
 * distance d gets (d / (d + focus))^2 of what an even lamp's beam would bring there (spotout and
 * srcray of Radiance's rt/source.c). To a view the lamp is equally bright wherever it is seen.
 */
#include "scene/material/kinds.h"

bool orl_material_shines(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_either(material, orl_material_shines);
    return orl_material_is_lamp(material) || material->kind == ORL_MATERIAL_GLOW;
}

bool orl_material_is_lamp(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_LIGHT || material->kind == ORL_MATERIAL_SPOTLIGHT ||
           material->kind == ORL_MATERIAL_ILLUM;
}

bool orl_material_glows(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_either(material, orl_material_glows);
    return material->kind == ORL_MATERIAL_GLOW && material->max_radius >= 0;
}

bool orl_material_beams(const struct orl_material *material, struct orl_vec3 towards)
{
    return material->kind != ORL_MATERIAL_SPOTLIGHT ||
           orl_dot(towards, material->aim) >= material->cos_cone;
}

struct orl_rgb orl_material_emission(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 towards)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_emission(material, hit, towards);
    const bool shines = orl_material_shines(material) && orl_dot(towards, hit->normal) > 0;
    if (!shines || !orl_material_beams(material, towards))
        return orl_gray(0);
    return material->pattern
               ? orl_rgb_mul(material->color, orl_pattern_towards(material->pattern, hit, towards))
               : material->color;
}

struct orl_scatter orl_illum_sample(const struct orl_draw *draw)
{
    const struct orl_rgb share = orl_material_straight(draw->material, draw->hit, draw->from);
    if (!(draw->lobes & ORL_LOBE_ILLUM) || !(orl_rgb_max(share) > 0))
        return (struct orl_scatter){.event = ORL_EVENT_ABSORBED};
    return (struct orl_scatter){.event = ORL_EVENT_STRAIGHT,
                                .transmitted = true,
                                .direction = orl_neg(draw->from),
                                .weight = share};
}
