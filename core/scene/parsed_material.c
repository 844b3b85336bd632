/*
 * Equality of materials. Patterns, functions and BSDFs are compared by their addresses: the parser
 * makes one of equal ones.
 */
#include "scene/parsed_material.h"

#include <string.h>

static bool same_rgb(struct orl_rgb a, struct orl_rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static bool same_vec3(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_diffuse(const struct orl_diffuse_parts *a, const struct orl_diffuse_parts *b)
{
    return same_rgb(a->front, b->front) && same_rgb(a->back, b->back) &&
           same_rgb(a->through, b->through);
}

static bool same_shares(const struct orl_reflector_shares *a, const struct orl_reflector_shares *b)
{
    return a->specular == b->specular && a->transmitted == b->transmitted &&
           a->transmitted_specular == b->transmitted_specular;
}

static bool same_reflector(const struct orl_reflector *a, const struct orl_reflector *b)
{
    return same_shares(&a->shares, &b->shares) && a->roughness[0] == b->roughness[0] &&
           a->roughness[1] == b->roughness[1] &&
           same_vec3(a->anisotropy_axis, b->anisotropy_axis) &&
           a->roughness_pattern == b->roughness_pattern && a->diffuse_side == b->diffuse_side;
}

static bool same_function_lobes(const struct orl_function_lobes *a,
                                const struct orl_function_lobes *b)
{
    return same_shares(&a->shares, &b->shares) && a->functions == b->functions &&
           a->tints_lobes == b->tints_lobes && a->is_whole_bsdf == b->is_whole_bsdf;
}

static bool same_ashikhmin(const struct orl_ashikhmin *a, const struct orl_ashikhmin *b)
{
    return same_rgb(a->gloss, b->gloss) && a->power[0] == b->power[0] &&
           a->power[1] == b->power[1] && same_vec3(a->anisotropy_axis, b->anisotropy_axis);
}

static bool same_glass(const struct orl_glass *a, const struct orl_glass *b)
{
    return same_rgb(a->transmissivity, b->transmissivity) && a->ior == b->ior;
}

static bool same_glazing(const struct orl_glazing *a, const struct orl_glazing *b)
{
    return same_diffuse(&a->diffuse, &b->diffuse) && a->transmitted == b->transmitted &&
           a->angles == b->angles;
}

static bool same_medium(const struct orl_medium *a, const struct orl_medium *b)
{
    return same_rgb(a->transmissivity, b->transmissivity) && a->ior == b->ior;
}

static bool same_interface(const struct orl_interface *a, const struct orl_interface *b)
{
    return same_medium(&a->media[0], &b->media[0]) && same_medium(&a->media[1], &b->media[1]);
}

static bool same_bsdf_surface(const struct orl_bsdf_surface *a, const struct orl_bsdf_surface *b)
{
    return a->bsdf == b->bsdf && a->thickness == b->thickness && same_vec3(a->up, b->up) &&
           a->peak == b->peak && same_diffuse(&a->diffuse, &b->diffuse);
}

static bool same_spotlight(const struct orl_spotlight *a, const struct orl_spotlight *b)
{
    return same_vec3(a->beam_axis, b->beam_axis) && a->cos_cone == b->cos_cone &&
           a->focus == b->focus;
}

static bool same_illum(const struct orl_illum *a, const struct orl_illum *b)
{
    return same_glass(&a->pane, &b->pane) && a->seen_as == b->seen_as;
}

/* The recursion is at most as deep as the parser lets mixtures nest. */
static bool same_mixture(const struct orl_mixture *a, const struct orl_mixture *b)
{
    return a->share == b->share && orl_material_same(&a->mixed[0], &b->mixed[0]) &&
           orl_material_same(&a->mixed[1], &b->mixed[1]);
}

static bool same_mist(const struct orl_mist *a, const struct orl_mist *b)
{
    return same_rgb(a->extinction, b->extinction) && same_rgb(a->scattering, b->scattering) &&
           a->asymmetry == b->asymmetry;
}

static bool same_antimatter(const struct orl_antimatter *a, const struct orl_antimatter *b)
{
    return a->n_cut == b->n_cut && a->lining == b->lining &&
           (a->n_cut == 0 || memcmp(a->cut, b->cut, a->n_cut * sizeof *a->cut) == 0);
}

/* Compares the structs of two materials of one kind. */
static bool same_model(const struct orl_material *a, const struct orl_material *b)
{
    switch (a->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return same_reflector(orl_reflector_of(a), orl_reflector_of(b));
    case ORL_MATERIAL_ASHIKHMIN:
        return same_ashikhmin(orl_ashikhmin_of(a), orl_ashikhmin_of(b));
    case ORL_MATERIAL_GLASS:
        return same_glass(orl_glass_of(a), orl_glass_of(b));
    case ORL_MATERIAL_GLAZING:
        return same_glazing(orl_glazing_of(a), orl_glazing_of(b));
    case ORL_MATERIAL_DIELECTRIC:
        return same_interface(orl_interface_of(a), orl_interface_of(b));
    case ORL_MATERIAL_FUNCTION_LOBES:
        return same_function_lobes(orl_function_lobes_of(a), orl_function_lobes_of(b));
    case ORL_MATERIAL_PRISM:
        return orl_prism_of(a)->rays == orl_prism_of(b)->rays;
    case ORL_MATERIAL_BSDF:
        return same_bsdf_surface(orl_bsdf_surface_of(a), orl_bsdf_surface_of(b));
    case ORL_MATERIAL_GLOW:
        return orl_glow_of(a)->max_radius == orl_glow_of(b)->max_radius;
    case ORL_MATERIAL_SPOTLIGHT:
        return same_spotlight(orl_spotlight_of(a), orl_spotlight_of(b));
    case ORL_MATERIAL_MIXTURE:
        return same_mixture(orl_mixture_of(a), orl_mixture_of(b));
    case ORL_MATERIAL_ILLUM:
        return same_illum(orl_illum_of(a), orl_illum_of(b));
    case ORL_MATERIAL_MIST:
        return same_mist(orl_mist_of(a), orl_mist_of(b));
    case ORL_MATERIAL_ANTIMATTER:
        return same_antimatter(orl_antimatter_of(a), orl_antimatter_of(b));
    case ORL_MATERIAL_VOID:
    case ORL_MATERIAL_MIRROR:
    case ORL_MATERIAL_LIGHT:
        break;
    }
    return true;
}

bool orl_material_same(const struct orl_material *a, const struct orl_material *b)
{
    return a == b || (a->kind == b->kind && same_rgb(a->color, b->color) && a->sky == b->sky &&
                      a->pattern == b->pattern && a->texture == b->texture && same_model(a, b));
}
