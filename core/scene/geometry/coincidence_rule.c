#include "scene/geometry/coincidence_rule.h"

#include "scene/geometry/cutting.h"

int orl_coincidence_class(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_GLAZING:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_PRISM:
        return 1;
    case ORL_MATERIAL_LOBED:
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

int orl_coincidence_compare(const struct orl_description *d, const struct orl_surface *a,
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
           m->kind == ORL_MATERIAL_ASHIKHMIN || m->kind == ORL_MATERIAL_LOBED;
}

bool orl_surfaces_alike(const struct orl_description *d, const struct orl_surface *a,
                        const struct orl_surface *b)
{
    return orl_materials_alike(&d->materials[a->material], &d->materials[b->material]);
}

bool orl_surface_is_proxy(const struct orl_description *d, const struct orl_surface *s)
{
    return d->materials[s->material].thickness != 0;
}

bool orl_surface_is_hole(const struct orl_description *d, const struct orl_surface *s)
{
    return d->materials[s->material].kind == ORL_MATERIAL_ANTIMATTER;
}
