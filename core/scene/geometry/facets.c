/* Accessors for facets that are packed or instanced; queries on facets and triangles by index. */
#include <stdlib.h>

#include "scene/geometry/geometry.h"
#include "scene/geometry/instances.h"
#include "scene/geometry/packed.h"

uint32_t orl_facet_surface_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (!orl_facet_is_instanced(geometry, facet))
        return orl_facet_surface_packed(geometry, facet);
    const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
    return orl_facet_surface(instance->prototype, facet - instance->first_facet);
}

const struct orl_facet *orl_facet_get_slow(const struct orl_geometry *geometry, size_t facet,
                                           struct orl_facet *room)
{
    if (!orl_facet_is_instanced(geometry, facet))
        return orl_facet_get_packed(geometry, facet, room);
    const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
    return orl_facet_get_own(instance->prototype, facet - instance->first_facet, room);
}

enum orl_surface_kind orl_facet_kind_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_instanced(geometry, facet)) {
        const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
        return orl_facet_kind(instance->prototype, facet - instance->first_facet);
    }
    return geometry->packed->facets[facet].kind;
}

uint32_t orl_facet_material_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_instanced(geometry, facet)) {
        const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
        return orl_facet_material(instance->prototype, facet - instance->first_facet);
    }
    return geometry->packed->facets[facet].material;
}

double orl_facet_clearance_slow(const struct orl_geometry *geometry, uint32_t facet, double side)
{
    const bool instance = orl_facet_is_instanced(geometry, facet);
    const double proxy_offset = instance || !geometry->packed->facets[facet].has_proxy_offset
                                    ? 0
                                    : orl_facet_extra_of(geometry, facet)->proxy_offset;
    return orl_facet_offset_slow(geometry, facet) +
           (proxy_offset * side < 0 ? fabs(proxy_offset) : 0);
}

double orl_facet_offset_slow(const struct orl_geometry *geometry, size_t facet)
{
    return orl_facet_is_instanced(geometry, facet)
               ? orl_instance_of(geometry, (uint32_t)facet)->offset
               : orl_packed_offset(&geometry->packed->facets[facet]);
}

/* Queries by index: extra fields, areas, outlines. */

size_t orl_geometry_count_triangles(const struct orl_geometry *geometry)
{
    size_t n = 0;
    for (size_t i = 0; i < orl_geometry_triangles_end(geometry); i++)
        n += !orl_triangle_is_unused(geometry, i);
    return n;
}

const struct orl_facet_extra *orl_facet_extra_of(const struct orl_geometry *geometry,
                                                 uint32_t facet)
{
    size_t low = 0, high = geometry->n_extra;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (geometry->extra[middle].facet <= facet)
            low = middle;
        else
            high = middle;
    }
    return &geometry->extra[low];
}

/* Reconstructs the outline from the triangles: the first one ends where the outline begins (corners
 * are cut off so in triangulate.c). */
static struct orl_facet_outline implied_outline(const struct orl_geometry *g,
                                                const struct orl_facet *f)
{
    const uint32_t first = orl_facet_triangle(f, 0);
    struct orl_facet_outline outline = {
        .corners = g->corners,
        .at = {orl_triangle_corner(g, first, 1), orl_triangle_corner(g, first, 2)},
        .n = f->n_triangles + 2,
        .geometry = g};
    if (f->n_triangles == 2)
        outline.at[2] = orl_triangle_corner(g, orl_facet_triangle(f, 1), 1);
    outline.at[f->n_triangles + 1] = orl_triangle_corner(g, first, 0);
    return outline;
}

struct orl_facet_outline orl_outline_of_facet_slow(const struct orl_geometry *geometry,
                                                   uint32_t facet)
{
    const struct orl_stored_outline *const outlines = geometry->outlines.items;
    struct orl_facet own;
    const struct orl_facet *const f = orl_facet_get_own(geometry, facet, &own);
    size_t low = 0, high = geometry->outlines.n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (outlines[middle].facet < facet)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == geometry->outlines.n || outlines[low].facet != facet)
        return f->n_triangles > 0 ? implied_outline(geometry, f)
                                  : (struct orl_facet_outline){.geometry = geometry};
    return (struct orl_facet_outline){.corners = geometry->corners,
                                      .own = geometry->outlines.corners + outlines[low].first,
                                      .n = outlines[low].n,
                                      .geometry = geometry};
}

/* Above this, the listed triangles would add a sixth to the memory of the quads. */
static const size_t few_couples = 1 << 15;

/* Lists the outlines of all facets, in the files' order. */
static bool list_outlines(struct orl_geometry *g)
{
    struct orl_stored_outline *const outlines = malloc((g->n_facets + 1) * sizeof *outlines);
    uint32_t n_corners = 0, *corners = NULL;
    for (uint32_t i = 0; outlines && i < g->n_facets; i++) {
        outlines[i] = (struct orl_stored_outline){i, n_corners, orl_outline_of_facet_slow(g, i).n};
        n_corners += outlines[i].n;
    }
    corners = malloc(((size_t)n_corners + 1) * sizeof *corners);
    if (!outlines || !corners) {
        free(outlines);
        free(corners);
        return false;
    }
    for (uint32_t i = 0; i < g->n_facets; i++) {
        const struct orl_facet_outline outline = orl_outline_of_facet_slow(g, i);
        for (uint32_t k = 0; k < outline.n; k++)
            corners[outlines[i].first + k] = outline.own ? outline.own[k] : outline.at[k];
    }
    free(g->outlines.items);
    free(g->outlines.corners);
    g->outlines = (struct orl_stored_outlines){outlines, g->n_facets, corners, n_corners};
    return true;
}

bool orl_geometry_index_triangles(struct orl_geometry *geometry)
{
    const size_t n = orl_geometry_triangles_end(geometry);
    if (geometry->n_quads >= few_couples)
        return true;
    struct orl_indexed_triangle *const triangle_index = malloc((n + 1) * sizeof *triangle_index);
    geometry->areas = malloc((n + 1) * sizeof *geometry->areas);
    if (!triangle_index || !geometry->areas || !list_outlines(geometry)) {
        free(triangle_index);
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        const struct orl_triangle t = orl_triangle_get_own(geometry, i);
        geometry->areas[i] = orl_triangle_area(&t);
        triangle_index[i].facet = orl_triangle_facet(geometry, i);
        for (unsigned k = 0; k < 3; k++)
            triangle_index[i].corners[k] = orl_triangle_corner(geometry, i, k);
    }
    geometry->triangle_index = triangle_index;
    return true;
}
