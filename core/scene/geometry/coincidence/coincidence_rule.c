#include "scene/geometry/coincidence/coincidence_rule.h"

/* ---- Materials ------------------------------------------------------------------------------- */

static bool same_vec(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_rgb(struct orl_rgb a, struct orl_rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static bool same_media(const struct orl_material *a, const struct orl_material *b)
{
    bool same = true;
    for (int i = 0; i < 2; i++)
        same = same && a->media[i].ior == b->media[i].ior &&
               same_rgb(a->media[i].transmissivity, b->media[i].transmissivity);
    return same;
}

/* Returns true if two materials scatter light alike; their names may differ. */
static bool materials_alike(const struct orl_material *a, const struct orl_material *b)
{
    return a == b ||
           (a->kind == b->kind && same_rgb(a->color, b->color) && a->specular == b->specular &&
            a->roughness[0] == b->roughness[0] && a->roughness[1] == b->roughness[1] &&
            same_rgb(a->extinction, b->extinction) && same_rgb(a->scattered, b->scattered) &&
            a->asymmetry == b->asymmetry && a->roughness_pattern == b->roughness_pattern &&
            a->diffuse_side == b->diffuse_side &&
            same_vec(a->anisotropy_axis, b->anisotropy_axis) && same_rgb(a->gloss, b->gloss) &&
            a->power[0] == b->power[0] && a->power[1] == b->power[1] && a->angles == b->angles &&
            a->transmitted == b->transmitted &&
            a->transmitted_specular == b->transmitted_specular &&
            same_rgb(a->transmissivity, b->transmissivity) && a->ior == b->ior &&
            same_media(a, b) && a->max_radius == b->max_radius && a->bsdf == b->bsdf &&
            a->thickness == b->thickness && same_vec(a->up, b->up) && a->peak == b->peak &&
            same_rgb(a->front, b->front) && same_rgb(a->back, b->back) &&
            same_rgb(a->through, b->through) && same_vec(a->beam_axis, b->beam_axis) &&
            a->cos_cone == b->cos_cone && a->focus == b->focus && a->seen_as == b->seen_as &&
            a->sky == b->sky && a->pattern == b->pattern && a->texture == b->texture &&
            a->mix == b->mix && !a->mixed == !b->mixed &&
            (!a->mixed || (materials_alike(&a->mixed[0], &b->mixed[0]) &&
                           materials_alike(&a->mixed[1], &b->mixed[1]))));
}

/* ---- Order --------------------------------------------------------------------------------------
 */

int orl_coincidence_class(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_GLAZING:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_PRISM:
        return 1;
    case ORL_MATERIAL_FUNCTION_LOBES:
        return m->transmitted > 0 ? 1 : 2;
    case ORL_MATERIAL_MIXTURE:
        return orl_coincidence_class(&m->mixed[0]) < 2 || orl_coincidence_class(&m->mixed[1]) < 2
                   ? 1
                   : 2;
    case ORL_MATERIAL_BSDF:
        return m->peak ? 1 : 2;
    default:
        return 2;
    }
}

int orl_coincidence_compare(const struct orl_parsed_scene *d, const struct orl_surface *a,
                            const struct orl_surface *b)
{
    const int class_a = orl_coincidence_class(&d->materials[a->material]);
    const int class_b = orl_coincidence_class(&d->materials[b->material]);
    if (class_a != class_b)
        return class_a - class_b;
    if (orl_dot(a->normal, b->normal) < 0)
        return 0;
    if (a->modifier_order != b->modifier_order)
        return a->modifier_order > b->modifier_order ? 1 : -1;
    return a > b ? 1 : -1;
}

bool orl_material_is_two_sided(const struct orl_material *m)
{
    if (m->kind == ORL_MATERIAL_MIXTURE)
        return orl_material_is_two_sided(&m->mixed[0]) && orl_material_is_two_sided(&m->mixed[1]);
    return m->kind == ORL_MATERIAL_PLASTIC || m->kind == ORL_MATERIAL_METAL ||
           m->kind == ORL_MATERIAL_TRANS || m->kind == ORL_MATERIAL_GLASS ||
           m->kind == ORL_MATERIAL_ASHIKHMIN || m->kind == ORL_MATERIAL_FUNCTION_LOBES;
}

bool orl_surfaces_alike(const struct orl_parsed_scene *d, const struct orl_surface *a,
                        const struct orl_surface *b)
{
    return materials_alike(&d->materials[a->material], &d->materials[b->material]);
}

bool orl_surface_is_proxy(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    return d->materials[s->material].thickness != 0;
}

bool orl_surface_is_hole(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    return d->materials[s->material].kind == ORL_MATERIAL_ANTIMATTER;
}
