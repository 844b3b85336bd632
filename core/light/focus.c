#include "light/focus.h"

#include "scene/geometry/placed.h"
#include "scene/material/bounds.h"
#include "scene/material/scatter.h"

static const double seldom = 2e-3;
/* Weight of a ray that meets a convex mirror. If such mirrors fill a share p of a window's view,
 * they reflect p / 4 of the sun's irradiance onto it; lenses and hollow mirrors of the same size
 * send several times p. */
static const double convex_weight = 0.1;

/* Returns true if a mirror is seen from the side where it spreads light; textured ones are taken to
 * do so. */
static bool is_convex(const struct orl_facet *f, const struct orl_hit *hit)
{
    const bool inwards =
        f->kind == ORL_SURFACE_BUBBLE || f->kind == ORL_SURFACE_TUBE || f->kind == ORL_SURFACE_CUP;
    return orl_surface_kind_is_flat(f->kind) || hit->front != inwards;
}

bool orl_focus_exists(const struct orl_scene *scene)
{
    struct orl_kept_walk walk = orl_kept_walk(scene->geometry);
    while (orl_kept_next(&walk)) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_of(scene->geometry, walk.facet, &own);
        const struct orl_material *m = &scene->description.materials[f->material];
        if (orl_material_bends(m) ||
            (orl_material_is_mirror(m) && (!orl_surface_kind_is_flat(f->kind) || m->texture)))
            return true;
    }
    return false;
}

static double weight_of(struct orl_focus *focus, const struct orl_hit *hit)
{
    static const double parallel = 0.999;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_of(focus->scene->geometry, hit->facet, &own);
    const struct orl_material *m = orl_scene_material(focus->scene, hit->facet);
    const bool flat = orl_surface_kind_is_flat(f->kind);
    if (!orl_material_bends(m)) {
        const bool curved = !flat || m->texture;
        return !orl_material_is_mirror(m) || !curved ? 0 : is_convex(f, hit) ? convex_weight : 1;
    }
    if (!flat || m->texture || focus->parallel_too)
        return 1;
    for (int i = 0; i < 2; i++) {
        if (!(orl_dot(focus->flat[i], focus->flat[i]) > 0))
            focus->flat[i] = hit->normal;
        if (fabs(orl_dot(focus->flat[i], hit->normal)) >= parallel)
            return 0;
    }
    return 1;
}

void orl_focus_look(struct orl_focus *focus, struct orl_vec3 from, struct orl_vec3 direction)
{
    struct orl_hit hit;
    focus->rays++;
    if (orl_geometry_intersect(focus->scene->geometry, from, direction, INFINITY, &hit))
        focus->met += weight_of(focus, &hit);
}

bool orl_focus_matters(const struct orl_focus *focus)
{
    return focus->met > 0 && focus->met >= seldom * (double)focus->rays;
}
