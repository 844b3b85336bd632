#include "scene/geometry/geometry.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"
#include "scene/geometry/antimatter/antimatter.h"
#include "scene/geometry/instances.h"
#include "scene/geometry/intersect.h"
#include "scene/geometry/packed.h"
#include "scene/geometry/triangulation/triangulate.h"

/* Sets a quadric facet from its surface; `quadric` stores its centres and radii. */
static void fill_curved(struct orl_facet *facet, const struct orl_surface *surface,
                        struct orl_quadric *quadric)
{
    *quadric = *surface->quadric;
    if (surface->kind == ORL_SURFACE_CYLINDER || surface->kind == ORL_SURFACE_TUBE)
        quadric->radius[1] = quadric->radius[0];
    facet->normal = surface->normal;
    facet->quadric = quadric;
}

static void bounds_of(const struct orl_surface *surface, struct orl_vec3 *low,
                      struct orl_vec3 *high)
{
    struct orl_facet facet = {.kind = surface->kind};
    struct orl_quadric quadric;
    struct orl_vec3 a, b;
    for (uint32_t i = 0; i < surface->n_vertices; i++)
        orl_box_include(surface->vertices[i], low, high);
    if (surface->kind != ORL_SURFACE_POLYGON) {
        fill_curved(&facet, surface, &quadric);
        orl_quadric_bounds(&facet, &a, &b);
        orl_box_include(a, low, high);
        orl_box_include(b, low, high);
    }
}

/* State of a build, mostly scratch. */
struct builder {
    struct orl_geometry *g;
    const struct orl_parsed_scene *parsed_scene;
    struct orl_triangulation triangulation;
    struct orl_quad_builder quads;
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
            "its outline crosses itself more than %u times, or at too many points close together",
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
    if (!orl_array_reserve(&g->outlines.items, &b->outlines_room, g->outlines.n,
                           sizeof *g->outlines.items))
        return false;
    g->outlines.items[g->outlines.n++] =
        (struct orl_stored_outline){facet, (uint32_t)g->outlines.n_corners, surface->n_vertices};
    for (uint32_t i = 0; i < surface->n_vertices; i++)
        if (!orl_array_reserve(&g->outlines.corners, &b->outline_corners_room,
                               g->outlines.n_corners, sizeof *g->outlines.corners) ||
            !orl_corners_add(&b->corners, orl_sub(surface->vertices[i], g->center),
                             &g->outlines.corners[g->outlines.n_corners++]))
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
        reach = fmax(reach, fmax(orl_largest(t.a), fmax(orl_largest(t.b), orl_largest(t.c))));
        bend = fmax(bend, fmax(fabs(orl_dot(orl_sub(t.b, t.a), f->normal)),
                               fabs(orl_dot(orl_sub(t.c, t.a), f->normal))));
    }
    f->offset = reach * 0x1p-20;
    f->nonplanar = bend > reach * 0x1p-23;
    const bool told = is_outline_implied(cut, surface);
    return number_corners(b) &&
                   orl_quad_builder_add(&b->quads, facet, cut->triples, (uint32_t)cut->n_triples) &&
                   (told || keep_outline(b, surface, facet))
               ? 0
               : ORL_ERR_NOMEM;
}

static void add_curved(struct orl_geometry *g, const struct orl_surface *surface, uint32_t facet)
{
    struct orl_facet *f = &g->facets[facet];
    struct orl_quadric *quadric = &g->quadrics[g->n_facets - 1 - facet];
    struct orl_vec3 low, high;
    fill_curved(f, surface, quadric);
    for (int k = 0; k < 2; k++)
        quadric->center[k] = orl_sub(quadric->center[k], g->center);
    orl_quadric_bounds(f, &low, &high);
    f->area = orl_quadric_area(f);
    f->offset = fmax(orl_largest(low), orl_largest(high)) * 0x1p-20;
}

/* Polygons come first and curved facets last, so that Embree's indices map by arithmetic. */
static int add_facets(struct builder *b)
{
    struct orl_geometry *g = b->g;
    const struct orl_parsed_scene *d = b->parsed_scene;
    size_t polygon = 0, curved = d->n_surfaces;
    int code = 0;
    for (size_t i = 0; i < d->n_surfaces && code == 0; i++) {
        const struct orl_surface *surface = &d->surfaces[i];
        const bool flat = surface->kind == ORL_SURFACE_POLYGON;
        const uint32_t facet = (uint32_t)(flat ? polygon++ : --curved);
        g->facets[facet].kind = surface->kind;
        g->facets[facet].material = surface->material;
        g->facets[facet].surface = (uint32_t)i;
        g->facets[facet].quadric = &orl_quadric_none;
        g->facets[facet].has_proxy_offset =
            orl_material_thickness(&d->materials[surface->material]) != 0;
        g->facets[facet].has_extra = g->facets[facet].has_proxy_offset;
        if (flat)
            code = add_polygon(b, surface, facet);
        else
            add_curved(g, surface, facet);
        if (orl_is_cancelled(d->cancel))
            code = ORL_ERR_CANCELLED;
    }
    return code;
}

/* Marks the facets that have opposite facets, and makes the list of orl_facet_extra. */
static bool list_extra(struct orl_geometry *g, const struct orl_parsed_scene *d,
                       const uint32_t *facet_of)
{
    size_t n = 0;
    for (size_t i = 0; i < 2 * d->n_opposed; i++)
        g->facets[facet_of[d->opposed[i / 2].surfaces[i % 2]]].has_extra = true;
    for (size_t i = 0; i < g->n_facets; i++)
        n += g->facets[i].has_extra;
    g->extra = calloc(n + 1, sizeof *g->extra);
    for (size_t i = 0; g->extra && i < g->n_facets; i++)
        if (g->facets[i].has_extra)
            g->extra[g->n_extra++] = (struct orl_facet_extra){
                (uint32_t)i, 0, 0, orl_material_thickness(&d->materials[g->facets[i].material])};
    return g->extra != NULL;
}

static struct orl_facet_extra *extra_of(struct orl_geometry *g, uint32_t facet)
{
    return &g->extra[orl_facet_extra_of(g, facet) - g->extra];
}

static bool add_opposite_facets(struct orl_geometry *g, const struct orl_parsed_scene *d,
                                const uint32_t *facet_of)
{
    g->opposite_facets = malloc((2 * d->n_opposed + 1) * sizeof *g->opposite_facets);
    if (!g->opposite_facets)
        return false;
    for (size_t i = 0; i < 2 * d->n_opposed; i++)
        extra_of(g, facet_of[d->opposed[i / 2].surfaces[i % 2]])->n_opposite_facets++;
    for (size_t i = 0; i < g->n_extra; i++) {
        g->extra[i].first_opposite_facet = (uint32_t)g->n_opposite_facets;
        g->n_opposite_facets += g->extra[i].n_opposite_facets;
        g->extra[i].n_opposite_facets = 0;
    }
    for (size_t i = 0; i < 2 * d->n_opposed; i++) {
        struct orl_facet_extra *const extra =
            extra_of(g, facet_of[d->opposed[i / 2].surfaces[i % 2]]);
        g->opposite_facets[extra->first_opposite_facet + extra->n_opposite_facets++] =
            facet_of[d->opposed[i / 2].surfaces[1 - i % 2]];
    }
    return true;
}

static int add_extra(struct orl_geometry *g, const struct orl_parsed_scene *d)
{
    uint32_t *const facet_of = malloc((d->n_surfaces + 1) * sizeof *facet_of);
    for (size_t i = 0; facet_of && i < g->n_facets; i++)
        facet_of[g->facets[i].surface] = (uint32_t)i;
    const bool made = facet_of && list_extra(g, d, facet_of) && add_opposite_facets(g, d, facet_of);
    free(facet_of);
    return made ? 0 : ORL_ERR_NOMEM;
}

/* Returns a parsed scene of one prototype; it borrows everything. */
static struct orl_parsed_scene prototype_description(const struct orl_parsed_scene *d,
                                                     size_t prototype)
{
    const struct orl_prototype *const p = &d->prototypes[prototype];
    struct orl_parsed_scene part = *d;
    part.surfaces = p->surfaces;
    part.n_surfaces = p->n_surfaces;
    part.opposed = p->opposed;
    part.n_opposed = p->n_opposed;
    part.n_prototypes = part.n_placements = 0;
    return part;
}

static int build_prototypes(struct orl_geometry *g, const struct orl_parsed_scene *d,
                            struct orl_error *err)
{
    int code = 0;
    g->prototypes = calloc(d->n_prototypes + 1, sizeof(struct orl_geometry *));
    if (!g->prototypes)
        return ORL_ERR_NOMEM;
    for (; g->n_prototypes < d->n_prototypes && code == 0; g->n_prototypes++) {
        const struct orl_parsed_scene part = prototype_description(d, g->n_prototypes);
        code = orl_geometry_new(&part, &g->prototypes[g->n_prototypes], err);
    }
    return code;
}

static int measure_scene(struct orl_geometry *g, const struct orl_parsed_scene *d,
                         struct orl_error *err)
{
    struct orl_vec3 low = orl_v3(INFINITY, INFINITY, INFINITY), high = orl_neg(low);
    for (size_t i = 0; i < d->n_surfaces; i++) {
        bounds_of(&d->surfaces[i], &low, &high);
        g->n_quadrics += d->surfaces[i].kind != ORL_SURFACE_POLYGON;
    }
    int code = build_prototypes(g, d, err);
    if (code == 0 && !orl_instances_build(g, d, &low, &high))
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

int orl_geometry_new(const struct orl_parsed_scene *parsed_scene,
                     struct orl_geometry **ret_geometry, struct orl_error *err)
{
    int code = ORL_ERR_NOMEM;
    struct orl_geometry *g = calloc(1, sizeof *g);
    struct builder builder = {.g = g, .parsed_scene = parsed_scene, .err = err};
    if (!g)
        goto done;
    if (parsed_scene->n_surfaces > ORL_LIMIT_SURFACES) {
        code = orl_error_set(err, ORL_ERR_LIMIT, "%zu surfaces; at most %lu are allowed",
                             parsed_scene->n_surfaces, ORL_LIMIT_SURFACES);
        goto done;
    }
    code = measure_scene(g, parsed_scene, err);
    if (code < 0)
        goto done;
    code = ORL_ERR_NOMEM;
    g->n_facets = g->n_unpacked_facets = parsed_scene->n_surfaces;
    g->facets = calloc(g->n_facets + 1, sizeof *g->facets);
    g->quadrics = malloc((g->n_quadrics + 1) * sizeof *g->quadrics);
    builder.quads.geometry = g;
    if (!g->facets || !g->quadrics || !orl_corners_init(&builder.corners, g))
        goto done;
    code = add_facets(&builder);
    if (code == 0)
        code = add_extra(g, parsed_scene);
    if (code == 0)
        code = orl_instances_number(g, err);
    if (code == 0 && !(orl_geometry_index_triangles(g) && orl_geometry_pack(g)))
        code = ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_embree_build(g, parsed_scene->cancel, err);
    if (code == 0)
        code = orl_holes_build(g, parsed_scene, err);
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
