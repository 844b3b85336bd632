#include "scene/geometry/geometry.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/crew.h>
#include <oriel/limits.h>

#include "base/grow.h"
#include "scene/geometry/antimatter.h"
#include "scene/geometry/corners.h"
#include "scene/geometry/couples.h"
#include "scene/geometry/embree.h"
#include "scene/geometry/packed.h"
#include "scene/geometry/placed.h"
#include "scene/geometry/quadric.h"
#include "scene/geometry/triangulate.h"

static void include_point(struct orl_vec3 p, struct orl_vec3 *low, struct orl_vec3 *high)
{
    *low = orl_v3(fmin(low->x, p.x), fmin(low->y, p.y), fmin(low->z, p.z));
    *high = orl_v3(fmax(high->x, p.x), fmax(high->y, p.y), fmax(high->z, p.z));
}

static double largest(struct orl_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

/* Sets a quadric facet from its surface; `round` stores its centres and radii. */
static void fill_curved(struct orl_facet *facet, const struct orl_surface *surface,
                        struct orl_curved *round)
{
    *round = *surface->round;
    if (surface->kind == ORL_SURFACE_CYLINDER || surface->kind == ORL_SURFACE_TUBE)
        round->radius[1] = round->radius[0];
    facet->normal = surface->normal;
    facet->round = round;
}

static void bounds_of(const struct orl_surface *surface, struct orl_vec3 *low,
                      struct orl_vec3 *high)
{
    struct orl_facet facet = {.kind = surface->kind};
    struct orl_curved round;
    struct orl_vec3 a, b;
    for (uint32_t i = 0; i < surface->n_vertices; i++)
        include_point(surface->vertices[i], low, high);
    if (surface->kind != ORL_SURFACE_POLYGON) {
        fill_curved(&facet, surface, &round);
        orl_quadric_bounds(&facet, &a, &b);
        include_point(a, low, high);
        include_point(b, low, high);
    }
}

/* State of a build, mostly scratch. */
struct builder {
    struct orl_geometry *g;
    const struct orl_description *description;
    struct orl_triangulation triangulation;
    struct orl_couples couples;
    struct orl_corners corners;
    size_t outlines_room, outline_corners_room;
    struct orl_error *err;
};

static int refuse_outline(const struct builder *b, const struct orl_surface *surface, int code)
{
    char name[ORL_ERROR_NAME_MAX];
    if (code == ORL_ERR_NOMEM)
        return code;
    snprintf(name, sizeof name, "polygon %.200s", surface->name);
    if (code == ORL_ERR_LIMIT)
        orl_error_set(
            b->err, code,
            "its outline crosses itself more than %u times, or in too many places at once",
            ORL_LIMIT_POLYGON_CROSSINGS);
    else
        orl_error_set(b->err, code, "its outline could not be cut into triangles");
    orl_error_at(b->err, surface->file, surface->line, name);
    return code;
}

/* Replaces the corner indices of the triangulation by the geometry's. */
static bool number_corners(struct builder *b)
{
    const struct orl_triangulation *const cut = &b->triangulation;
    for (size_t i = 0; i < 3 * cut->n_triples; i++) {
        uint32_t *const corner = &cut->triples[i / 3][i % 3];
        if (!orl_corners_add(&b->corners, orl_sub(cut->corners[*corner], b->g->center), corner))
            return false;
    }
    return true;
}

/* Returns true if the triangles determine the outline: three or four corners, cut off one by one
 * (triangulate.c). */
static bool is_outline_implied(const struct orl_triangulation *cut,
                               const struct orl_surface *surface)
{
    static const uint32_t three[1][3] = {{2, 0, 1}}, four[2][3] = {{3, 0, 1}, {1, 2, 3}};
    const uint32_t n = surface->n_vertices;
    return cut->corners == surface->vertices &&
           ((n == 3 && cut->n_triples == 1 && memcmp(cut->triples, three, sizeof three) == 0) ||
            (n == 4 && cut->n_triples == 2 && memcmp(cut->triples, four, sizeof four) == 0));
}

static bool keep_outline(struct builder *b, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_geometry *const g = b->g;
    if (!orl_grow(&g->outlines, &b->outlines_room, g->n_outlines, sizeof *g->outlines))
        return false;
    g->outlines[g->n_outlines++] =
        (struct orl_own_outline){facet, (uint32_t)g->n_outline_corners, surface->n_vertices};
    for (uint32_t i = 0; i < surface->n_vertices; i++)
        if (!orl_grow(&g->outline_corners, &b->outline_corners_room, g->n_outline_corners,
                      sizeof *g->outline_corners) ||
            !orl_corners_add(&b->corners, orl_sub(surface->vertices[i], g->center),
                             &g->outline_corners[g->n_outline_corners++]))
            return false;
    return true;
}

/* Triangulates a polygon in moved coordinates, and sets its area and offset. */
static int add_polygon(struct builder *b, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_geometry *g = b->g;
    struct orl_facet *f = &g->facets[facet];
    const struct orl_triangulation *cut = &b->triangulation;
    double reach = 0, bend = 0;
    const int code =
        orl_triangulate(&b->triangulation, surface->vertices, surface->n_vertices, surface->normal);
    if (code < 0)
        return refuse_outline(b, surface, code);
    f->normal = surface->normal;
    for (size_t i = 0; i < cut->n_triples; i++) {
        const uint32_t *triple = cut->triples[i];
        const struct orl_triangle t = {orl_sub(cut->corners[triple[0]], g->center),
                                       orl_sub(cut->corners[triple[1]], g->center),
                                       orl_sub(cut->corners[triple[2]], g->center)};
        f->area += orl_triangle_area(&t);
        reach = fmax(reach, fmax(largest(t.a), fmax(largest(t.b), largest(t.c))));
        bend = fmax(bend, fmax(fabs(orl_dot(orl_sub(t.b, t.a), f->normal)),
                               fabs(orl_dot(orl_sub(t.c, t.a), f->normal))));
    }
    f->offset = reach * 0x1p-20;
    f->bent = bend > reach * 0x1p-23;
    const bool told = is_outline_implied(cut, surface);
    return number_corners(b) &&
                   orl_couples_add(&b->couples, facet, cut->triples, (uint32_t)cut->n_triples) &&
                   (told || keep_outline(b, surface, facet))
               ? 0
               : ORL_ERR_NOMEM;
}

static void add_curved(struct orl_geometry *g, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_facet *f = &g->facets[facet];
    struct orl_curved *round = &g->rounds[g->n_facets - 1 - facet];
    struct orl_vec3 low, high;
    fill_curved(f, surface, round);
    for (int k = 0; k < 2; k++)
        round->center[k] = orl_sub(round->center[k], g->center);
    orl_quadric_bounds(f, &low, &high);
    f->area = orl_quadric_area(f);
    f->offset = fmax(largest(low), largest(high)) * 0x1p-20;
}

/* Polygons come first and curved facets last, so that Embree's indices map by arithmetic. */
static int add_facets(struct builder *b)
{
    struct orl_geometry *g = b->g;
    const struct orl_description *d = b->description;
    size_t polygon = 0, curved = d->n_surfaces;
    int code = 0;
    for (size_t i = 0; i < d->n_surfaces && code == 0; i++) {
        const struct orl_surface *surface = &d->surfaces[i];
        const bool flat = surface->kind == ORL_SURFACE_POLYGON;
        const uint32_t facet = (uint32_t)(flat ? polygon++ : --curved);
        g->facets[facet].kind = surface->kind;
        g->facets[facet].material = surface->material;
        g->facets[facet].surface = (uint32_t)i;
        g->facets[facet].round = &orl_curved_none;
        g->facets[facet].stands_off = d->materials[surface->material].thickness != 0;
        g->facets[facet].has_more = g->facets[facet].stands_off;
        if (flat)
            code = add_polygon(b, surface, facet);
        else
            add_curved(g, surface, facet);
        if (orl_is_cancelled(d->cancel))
            code = ORL_ERR_CANCELLED;
    }
    return code;
}

/* Marks the facets that have rivals, and makes the list of orl_facet_more. */
static bool list_more(struct orl_geometry *g, const struct orl_description *d,
                      const uint32_t *facet_of)
{
    size_t n = 0;
    for (size_t i = 0; i < 2 * d->n_opposed; i++)
        g->facets[facet_of[d->opposed[i / 2].surfaces[i % 2]]].has_more = true;
    for (size_t i = 0; i < g->n_facets; i++)
        n += g->facets[i].has_more;
    g->more = calloc(n + 1, sizeof *g->more);
    for (size_t i = 0; g->more && i < g->n_facets; i++)
        if (g->facets[i].has_more)
            g->more[g->n_more++] = (struct orl_facet_more){
                (uint32_t)i, 0, 0, d->materials[g->facets[i].material].thickness};
    return g->more != NULL;
}

static struct orl_facet_more *more_of(struct orl_geometry *g, uint32_t facet)
{
    return &g->more[orl_facet_more_of(g, facet) - g->more];
}

static bool add_rivals(struct orl_geometry *g, const struct orl_description *d,
                       const uint32_t *facet_of)
{
    g->rivals = malloc((2 * d->n_opposed + 1) * sizeof *g->rivals);
    if (!g->rivals)
        return false;
    for (size_t i = 0; i < 2 * d->n_opposed; i++)
        more_of(g, facet_of[d->opposed[i / 2].surfaces[i % 2]])->n_rivals++;
    for (size_t i = 0; i < g->n_more; i++) {
        g->more[i].first_rival = (uint32_t)g->n_rivals;
        g->n_rivals += g->more[i].n_rivals;
        g->more[i].n_rivals = 0;
    }
    for (size_t i = 0; i < 2 * d->n_opposed; i++) {
        struct orl_facet_more *const more = more_of(g, facet_of[d->opposed[i / 2].surfaces[i % 2]]);
        g->rivals[more->first_rival + more->n_rivals++] =
            facet_of[d->opposed[i / 2].surfaces[1 - i % 2]];
    }
    return true;
}

static int add_more(struct orl_geometry *g, const struct orl_description *d)
{
    uint32_t *const facet_of = malloc((d->n_surfaces + 1) * sizeof *facet_of);
    for (size_t i = 0; facet_of && i < g->n_facets; i++)
        facet_of[g->facets[i].surface] = (uint32_t)i;
    const bool made = facet_of && list_more(g, d, facet_of) && add_rivals(g, d, facet_of);
    free(facet_of);
    return made ? 0 : ORL_ERR_NOMEM;
}

/* Returns a description of one prototype; it borrows everything. */
static struct orl_description prototype_description(const struct orl_description *d,
                                                    size_t prototype)
{
    const struct orl_prototype *const p = &d->prototypes[prototype];
    struct orl_description part = *d;
    part.surfaces = p->surfaces;
    part.n_surfaces = p->n_surfaces;
    part.opposed = p->opposed;
    part.n_opposed = p->n_opposed;
    part.n_prototypes = part.n_placements = 0;
    return part;
}

static int build_prototypes(struct orl_geometry *g, const struct orl_description *d,
                            struct orl_error *err)
{
    int code = 0;
    g->prototypes = calloc(d->n_prototypes + 1, sizeof(struct orl_geometry *));
    if (!g->prototypes)
        return ORL_ERR_NOMEM;
    for (; g->n_prototypes < d->n_prototypes && code == 0; g->n_prototypes++) {
        const struct orl_description part = prototype_description(d, g->n_prototypes);
        code = orl_geometry_new(&part, &g->prototypes[g->n_prototypes], err);
    }
    return code;
}

static int measure_scene(struct orl_geometry *g, const struct orl_description *d,
                         struct orl_error *err)
{
    struct orl_vec3 low = orl_v3(INFINITY, INFINITY, INFINITY), high = orl_neg(low);
    for (size_t i = 0; i < d->n_surfaces; i++) {
        bounds_of(&d->surfaces[i], &low, &high);
        g->n_rounds += d->surfaces[i].kind != ORL_SURFACE_POLYGON;
    }
    int code = build_prototypes(g, d, err);
    if (code == 0 && !orl_placed_measure(g, d, &low, &high))
        code = ORL_ERR_NOMEM;
    if (code == 0 && d->n_placements > 0 && orl_is_cancelled(d->cancel))
        code = ORL_ERR_CANCELLED;
    if (d->n_surfaces + d->n_placements == 0)
        low = high = orl_v3(0, 0, 0);
    g->center = orl_scale(orl_add(low, high), 0.5);
    g->low = orl_sub(low, g->center);
    g->high = orl_sub(high, g->center);
    g->radius = orl_length(g->high);
    return code;
}

int orl_geometry_prepare_thread(struct orl_error *err)
{
    return orl_embree_prepare(err);
}

int orl_geometry_new(const struct orl_description *description, struct orl_geometry **ret_geometry,
                     struct orl_error *err)
{
    int code = ORL_ERR_NOMEM;
    struct orl_geometry *g = calloc(1, sizeof *g);
    struct builder builder = {.g = g, .description = description, .err = err};
    if (!g)
        goto done;
    if (description->n_surfaces > ORL_LIMIT_SURFACES) {
        code = orl_error_set(err, ORL_ERR_LIMIT, "%zu surfaces; at most %lu are allowed",
                             description->n_surfaces, ORL_LIMIT_SURFACES);
        goto done;
    }
    code = measure_scene(g, description, err);
    if (code < 0)
        goto done;
    code = ORL_ERR_NOMEM;
    g->n_facets = g->n_plain = description->n_surfaces;
    g->facets = calloc(g->n_facets + 1, sizeof *g->facets);
    g->rounds = malloc((g->n_rounds + 1) * sizeof *g->rounds);
    builder.couples.geometry = g;
    if (!g->facets || !g->rounds || !orl_corners_init(&builder.corners, g))
        goto done;
    code = add_facets(&builder);
    if (code == 0)
        code = add_more(g, description);
    if (code == 0)
        code = orl_placed_number(g, err);
    if (code == 0 && !(orl_geometry_list_triangles(g) && orl_geometry_pack(g)))
        code = ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_embree_build(g, description->cancel, err);
    if (code == 0)
        code = orl_holes_build(g, description, err);
done:
    orl_triangulation_done(&builder.triangulation);
    orl_corners_done(&builder.corners);
    if (code == 0)
        *ret_geometry = g;
    else
        orl_geometry_free(g);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene's geometry");
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while building the scene's geometry");
    return code;
}
