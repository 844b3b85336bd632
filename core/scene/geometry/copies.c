/* Subsets of geometries, and freeing of geometries. */
#include "scene/geometry/antimatter.h"

#include <stdlib.h>
#include <string.h>

#include "scene/geometry/embree.h"
#include "scene/geometry/packed.h"

/* Returns a couple whose first triangle is the second of the given one. */
static struct orl_couple second_alone(const struct orl_couple *couple)
{
    return (struct orl_couple){
        .corners = {couple->corners[2], couple->corners[3], couple->corners[1], couple->corners[1]},
        .facet = orl_couple_facet(couple, true) & 0x7ffffffU,
        .turn = couple->turn_of_second,
    };
}

/* Copies the couples of which a half is kept; facets get their triangles' new indices. */
static void keep_couples(struct orl_geometry *g, const struct orl_geometry *whole, const bool *keep)
{
    for (size_t i = 0; i < whole->n_couples; i++) {
        const struct orl_couple *const from = &whole->couples[i];
        struct orl_couple *const to = &g->couples[g->n_couples];
        const uint32_t facets[2] = {from->facet, orl_couple_facet(from, true)};
        const bool first = keep[facets[0]], second = keep[facets[1]];
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
            if (keep[facets[half]] &&
                g->facets[facets[half]].first_triangle == 2 * i + (size_t)half)
                g->facets[facets[half]].first_triangle =
                    (uint32_t)(2 * g->n_couples) + (half == 1 && first);
        g->n_couples++;
    }
}

int orl_geometry_subset(const struct orl_geometry *whole, const bool *keep,
                        struct orl_geometry **ret_geometry, struct orl_error *err)
{
    struct orl_geometry *g = malloc(sizeof *g);
    int code = ORL_ERR_NOMEM;
    if (!g)
        return orl_error_set(err, code, "out of memory for the scene's geometry");
    *g = *whole;
    orl_holes_hold(g->holes);
    g->scene = NULL;
    g->prototypes = NULL;
    g->placed = NULL;
    g->n_prototypes = g->n_placed = 0;
    g->n_couples = 0;
    g->met = NULL;
    g->areas = NULL;
    g->listed = NULL;
    g->packed = NULL;
    g->n_plain = g->n_facets;
    g->rivals = malloc((g->n_rivals + 1) * sizeof *g->rivals);
    g->more = malloc((g->n_more + 1) * sizeof *g->more);
    g->facets = malloc((g->n_facets + 1) * sizeof *g->facets);
    g->rounds = malloc((g->n_rounds + 1) * sizeof *g->rounds);
    g->couples = malloc((whole->n_couples + 1) * sizeof *g->couples);
    g->corners = malloc((g->n_corners + 1) * sizeof *g->corners);
    g->outlines = malloc((g->n_outlines + 1) * sizeof *g->outlines);
    g->outline_corners = malloc((g->n_outline_corners + 1) * sizeof *g->outline_corners);
    if (!g->outlines || !g->outline_corners || !g->facets || !g->rounds || !g->couples ||
        !g->corners || !g->rivals || !g->more)
        goto done;
    if (g->n_outlines > 0) {
        memcpy(g->outlines, whole->outlines, g->n_outlines * sizeof *g->outlines);
        memcpy(g->outline_corners, whole->outline_corners,
               g->n_outline_corners * sizeof *g->outline_corners);
    }
    if (g->n_more > 0)
        memcpy(g->more, whole->more, g->n_more * sizeof *g->more);
    if (g->n_rivals > 0)
        memcpy(g->rivals, whole->rivals, g->n_rivals * sizeof *g->rivals);
    memcpy(g->rounds, whole->rounds, g->n_rounds * sizeof *g->rounds);
    orl_geometry_unpack(whole, g->facets, g->corners);
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet *f = &g->facets[i];
        if (f->kind != ORL_SURFACE_POLYGON)
            f->round = &g->rounds[g->n_facets - 1 - i];
        f->area = keep[i] ? f->area : 0;
        f->n_triangles = keep[i] ? f->n_triangles : 0;
    }
    keep_couples(g, whole, keep);
    code = orl_geometry_list_triangles(g) && orl_geometry_pack(g) ? orl_embree_build(g, NULL, err)
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
    free(geometry->placed);
    orl_holes_release(geometry->holes);
    free(geometry->facets);
    free(geometry->rounds);
    free(geometry->couples);
    free(geometry->met);
    free(geometry->areas);
    free(geometry->listed);
    free(geometry->corners);
    orl_packed_free(geometry->packed);
    free(geometry->outlines);
    free(geometry->outline_corners);
    free(geometry->rivals);
    free(geometry->more);
    free(geometry);
}

struct orl_holes *orl_holes_hold(struct orl_holes *holes)
{
    if (holes)
        atomic_fetch_add_explicit(&holes->holders, 1, memory_order_relaxed);
    return holes;
}

void orl_holes_release(struct orl_holes *holes)
{
    if (!holes || atomic_fetch_sub_explicit(&holes->holders, 1, memory_order_acq_rel) > 1)
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
