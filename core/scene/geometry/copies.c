/* Subsets of geometries and of their holes; freeing of both. */
#include "scene/geometry/antimatter/antimatter.h"

#include <stdlib.h>
#include <string.h>

#include "scene/geometry/intersect.h"
#include "scene/geometry/packed.h"

/* Returns a quad whose first triangle is the second of the given one. */
static struct orl_mesh_quad second_alone(const struct orl_mesh_quad *quad)
{
    return (struct orl_mesh_quad){
        .corners = {quad->corners[2], quad->corners[3], quad->corners[1], quad->corners[1]},
        .facet = orl_mesh_quad_facet(quad, true) & 0x7ffffffU,
        .rotation = quad->second_rotation,
    };
}

/* Copies the quads of which a half remains; facets get their triangles' new indices. */
static void copy_quads(struct orl_geometry *g, const struct orl_geometry *whole,
                       const bool *remains)
{
    for (size_t i = 0; i < whole->n_quads; i++) {
        const struct orl_mesh_quad *const from = &whole->quads[i];
        struct orl_mesh_quad *const to = &g->quads[g->n_quads];
        const uint32_t facets[2] = {from->facet, orl_mesh_quad_facet(from, true)};
        const bool first = remains[facets[0]], second = remains[facets[1]];
        if (!first && !second)
            continue;
        *to = first ? *from : second_alone(from);
        if (first && !second) {
            to->corners[2] = to->corners[3];
            to->next = 0;
        }
        for (int half = 0; half < 2; half++)
            /* Tests against the index in the whole geometry; indices assigned here are not
             * greater. */
            if (remains[facets[half]] &&
                g->facets[facets[half]].first_triangle == 2 * i + (size_t)half)
                g->facets[facets[half]].first_triangle =
                    (uint32_t)(2 * g->n_quads) + (half == 1 && first);
        g->n_quads++;
    }
}

static void *copy_array(const void *items, size_t n, size_t size)
{
    void *const copy = malloc((n + 1) * size);
    if (copy && n > 0)
        memcpy(copy, items, n * size);
    return copy;
}

int orl_geometry_subset(const struct orl_geometry *whole, const bool *remains,
                        struct orl_geometry **ret_geometry, struct orl_error *err)
{
    struct orl_geometry *g = malloc(sizeof *g);
    int code = ORL_ERR_NOMEM;
    if (!g)
        return orl_error_set(err, code, "out of memory for the scene's geometry");
    *g = *whole;
    if (g->holes)
        atomic_fetch_add_explicit(&g->holes->references, 1, memory_order_relaxed);
    g->scene = NULL;
    g->prototypes = NULL;
    g->instance = NULL;
    g->n_prototypes = g->n_instances = 0;
    g->n_quads = 0;
    g->triangle_of_primitive = NULL;
    g->areas = NULL;
    g->triangle_index = NULL;
    g->packed = NULL;
    g->n_unpacked_facets = g->n_facets;
    g->opposite_facets =
        copy_array(g->opposite_facets, g->n_opposite_facets, sizeof *g->opposite_facets);
    g->extra = copy_array(g->extra, g->n_extra, sizeof *g->extra);
    g->quadrics = copy_array(g->quadrics, g->n_quadrics, sizeof *g->quadrics);
    g->outlines.items = copy_array(g->outlines.items, g->outlines.n, sizeof *g->outlines.items);
    g->outlines.corners =
        copy_array(g->outlines.corners, g->outlines.n_corners, sizeof *g->outlines.corners);
    g->facets = malloc((g->n_facets + 1) * sizeof *g->facets);
    g->quads = malloc((whole->n_quads + 1) * sizeof *g->quads);
    g->corners = malloc((g->n_corners + 1) * sizeof *g->corners);
    if (!g->outlines.items || !g->outlines.corners || !g->facets || !g->quadrics || !g->quads ||
        !g->corners || !g->opposite_facets || !g->extra)
        goto done;
    orl_geometry_unpack(whole, g->facets, g->corners);
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet *f = &g->facets[i];
        if (f->kind != ORL_SURFACE_POLYGON)
            f->quadric = &g->quadrics[g->n_facets - 1 - i];
        f->area = remains[i] ? f->area : 0;
        f->n_triangles = remains[i] ? f->n_triangles : 0;
    }
    copy_quads(g, whole, remains);
    code = orl_geometry_index_triangles(g) && orl_geometry_pack(g) ? orl_embree_build(g, NULL, err)
                                                                   : ORL_ERR_NOMEM;
done:
    if (code == 0)
        *ret_geometry = g;
    else
        orl_geometry_free(g);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene's geometry");
    return code;
}

void orl_geometry_free(struct orl_geometry *geometry)
{
    if (!geometry)
        return;
    orl_embree_free(geometry);
    for (size_t i = 0; i < geometry->n_prototypes; i++)
        orl_geometry_free(geometry->prototypes[i]);
    free(geometry->prototypes);
    free(geometry->instance);
    orl_holes_unref(geometry->holes);
    free(geometry->facets);
    free(geometry->quadrics);
    free(geometry->quads);
    free(geometry->triangle_of_primitive);
    free(geometry->areas);
    free(geometry->triangle_index);
    free(geometry->corners);
    orl_packed_free(geometry->packed);
    free(geometry->outlines.items);
    free(geometry->outlines.corners);
    free(geometry->opposite_facets);
    free(geometry->extra);
    free(geometry);
}

void orl_holes_unref(struct orl_holes *holes)
{
    if (!holes || atomic_fetch_sub_explicit(&holes->references, 1, memory_order_acq_rel) > 1)
        return;
    for (size_t i = 0; i < holes->n; i++) {
        orl_geometry_free(holes->items[i].shell);
        orl_geometry_free(holes->items[i].matter);
        free(holes->items[i].cuts);
    }
    free(holes->items);
    free(holes->of_facet);
    free(holes);
}
