#include "light/focus.h"

#include "scene/geometry/placed.h"
#include "scene/material/bounds.h"
#include "scene/material/scatter.h"

static const double seldom = 2e-3;

static bool focuses(struct orl_focus *focus, const struct orl_hit *hit)
{
    static const double parallel = 0.999;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_of(focus->scene->geometry, hit->facet, &own);
    const struct orl_material *m = orl_scene_material(focus->scene, hit->facet);
    const bool flat = f->kind == ORL_SURFACE_POLYGON || f->kind == ORL_SURFACE_RING;
    if (!orl_material_bends(m) && !orl_material_is_mirror(m))
        return false;
    if (!flat || m->texture)
        return true;
    if (!orl_material_bends(m))
        return false;
    if (focus->parallel_too)
        return true;
    if (!(orl_dot(focus->flat, focus->flat) > 0))
        focus->flat = hit->normal;
    return fabs(orl_dot(focus->flat, hit->normal)) < parallel;
}

void orl_focus_look(struct orl_focus *focus, struct orl_vec3 from, struct orl_vec3 direction)
{
    struct orl_hit hit;
    focus->rays++;
    focus->met += orl_geometry_intersect(focus->scene->geometry, from, direction, INFINITY, &hit) &&
                  focuses(focus, &hit);
}

bool orl_focus_matters(const struct orl_focus *focus)
{
    return focus->met > 0 && (double)focus->met >= seldom * (double)focus->rays;
}
