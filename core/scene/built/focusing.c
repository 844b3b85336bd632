#include "scene/built/focusing.h"

#include "scene/geometry/instances.h"
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

bool orl_focusing_exists(const struct orl_scene *scene)
{
    struct orl_facet_iterator walk = orl_facet_iterator(scene->geometry);
    while (orl_facet_iterator_next(&walk)) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get(scene->geometry, walk.facet, &own);
        const struct orl_material *m = &scene->parsed_scene.materials[f->material];
        if (orl_material_deviates(m) ||
            (orl_material_is_mirror(m) && (!orl_surface_kind_is_flat(f->kind) || m->texture)))
            return true;
    }
    return false;
}

static double weight_of(struct orl_focusing_probe *probe, const struct orl_hit *hit)
{
    static const double parallel = 0.999;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get(probe->scene->geometry, hit->facet, &own);
    const struct orl_material *m = orl_scene_material(probe->scene, hit->facet);
    const bool flat_normals = orl_surface_kind_is_flat(f->kind);
    if (!orl_material_deviates(m)) {
        const bool curved = !flat_normals || m->texture;
        return !orl_material_is_mirror(m) || !curved ? 0 : is_convex(f, hit) ? convex_weight : 1;
    }
    if (!flat_normals || m->texture || probe->any_orientation)
        return 1;
    for (int i = 0; i < 2; i++) {
        if (!(orl_dot(probe->flat_normals[i], probe->flat_normals[i]) > 0))
            probe->flat_normals[i] = hit->normal;
        if (fabs(orl_dot(probe->flat_normals[i], hit->normal)) >= parallel)
            return 0;
    }
    return 1;
}

void orl_focusing_trace(struct orl_focusing_probe *probe, struct orl_vec3 from,
                        struct orl_vec3 direction)
{
    struct orl_hit hit;
    probe->rays++;
    if (orl_geometry_intersect(probe->scene->geometry, from, direction, INFINITY, &hit))
        probe->focusing_rays += weight_of(probe, &hit);
}

bool orl_focusing_is_significant(const struct orl_focusing_probe *probe)
{
    return probe->focusing_rays > 0 && probe->focusing_rays >= seldom * (double)probe->rays;
}
