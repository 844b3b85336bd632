#include "scene/geometry/placed.h"

#include <stdlib.h>

#include <oriel/crew.h>
#include <oriel/limits.h>

#include "scene/geometry/quadric.h"

/* ---- By index
 * --------------------------------------------------------------------------------- */

/* Returns the last instance whose first facet is not above the given one. */
const struct orl_placed *orl_placed_of(const struct orl_geometry *geometry, uint32_t facet)
{
    size_t low = 0, high = geometry->n_placed;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (geometry->placed[middle].first_facet <= facet)
            low = middle;
        else
            high = middle;
    }
    return &geometry->placed[low];
}

static const struct orl_placed *of_triangle(const struct orl_geometry *geometry, size_t triangle)
{
    size_t low = 0, high = geometry->n_placed;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (geometry->placed[middle].first_triangle <= triangle)
            low = middle;
        else
            high = middle;
    }
    return &geometry->placed[low];
}

struct orl_triangle orl_placed_triangle(const struct orl_geometry *geometry, size_t index)
{
    const struct orl_placed *const placed = of_triangle(geometry, index);
    const struct orl_triangle t =
        orl_triangle_of(placed->prototype, index - placed->first_triangle);
    return (struct orl_triangle){orl_xform_point(&placed->to, t.a),
                                 orl_xform_point(&placed->to, t.b),
                                 orl_xform_point(&placed->to, t.c)};
}

struct orl_facet orl_facet_at(const struct orl_geometry *geometry, uint32_t facet,
                              struct orl_curved *room)
{
    struct orl_facet own;
    if (facet < geometry->n_facets)
        return *orl_facet_own(geometry, facet, &own);
    const struct orl_placed *const placed = orl_placed_of(geometry, facet);
    struct orl_facet f = *orl_facet_own(placed->prototype, facet - placed->first_facet, &own);
    if (f.kind != ORL_SURFACE_POLYGON) {
        *room = orl_xform_curved(&placed->to, f.round);
        f.round = room;
    }
    f.kind = orl_xform_kind(&placed->to, f.kind);
    f.normal = orl_xform_normal(&placed->to, f.normal);
    f.offset = placed->offset;
    f.area *= placed->to.scale * placed->to.scale;
    f.first_triangle += placed->first_triangle;
    f.has_more = f.stands_off = false;
    return f;
}

struct orl_kept_walk orl_kept_walk(const struct orl_geometry *geometry)
{
    return (struct orl_kept_walk){.geometry = geometry, .part = geometry, .places = 1};
}

bool orl_kept_next(struct orl_kept_walk *walk)
{
    const struct orl_geometry *const g = walk->geometry;
    while (walk->next == walk->part->n_facets) {
        if (walk->next_prototype == g->n_prototypes)
            return false;
        walk->part = g->prototypes[walk->next_prototype++];
        walk->places = walk->part->n_places;
        walk->next = 0;
    }
    const uint32_t first = walk->part == g ? 0 : g->placed[walk->part->first_place].first_facet;
    walk->facet = first + (uint32_t)walk->next++;
    return true;
}

void orl_placed_hit(const struct orl_geometry *geometry, const struct orl_placed *placed,
                    struct orl_vec3 origin, struct orl_vec3 direction, struct orl_hit *hit)
{
    struct orl_facet own;
    const bool round =
        orl_facet_own(placed->prototype, hit->facet, &own)->kind != ORL_SURFACE_POLYGON;
    hit->distance *= placed->to.scale;
    hit->point = orl_madd(origin, direction, hit->distance);
    hit->normal = orl_xform_normal(&placed->to, hit->normal);
    hit->facet += placed->first_facet;
    hit->triangle = round ? 0 : hit->triangle + placed->first_triangle;
    hit->instance = (uint32_t)(placed - geometry->placed) + 1;
    hit->front = hit->front != placed->to.inverted;
}

struct orl_hit orl_placed_as_read(const struct orl_geometry *geometry, const struct orl_hit *hit)
{
    const struct orl_placed *const placed = &geometry->placed[hit->instance - 1];
    struct orl_hit read = *hit;
    read.point = orl_add(orl_xform_point(&placed->from, hit->point),
                         orl_sub(placed->prototype->center, geometry->center));
    read.normal = orl_xform_normal(&placed->from, hit->normal);
    read.instance = 0;
    return read;
}

struct orl_vec3 orl_placed_direction_read(const struct orl_geometry *geometry,
                                          const struct orl_hit *hit, struct orl_vec3 direction)
{
    return orl_xform_direction(&geometry->placed[hit->instance - 1].from, direction);
}

struct orl_vec3 orl_placed_direction(const struct orl_geometry *geometry, const struct orl_hit *hit,
                                     struct orl_vec3 read)
{
    return orl_xform_direction(&geometry->placed[hit->instance - 1].to, read);
}

/* ---- Building -------------------------------------------------------------------------------- */

static void include_point(struct orl_vec3 p, struct orl_vec3 *low, struct orl_vec3 *high)
{
    *low = orl_v3(fmin(low->x, p.x), fmin(low->y, p.y), fmin(low->z, p.z));
    *high = orl_v3(fmax(high->x, p.x), fmax(high->y, p.y), fmax(high->z, p.z));
}

/* Bounds of the transformed corners, which are tighter than a rotated box. */
static void bound_instance(struct orl_placed *placed)
{
    const struct orl_geometry *const g = placed->prototype;
    placed->low = orl_v3(INFINITY, INFINITY, INFINITY);
    placed->high = orl_neg(placed->low);
    for (size_t i = 0; i < g->n_corners; i++)
        include_point(orl_xform_point(&placed->to, orl_corner_of(g, i)), &placed->low,
                      &placed->high);
    for (size_t i = 0; i < g->n_rounds; i++) {
        struct orl_facet own, facet = *orl_facet_own(g, g->n_facets - 1 - i, &own);
        const struct orl_curved curved = orl_xform_curved(&placed->to, facet.round);
        struct orl_vec3 low, high;
        facet.round = &curved;
        facet.normal = orl_xform_normal(&placed->to, facet.normal);
        orl_quadric_bounds(&facet, &low, &high);
        include_point(low, &placed->low, &placed->high);
        include_point(high, &placed->low, &placed->high);
    }
}

bool orl_placed_measure(struct orl_geometry *geometry, const struct orl_description *description,
                        struct orl_vec3 *low, struct orl_vec3 *high)
{
    geometry->placed = calloc(description->n_placements + 1, sizeof *geometry->placed);
    if (!geometry->placed)
        return false;
    geometry->n_placed = description->n_placements;
    for (size_t i = 0; i < geometry->n_placed; i++) {
        const struct orl_placement *const placement = &description->placements[i];
        struct orl_geometry *const prototype = geometry->prototypes[placement->prototype];
        struct orl_placed *const placed = &geometry->placed[i];
        struct orl_xform moved = orl_xform_identity;
        moved.offset = prototype->center;
        placed->prototype = prototype;
        placed->number = placement->prototype;
        placed->to = orl_xform_compose(&placement->xform, &moved);
        if (prototype->n_places++ == 0)
            prototype->first_place = i;
        if (orl_is_cancelled(description->cancel))
            continue; /* the caller polls too */
        bound_instance(placed);
        include_point(placed->low, low, high);
        include_point(placed->high, low, high);
    }
    return true;
}

static double largest(struct orl_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

int orl_placed_number(struct orl_geometry *geometry, struct orl_error *err)
{
    uint64_t facets = geometry->n_facets, triangles = orl_geometry_triangles_end(geometry);
    for (size_t i = 0; i < geometry->n_placed; i++) {
        struct orl_placed *const placed = &geometry->placed[i];
        placed->to.offset = orl_sub(placed->to.offset, geometry->center);
        placed->low = orl_sub(placed->low, geometry->center);
        placed->high = orl_sub(placed->high, geometry->center);
        placed->from = orl_xform_inverse(&placed->to);
        /* Rays are rounded to float in the scene, and again in the prototype's coordinates. */
        placed->offset = 0x1p-20 * (fmax(largest(placed->low), largest(placed->high)) +
                                    placed->to.scale * placed->prototype->radius);
        placed->first_facet = (uint32_t)facets;
        placed->first_triangle = (uint32_t)triangles;
        facets += placed->prototype->n_facets;
        triangles += orl_geometry_triangles_end(placed->prototype);
        if (facets + triangles > ORL_LIMIT_PLACED_SURFACES)
            return orl_error_set(err, ORL_ERR_LIMIT,
                                 "more than %lu surfaces and triangles, those of instances counted "
                                 "in each place",
                                 ORL_LIMIT_PLACED_SURFACES);
    }
    return 0;
}
