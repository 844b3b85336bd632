/* Builds antimatter: the geometry of each volume, and of the surfaces that it cuts. Decides which
 * linings apply. */
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/limits.h>

#include "scene/geometry/antimatter/antimatter.h"
#include "scene/geometry/intersect.h"

/* Sets the bounds of the remaining facets; a subset starts with those of the whole scene. */
static void bound_facets(struct orl_geometry *g)
{
    g->low = orl_v3(INFINITY, INFINITY, INFINITY);
    g->high = orl_neg(g->low);
    for (size_t i = 0; i < orl_geometry_triangles_end(g); i++) {
        const struct orl_triangle t = orl_triangle_get(g, i);
        orl_box_include(t.a, &g->low, &g->high);
        orl_box_include(t.b, &g->low, &g->high);
        orl_box_include(t.c, &g->low, &g->high);
    }
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet own;
        struct orl_vec3 low, high;
        if (orl_facet_kind(g, i) == ORL_SURFACE_POLYGON || !(orl_facet_area(g, i) > 0))
            continue;
        orl_quadric_bounds(orl_facet_get_own(g, i, &own), &low, &high);
        orl_box_include(low, &g->low, &g->high);
        orl_box_include(high, &g->low, &g->high);
    }
}

/* Returns the surface of one of the remaining facets, for messages. */
static const struct orl_surface *find_any_surface(const struct orl_geometry *g,
                                                  const struct orl_parsed_scene *d)
{
    for (size_t i = 0; i < g->n_facets; i++)
        if (orl_facet_area(g, i) > 0)
            return &d->surfaces[orl_facet_surface(g, i)];
    return NULL;
}

/* Result of testing whether a volume is closed. */
struct closed {
    /* places where both directions along a line disagree, or that say the volume is inside out */
    int unlike;
    int inside;
};

static void test_place(const struct orl_geometry *shell, struct orl_vec3 place,
                       struct closed *closed)
{
    const int on = orl_hole_winding_number(shell, place, orl_hole_skew),
              back = orl_hole_winding_number(shell, place, orl_neg(orl_hole_skew));
    closed->unlike += on != back || on < 0;
    closed->inside += on > 0;
}

static struct orl_vec3 place_between(struct orl_vec3 low, struct orl_vec3 high, struct orl_vec3 u)
{
    return orl_v3(low.x + u.x * (high.x - low.x), low.y + u.y * (high.y - low.y),
                  low.z + u.z * (high.z - low.z));
}

/* Tests both sides of a point on a triangle, a thousandth of the triangle's size away. */
static void test_beside(const struct orl_geometry *shell, size_t triangle, struct orl_vec3 u,
                        struct closed *closed)
{
    const struct orl_triangle t = orl_triangle_get(shell, triangle);
    const double s = sqrt(u.x), away = 1e-3;
    const struct orl_vec3 ab = orl_sub(t.b, t.a), ac = orl_sub(t.c, t.a), n = orl_cross(ab, ac);
    const struct orl_vec3 p = orl_madd(orl_madd(t.a, ab, s * (1 - u.y)), ac, s * u.y);
    const double size = sqrt(orl_length(n));
    if (!(size > 0))
        return;
    test_place(shell, orl_madd(p, n, away / size), closed);
    test_place(shell, orl_madd(p, n, -away / size), closed);
}

/* Tests places in the volume's bounding box, and beside its surfaces: if holes are scattered over a
 * building, few places of the box lie in one. */
static int check_closed(const struct orl_hole *hole, const struct orl_parsed_scene *d,
                        struct orl_error *err)
{
    enum { PLACES = 256, MOST_UNLIKE = 2 };
    const struct orl_geometry *const s = hole->shell;
    const size_t triangles = orl_geometry_triangles_end(s);
    struct closed all_over = {0}, beside = {0};
    for (int i = 0; i < PLACES; i++) {
        /* Roberts' sequence in three dimensions. */
        const struct orl_vec3 u =
            orl_v3(fmod(0.5 + 0.8191725133961645 * i, 1), fmod(0.5 + 0.6710436067037893 * i, 1),
                   fmod(0.5 + 0.5497004779019703 * i, 1));
        test_place(s, place_between(s->low, s->high, u), &all_over);
        if (triangles > 0)
            test_beside(s, (size_t)(u.z * (double)triangles), u, &beside);
    }
    const bool unlike = all_over.unlike > MOST_UNLIKE || beside.unlike > MOST_UNLIKE;
    if (!unlike && all_over.inside + beside.inside > 0)
        return 0;
    const struct orl_surface *const surface = find_any_surface(s, d);
    const struct orl_material *const m = &d->materials[surface->material];
    char name[ORL_ERROR_NAME_MAX];
    snprintf(name, sizeof name, "antimatter %.200s", m->name);
    orl_error_set(err, ORL_ERR_RANGE, "its surfaces enclose no volume%s",
                  unlike ? ", or their normals do not all face outwards" : "");
    orl_error_at(err, surface->file, surface->line, name);
    orl_error_hint(
        err,
        "antimatter cuts the volume inside its surfaces: close them, with all normals outwards");
    return ORL_ERR_RANGE;
}

static int build_hole(struct orl_geometry *g, const struct orl_parsed_scene *d, uint32_t material,
                      bool *keep, struct orl_hole *hole, struct orl_error *err)
{
    const struct orl_antimatter *const antimatter = orl_antimatter_of(&d->materials[material]);
    hole->material = material;
    hole->has_lining = antimatter->lining >= 0;
    hole->cuts = calloc(d->n_materials + 1, sizeof *hole->cuts);
    if (!hole->cuts)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < antimatter->n_cut; i++)
        hole->cuts[antimatter->cut[i]] = true;
    for (size_t i = 0; i < d->n_materials; i++)
        hole->cuts[i] = hole->cuts[orl_material_origin(&d->materials[i], (uint32_t)i)];
    for (size_t i = 0; i < g->n_facets; i++)
        keep[i] = d->surfaces[orl_facet_surface(g, i)].material == material;
    int code = orl_geometry_subset(g, keep, &hole->shell, err);
    for (size_t i = 0; i < g->n_facets; i++)
        keep[i] = hole->cuts[d->surfaces[orl_facet_surface(g, i)].material];
    if (code == 0)
        code = orl_geometry_subset(g, keep, &hole->matter, err);
    if (code < 0)
        return code;
    bound_facets(hole->shell);
    return check_closed(hole, d, err);
}

/* Lists the antimatters that have surfaces, in order of their definition. */
static size_t list_antimatters(const struct orl_geometry *g, const struct orl_parsed_scene *d,
                               uint8_t *used, uint32_t *ret_materials)
{
    size_t n = 0;
    for (size_t i = 0; i < g->n_facets; i++)
        used[d->surfaces[orl_facet_surface(g, i)].material] = 1;
    for (size_t i = 0; i < d->n_materials; i++)
        if (used[i] && d->materials[i].kind == ORL_MATERIAL_ANTIMATTER)
            ret_materials[n++] = (uint32_t)i;
    return n;
}

static void assign_facets(struct orl_geometry *g, const struct orl_parsed_scene *d,
                          struct orl_holes *holes, const uint32_t *materials)
{
    for (size_t i = 0; i < g->n_facets; i++) {
        const uint32_t own = d->surfaces[orl_facet_surface(g, i)].material;
        holes->of_facet[i] = ORL_HOLE_UNTOUCHED;
        for (size_t k = 0; k < holes->n; k++) {
            if (holes->items[k].cuts[own])
                holes->of_facet[i] = ORL_HOLE_NONE;
            if (materials[k] == own) {
                holes->of_facet[i] = (int32_t)k;
                if (holes->items[k].has_lining)
                    orl_facet_set_material(g, i,
                                           (uint32_t)orl_antimatter_of(&d->materials[own])->lining);
                break;
            }
        }
    }
}

int orl_holes_build(struct orl_geometry *geometry, const struct orl_parsed_scene *parsed_scene,
                    struct orl_error *err)
{
    const size_t n_materials = parsed_scene->n_materials;
    uint8_t *const used = calloc(n_materials + 1, 1);
    uint32_t *const materials = malloc((n_materials + 1) * sizeof *materials);
    bool *const keep = malloc((geometry->n_facets + 1) * sizeof *keep);
    struct orl_holes *holes = NULL;
    int code = used && materials && keep ? 0 : ORL_ERR_NOMEM;
    const size_t n = code == 0 ? list_antimatters(geometry, parsed_scene, used, materials) : 0;
    if (n == 0)
        goto done;
    if (n > ORL_LIMIT_ANTIMATTERS ||
        n * (geometry->n_facets + orl_geometry_triangles_end(geometry)) > ORL_LIMIT_CUT_FACETS) {
        code = orl_error_set(err, ORL_ERR_LIMIT,
                             "%zu antimatters in a scene of %zu surfaces; at most %u are allowed, "
                             "with %lu surfaces and triangles in total",
                             n, geometry->n_facets, ORL_LIMIT_ANTIMATTERS, ORL_LIMIT_CUT_FACETS);
        goto done;
    }
    holes = calloc(1, sizeof *holes);
    code = ORL_ERR_NOMEM;
    if (!holes)
        goto done;
    atomic_init(&holes->references, 1);
    holes->items = calloc(n, sizeof *holes->items);
    holes->of_facet = malloc((geometry->n_facets + 1) * sizeof *holes->of_facet);
    if (!holes->items || !holes->of_facet)
        goto done;
    code = 0;
    for (holes->n = 0; holes->n < n && code == 0; holes->n++)
        code = build_hole(geometry, parsed_scene, materials[holes->n], keep,
                          &holes->items[holes->n], err);
    if (code < 0)
        goto done;
    assign_facets(geometry, parsed_scene, holes, materials);
    geometry->holes = holes;
    holes = NULL;
done:
    orl_holes_unref(holes);
    free(used);
    free(materials);
    free(keep);
    return code;
}

/* ---- Windows that face a lining -------------------------------------------------------------- */

enum { WINDOW_PLACES = 16 };

/* Blocked share of the window area that counts: more than the narrow sides of thick panes, which
 * face the wall beside them. */
static const double much_blocked = 0.05;

/* Window area within a volume, and the part that faces its lining on exactly one side. */
struct windows {
    double area, blocked;
};

/* The view straight ahead from a place beside a window. */
struct outlook {
    bool inside; /* the place is inside the volume */
    bool matter; /* there is matter at the volume's end, or at the place itself */
};

static struct outlook look_ahead(const struct orl_geometry *g, const struct orl_hole *hole,
                                 struct orl_vec3 from, struct orl_vec3 direction)
{
    struct outlook outlook = {.inside = orl_hole_is_inside(hole, from)};
    struct orl_hit hit;
    if (outlook.inside)
        outlook.matter = orl_intersect_uncut(hole->shell, from, direction, INFINITY, &hit) &&
                         !hit.front && orl_hole_is_lining(g, hole, &hit);
    else
        outlook.matter =
            orl_intersect_uncut(hole->matter, from, direction, INFINITY, &hit) && !hit.front;
    return outlook;
}

static void add_window(const struct orl_geometry *g, const struct orl_hole *hole, uint32_t window,
                       struct windows *windows)
{
    const double area = orl_facet_area(g, window);
    int inside = 0, blocked = 0;
    for (int i = 0; i < WINDOW_PLACES; i++) {
        /* Roberts' sequence in two dimensions. */
        const double u[2] = {fmod(0.5 + 0.7548776662466927 * i, 1),
                             fmod(0.5 + 0.5698402909980532 * i, 1)};
        struct orl_vec3 point, normal;
        struct outlook sides[2];
        orl_facet_sample(g, window, u, &point, &normal);
        for (int k = 0; k < 2; k++) {
            const struct orl_vec3 direction = k ? orl_neg(normal) : normal;
            sides[k] = look_ahead(
                g, hole, orl_facet_ray_origin(g, window, point, normal, direction), direction);
        }
        inside += sides[0].inside || sides[1].inside;
        blocked += sides[0].matter != sides[1].matter && sides[sides[0].matter ? 0 : 1].inside;
    }
    windows->area += area * inside / WINDOW_PLACES;
    if (2 * blocked >= inside) /* otherwise it lies in a floor, for example */
        windows->blocked += area * blocked / WINDOW_PLACES;
}

static void omit_lining(struct orl_geometry *g, size_t antimatter)
{
    struct orl_hole *const hole = &g->holes->items[antimatter];
    hole->has_lining = false;
    hole->lining_omitted = true;
    for (size_t i = 0; i < g->n_facets; i++)
        if (g->holes->of_facet[i] == (int32_t)antimatter)
            orl_facet_set_material(g, i, hole->material);
}

void orl_linings_resolve(struct orl_geometry *geometry, const bool *is_window)
{
    const size_t n = orl_linings_count(geometry);
    for (size_t k = 0; k < n; k++) {
        const struct orl_hole *const hole = &geometry->holes->items[k];
        struct windows windows = {0};
        for (uint32_t i = 0; i < geometry->n_facets && hole->has_lining; i++) {
            struct orl_facet own;
            const struct orl_facet *const f = orl_facet_get_own(geometry, i, &own);
            if (f->kind == ORL_SURFACE_POLYGON && f->area > 0 && is_window[f->material] &&
                geometry->holes->of_facet[i] < 0)
                add_window(geometry, hole, i, &windows);
        }
        if (windows.blocked > much_blocked * windows.area)
            omit_lining(geometry, k);
    }
}

/* ---- Queries --------------------------------------------------------------------------------- */

size_t orl_linings_count(const struct orl_geometry *geometry)
{
    return geometry->holes ? geometry->holes->n : 0;
}

void orl_lining_of(const struct orl_geometry *geometry, size_t antimatter, uint32_t *ret_material,
                   uint32_t *ret_facet)
{
    uint32_t facet = 0;
    while (geometry->holes->of_facet[facet] != (int32_t)antimatter)
        facet++;
    *ret_material = geometry->holes->items[antimatter].material;
    *ret_facet = facet;
}

bool orl_lining_is_omitted(const struct orl_geometry *geometry, size_t antimatter)
{
    return geometry->holes->items[antimatter].lining_omitted;
}

bool orl_lining_matter_contains(const struct orl_geometry *geometry, size_t antimatter,
                                struct orl_vec3 place)
{
    /* Up to a third of the directions may show no back: objects standing in a room face into it. */
    enum { DIRECTIONS = 48, MOST_OTHERS = DIRECTIONS / 3 };
    const struct orl_hole *const hole = &geometry->holes->items[antimatter];
    int others = 0;
    for (int i = 0; i < DIRECTIONS && hole->has_lining; i++) {
        /* A spherical spiral by the golden angle, alternating between up and down. */
        const double z = (i % 2 ? -1 : 1) * (1 - (i + 0.5) / DIRECTIONS), s = sqrt(1 - z * z);
        const double phi = 2.399963229728653 * i;
        struct orl_hit hit;
        others += !orl_intersect_uncut(hole->matter, place, orl_v3(s * cos(phi), s * sin(phi), z),
                                       INFINITY, &hit) ||
                  hit.front;
        if (others > MOST_OTHERS)
            return false;
    }
    return hole->has_lining;
}
