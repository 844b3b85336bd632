#include "scene/geometry/instances.h"

#include <stdlib.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "scene/geometry/intersect.h"

/* ---- By index -------------------------------------------------------------------------------- */

/* Returns the last instance whose first facet, or triangle, is not above the given one. */
static const struct orl_instance *find_instance(const struct orl_geometry *geometry, size_t index,
                                                bool by_triangle)
{
    const struct orl_instance *const instances = geometry->instance;
    size_t low = 0, high = geometry->n_instances;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        const size_t first =
            by_triangle ? instances[middle].first_triangle : instances[middle].first_facet;
        if (first <= index)
            low = middle;
        else
            high = middle;
    }
    return &instances[low];
}

const struct orl_instance *orl_instance_of(const struct orl_geometry *geometry, uint32_t facet)
{
    return find_instance(geometry, facet, false);
}

struct orl_triangle orl_instance_triangle(const struct orl_geometry *geometry, size_t index)
{
    const struct orl_instance *const instance = find_instance(geometry, index, true);
    const struct orl_triangle t =
        orl_triangle_get(instance->prototype, index - instance->first_triangle);
    return (struct orl_triangle){orl_xform_point(&instance->to, t.a),
                                 orl_xform_point(&instance->to, t.b),
                                 orl_xform_point(&instance->to, t.c)};
}

struct orl_facet orl_instance_facet(const struct orl_geometry *geometry, uint32_t facet,
                                    struct orl_quadric *room)
{
    struct orl_facet own;
    if (facet < geometry->n_facets)
        return *orl_facet_get_own(geometry, facet, &own);
    const struct orl_instance *const instance = orl_instance_of(geometry, facet);
    struct orl_facet f =
        *orl_facet_get_own(instance->prototype, facet - instance->first_facet, &own);
    if (f.kind != ORL_SURFACE_POLYGON) {
        *room = orl_xform_quadric(&instance->to, f.quadric);
        f.quadric = room;
    }
    f.kind = orl_xform_kind(&instance->to, f.kind);
    f.normal = orl_xform_normal(&instance->to, f.normal);
    f.offset = instance->offset;
    f.area *= instance->to.scale * instance->to.scale;
    f.first_triangle += instance->first_triangle;
    f.has_extra = f.has_proxy_offset = false;
    return f;
}

struct orl_facet_iterator orl_facet_iterator(const struct orl_geometry *geometry)
{
    return (struct orl_facet_iterator){.geometry = geometry, .part = geometry, .places = 1};
}

bool orl_facet_iterator_next(struct orl_facet_iterator *walk)
{
    const struct orl_geometry *const g = walk->geometry;
    while (walk->next == walk->part->n_facets) {
        if (walk->next_prototype == g->n_prototypes)
            return false;
        walk->part = g->prototypes[walk->next_prototype++];
        walk->places = walk->part->n_uses;
        walk->next = 0;
    }
    const uint32_t first = walk->part == g ? 0 : g->instance[walk->part->first_use].first_facet;
    walk->facet = first + (uint32_t)walk->next++;
    return true;
}

void orl_instance_hit(const struct orl_geometry *geometry, const struct orl_instance *instance,
                      struct orl_vec3 origin, struct orl_vec3 direction, struct orl_hit *hit)
{
    struct orl_facet own;
    const bool quadric =
        orl_facet_get_own(instance->prototype, hit->facet, &own)->kind != ORL_SURFACE_POLYGON;
    hit->distance *= instance->to.scale;
    hit->point = orl_madd(origin, direction, hit->distance);
    hit->normal = orl_xform_normal(&instance->to, hit->normal);
    hit->facet += instance->first_facet;
    hit->triangle = quadric ? 0 : hit->triangle + instance->first_triangle;
    hit->instance = (uint32_t)(instance - geometry->instance) + 1;
    hit->front = hit->front != instance->to.inverted;
}

struct orl_hit orl_instance_to_prototype(const struct orl_geometry *geometry,
                                         const struct orl_hit *hit)
{
    const struct orl_instance *const instance = &geometry->instance[hit->instance - 1];
    struct orl_hit read = *hit;
    read.point = orl_add(orl_xform_point(&instance->from, hit->point),
                         orl_sub(instance->prototype->center, geometry->center));
    read.normal = orl_xform_normal(&instance->from, hit->normal);
    read.instance = 0;
    return read;
}

struct orl_vec3 orl_instance_direction_in(const struct orl_geometry *geometry,
                                          const struct orl_hit *hit, struct orl_vec3 direction)
{
    return orl_xform_direction(&geometry->instance[hit->instance - 1].from, direction);
}

struct orl_vec3 orl_instance_direction_out(const struct orl_geometry *geometry,
                                           const struct orl_hit *hit, struct orl_vec3 read)
{
    return orl_xform_direction(&geometry->instance[hit->instance - 1].to, read);
}

/* ---- Building -------------------------------------------------------------------------------- */

/* Bounds of the transformed corners, which are tighter than a rotated box. */
static void bound_instance(struct orl_instance *instance)
{
    const struct orl_geometry *const g = instance->prototype;
    instance->low = orl_v3(INFINITY, INFINITY, INFINITY);
    instance->high = orl_neg(instance->low);
    for (size_t i = 0; i < g->n_corners; i++)
        orl_box_include(orl_xform_point(&instance->to, orl_corner_get(g, i)), &instance->low,
                        &instance->high);
    for (size_t i = 0; i < g->n_quadrics; i++) {
        struct orl_facet own, facet = *orl_facet_get_own(g, g->n_facets - 1 - i, &own);
        const struct orl_quadric curved = orl_xform_quadric(&instance->to, facet.quadric);
        struct orl_vec3 low, high;
        facet.quadric = &curved;
        facet.normal = orl_xform_normal(&instance->to, facet.normal);
        orl_quadric_bounds(&facet, &low, &high);
        orl_box_include(low, &instance->low, &instance->high);
        orl_box_include(high, &instance->low, &instance->high);
    }
}

bool orl_instances_build(struct orl_geometry *geometry, const struct orl_parsed_scene *parsed_scene,
                         struct orl_vec3 *low, struct orl_vec3 *high)
{
    geometry->instance = calloc(parsed_scene->n_placements + 1, sizeof *geometry->instance);
    if (!geometry->instance)
        return false;
    geometry->n_instances = parsed_scene->n_placements;
    for (size_t i = 0; i < geometry->n_instances; i++) {
        const struct orl_placement *const placement = &parsed_scene->placements[i];
        struct orl_geometry *const prototype = geometry->prototypes[placement->prototype];
        struct orl_instance *const instance = &geometry->instance[i];
        struct orl_xform moved = orl_xform_identity;
        moved.offset = prototype->center;
        instance->prototype = prototype;
        instance->number = placement->prototype;
        instance->to = orl_xform_compose(&placement->xform, &moved);
        if (prototype->n_uses++ == 0)
            prototype->first_use = i;
        if (orl_is_cancelled(parsed_scene->cancel))
            continue; /* the caller polls too */
        bound_instance(instance);
        orl_box_include(instance->low, low, high);
        orl_box_include(instance->high, low, high);
    }
    return true;
}

int orl_instances_number(struct orl_geometry *geometry, struct orl_error *err)
{
    uint64_t facets = geometry->n_facets, triangles = orl_geometry_triangles_end(geometry);
    for (size_t i = 0; i < geometry->n_instances; i++) {
        struct orl_instance *const instance = &geometry->instance[i];
        instance->to.offset = orl_sub(instance->to.offset, geometry->center);
        instance->low = orl_sub(instance->low, geometry->center);
        instance->high = orl_sub(instance->high, geometry->center);
        instance->from = orl_xform_inverse(&instance->to);
        /* Rays are rounded to float in the scene, and again in the prototype's coordinates. */
        instance->offset =
            0x1p-20 * (fmax(orl_largest(instance->low), orl_largest(instance->high)) +
                       instance->to.scale * instance->prototype->radius);
        instance->first_facet = (uint32_t)facets;
        instance->first_triangle = (uint32_t)triangles;
        facets += instance->prototype->n_facets;
        triangles += orl_geometry_triangles_end(instance->prototype);
        if (facets + triangles > ORL_LIMIT_INSTANCED_SURFACES)
            return orl_error_set(
                err, ORL_ERR_LIMIT,
                "more than %lu surfaces and triangles, counting those of every instance",
                ORL_LIMIT_INSTANCED_SURFACES);
    }
    return 0;
}
