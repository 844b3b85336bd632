/* Tests whether caustics in mid-air need photons. */
#include "render/gather/air.h"
#include "scene/geometry/placed.h"
#include "scene/material/bounds.h"

static bool has_lamps(const struct orl_world *world)
{
    for (size_t i = 0; i < world->n_emitters; i++)
        if (world->emitters[i].direct)
            return true;
    return false;
}

/* Returns true if two flat facets lie in one plane. */
static bool lie_in_one_plane(const struct orl_geometry *g, const struct orl_facet *a,
                             const struct orl_facet *b)
{
    const struct orl_vec3 at =
        a->n_triangles > 0 ? orl_triangle_of(g, a->first_triangle).a : a->round->center[0];
    const struct orl_vec3 to =
        b->n_triangles > 0 ? orl_triangle_of(g, b->first_triangle).a : b->round->center[0];
    return fabs(orl_dot(a->normal, b->normal)) > 1 - 1e-9 &&
           fabs(orl_dot(orl_sub(to, at), a->normal)) <= a->offset;
}

/*
 * Returns true if caustics in mid-air need photons. Panes with lobes and flat mirrors that all lie
 * in one plane redirect light once. For suns gather_sensor.c samples such light, as it does any
 * number of flat mirrors alone.
 */
static bool caustics_need_photons(const struct orl_world *world)
{
    const struct orl_geometry *g = world->geometry;
    const bool lamps = has_lamps(world);
    struct orl_facet first = {.n_triangles = 0};
    bool any_plane = false, any_lobes = false, apart = false;
    if (world->n_suns == 0 && !lamps)
        return false;
    for (struct orl_kept_walk walk = orl_kept_walk(g); orl_kept_next(&walk);) {
        struct orl_facet room;
        const struct orl_facet *f = orl_facet_of(g, walk.facet, &room);
        const struct orl_material *m = &world->materials[f->material];
        const bool mirrors = orl_material_is_mirror(m), lobes = orl_material_has_lobes(m);
        if (!(f->area > 0) || (!mirrors && !lobes && !orl_material_bends(m)))
            continue;
        if (lamps || orl_facet_is_placed(g, walk.facet) || !orl_surface_kind_is_flat(f->kind) ||
            m->texture || orl_material_bends(m) || (lobes && !orl_material_transmits_lobes(m)))
            return true;
        if (!any_plane)
            first = *f;
        any_plane = true;
        any_lobes = any_lobes || lobes;
        apart = apart || !lie_in_one_plane(g, &first, f);
    }
    return (any_lobes && apart) || world->images.n_left_out > 0;
}

bool orl_air_may_be_lit(const struct orl_world *world)
{
    return !(world->omit.mirror_caustics && world->omit.lobe_caustics) &&
           caustics_need_photons(world);
}

bool orl_air_is_by_images(const struct orl_world *world)
{
    const struct orl_geometry *g = world->geometry;
    for (struct orl_kept_walk walk = orl_kept_walk(g); orl_kept_next(&walk);)
        if (orl_material_has_lobes(&world->materials[orl_facet_material(g, walk.facet)]))
            return false;
    return !caustics_need_photons(world);
}
