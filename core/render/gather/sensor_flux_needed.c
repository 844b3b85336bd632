/* Tests whether caustics in free space need photons. */
#include "render/gather/sensor_flux.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

static bool has_lamps(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        if (lit_scene->emitters[i].direct)
            return true;
    return false;
}

/* Returns true if two flat facets lie in one plane. */
static bool lie_in_one_plane(const struct orl_geometry *g, const struct orl_facet *a,
                             const struct orl_facet *b)
{
    const struct orl_vec3 at =
        a->n_triangles > 0 ? orl_triangle_get(g, a->first_triangle).a : a->quadric->center[0];
    const struct orl_vec3 to =
        b->n_triangles > 0 ? orl_triangle_get(g, b->first_triangle).a : b->quadric->center[0];
    return fabs(orl_dot(a->normal, b->normal)) > 1 - 1e-9 &&
           fabs(orl_dot(orl_sub(to, at), a->normal)) <= a->offset;
}

/*
 * Returns true if caustics in free space need photons. Panes with lobes and flat mirrors that all
 * lie in one plane redirect light once. For suns gather_sensor.c samples such light, as it does any
 * number of flat mirrors alone.
 */
static bool caustics_need_photons(const struct orl_lit_scene *lit_scene)
{
    const struct orl_geometry *g = lit_scene->geometry;
    const bool lamps = has_lamps(lit_scene);
    struct orl_facet first = {.n_triangles = 0};
    bool any_plane = false, any_lobes = false, several_planes = false;
    if (lit_scene->n_suns == 0 && !lamps)
        return false;
    for (struct orl_facet_iterator walk = orl_facet_iterator(g); orl_facet_iterator_next(&walk);) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_get(g, walk.facet, &room);
        const struct orl_material *m = &lit_scene->materials[f->material];
        const bool mirrors = orl_material_is_mirror(m), lobes = orl_material_has_lobes(m);
        if (!(f->area > 0) || (!mirrors && !lobes && !orl_material_deviates(m)))
            continue;
        if (lamps || orl_facet_is_instanced(g, walk.facet) || !orl_surface_kind_is_flat(f->kind) ||
            m->texture || orl_material_deviates(m) || (lobes && !orl_material_transmits_lobes(m)))
            return true;
        if (!any_plane)
            first = *f;
        any_plane = true;
        any_lobes = any_lobes || lobes;
        several_planes = several_planes || !lie_in_one_plane(g, &first, f);
    }
    return (any_lobes && several_planes) ||
           lit_scene->images.n_left_out + lit_scene->images.n_images_left_out > 0;
}

bool orl_sensor_flux_may_exist(const struct orl_lit_scene *lit_scene)
{
    return !(lit_scene->omit.mirror_caustics && lit_scene->omit.lobe_caustics) &&
           caustics_need_photons(lit_scene);
}

bool orl_sensor_flux_is_virtual_suns(const struct orl_lit_scene *lit_scene)
{
    const struct orl_geometry *g = lit_scene->geometry;
    for (struct orl_facet_iterator walk = orl_facet_iterator(g); orl_facet_iterator_next(&walk);)
        if (orl_material_has_lobes(&lit_scene->materials[orl_facet_material(g, walk.facet)]))
            return false;
    return !caustics_need_photons(lit_scene);
}
