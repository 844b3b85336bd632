/*
 * Surfaces that emit from their front: light, illum, spotlight within its cone, glow, and mixtures
 * with a share of glow.
 *
 * A spotlight's irradiance falls off as if its beam started `focus` behind the lamp: at distance d
 * it is (d / (d + focus))^2 of an isotropic lamp's (spotout and srcray of Radiance). Views see the
 * lamp at the same radiance from everywhere.
 */
#include "scene/material/kinds.h"

bool orl_material_emits(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_any(material, orl_material_emits);
    return orl_material_is_lamp(material) || material->kind == ORL_MATERIAL_GLOW;
}

/* Radiance samples a glow like a light where it is no further away than its radius. */
bool orl_material_is_lamp(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_LIGHT || material->kind == ORL_MATERIAL_SPOTLIGHT ||
           material->kind == ORL_MATERIAL_ILLUM ||
           (material->kind == ORL_MATERIAL_GLOW && orl_glow_of(material)->max_radius > 0);
}

static bool holds_glow(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return orl_mixture_any(material, holds_glow);
    return material->kind == ORL_MATERIAL_GLOW && orl_glow_of(material)->max_radius >= 0;
}

bool orl_material_glows(const struct orl_material *material)
{
    return holds_glow(material) && !orl_material_is_lamp(material);
}

bool orl_spotlight_covers(const struct orl_material *material, struct orl_vec3 towards)
{
    if (material->kind != ORL_MATERIAL_SPOTLIGHT)
        return true;
    const struct orl_spotlight *const spot = orl_spotlight_of(material);
    return orl_dot(towards, spot->beam_axis) >= spot->cos_cone;
}

static struct orl_rgb mixed_emission(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 towards)
{
    const struct orl_material *const mixed = orl_mixture_of(material)->mixed;
    struct orl_rgb sum = orl_gray(0);
    double shares[2];
    orl_mixture_shares_at(material, hit, towards, shares);
    for (int i = 0; i < 2; i++)
        if (shares[i] > 0)
            sum = orl_rgb_add(
                sum, orl_rgb_scale(orl_material_emission(&mixed[i], hit, towards), shares[i]));
    return sum;
}

struct orl_rgb orl_material_emission(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 towards)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return mixed_emission(material, hit, towards);
    const bool shines = orl_material_emits(material) && orl_dot(towards, hit->normal) > 0;
    if (!shines || !orl_spotlight_covers(material, towards))
        return orl_gray(0);
    return material->pattern
               ? orl_rgb_mul(material->color, orl_pattern_towards(material->pattern, hit, towards))
               : material->color;
}
