#include "scene/geometry/coincidence/coincident.h"

#include <stdlib.h>
#include <string.h>

#include "base/statistics/numeric.h"

/* A surface with a canonical start and direction of its outline, so that equal outlines compare
 * equal. */
struct entry {
    const struct orl_surface *surface;
    uint32_t start;
    bool backwards;
};

/* ---- Order ----------------------------------------------------------------------------------- */

static int compare_numbers(double a, double b)
{
    return a < b ? -1 : a > b;
}

static int compare_points(struct orl_vec3 a, struct orl_vec3 b)
{
    if (a.x != b.x)
        return compare_numbers(a.x, b.x);
    return a.y != b.y ? compare_numbers(a.y, b.y) : compare_numbers(a.z, b.z);
}

static struct entry entry_of(const struct orl_surface *s)
{
    struct entry e = {s, 0, false};
    if (s->kind != ORL_SURFACE_POLYGON)
        return e;
    for (uint32_t i = 1; i < s->n_vertices; i++)
        if (compare_points(s->vertices[i], s->vertices[e.start]) < 0)
            e.start = i;
    const uint32_t n = s->n_vertices;
    e.backwards =
        compare_points(s->vertices[(e.start + n - 1) % n], s->vertices[(e.start + 1) % n]) < 0;
    return e;
}

static uint32_t next_corner(const struct entry *e, uint32_t corner)
{
    if (e->backwards)
        return corner > 0 ? corner - 1 : e->surface->n_vertices - 1;
    return corner + 1 < e->surface->n_vertices ? corner + 1 : 0;
}

static int compare_outlines(const struct entry *a, const struct entry *b)
{
    const uint32_t n = a->surface->n_vertices;
    if (n != b->surface->n_vertices)
        return n < b->surface->n_vertices ? -1 : 1;
    uint32_t at = a->start, other = b->start;
    for (uint32_t i = 0; i < n; i++) {
        const int order = compare_points(a->surface->vertices[at], b->surface->vertices[other]);
        if (order != 0)
            return order;
        at = next_corner(a, at);
        other = next_corner(b, other);
    }
    return 0;
}

static int compare_quadrics(const struct orl_quadric *a, const struct orl_quadric *b)
{
    for (int i = 0; i < 2; i++) {
        const int order = compare_points(a->center[i], b->center[i]);
        if (order != 0)
            return order;
        if (a->radius[i] != b->radius[i])
            return compare_numbers(a->radius[i], b->radius[i]);
    }
    return 0;
}

/* Returns 0 for duplicates. */
static int compare_places(const struct entry *a, const struct entry *b)
{
    if (a->surface->kind != b->surface->kind)
        return a->surface->kind < b->surface->kind ? -1 : 1;
    if (a->surface->kind == ORL_SURFACE_POLYGON)
        return compare_outlines(a, b);
    const int order = compare_points(a->surface->normal, b->surface->normal);
    return order != 0 ? order : compare_quadrics(a->surface->quadric, b->surface->quadric);
}

static int compare_entries(const void *left, const void *right)
{
    const struct entry *a = left, *b = right;
    const int order = compare_places(a, b);
    return order != 0 ? order : a->surface < b->surface ? -1 : a->surface > b->surface;
}

/* ---- Groups ---------------------------------------------------------------------------------- */

struct dropping {
    struct orl_parsed_scene *d;
    const bool *is_cut; /* by material: true if antimatter cuts it */
    struct orl_coincidence_warnings *warnings;
    bool *gone; /* by surface */
    size_t n_gone;
};

static void drop_surface(struct dropping *t, const struct orl_surface *loser,
                         const struct orl_surface *winner)
{
    const bool alike = orl_surfaces_alike(t->d, loser, winner);
    t->gone[loser - t->d->surfaces] = true;
    t->n_gone++;
    orl_coincidence_warn(t->warnings, t->d,
                         alike ? ORL_COINCIDENCE_SAME_MATERIAL : ORL_COINCIDENCE_RESOLVED, loser,
                         winner, true);
}

/* Returns true if antimatter cuts one of the group and another may be a pane in the hole. */
static bool may_be_refused(const struct dropping *t, const struct entry *group, size_t n)
{
    bool cut = false, pane = false;
    for (size_t i = 0; i < n; i++) {
        const uint32_t material = group[i].surface->material;
        cut = cut || t->is_cut[material];
        pane = pane || orl_coincidence_class(&t->d->materials[material]) == 1;
    }
    return cut && pane;
}

static void drop_polygons(struct dropping *t, const struct entry *group, size_t n)
{
    const struct orl_surface *best[2] = {group[0].surface, NULL}; /* one per orientation */
    if (may_be_refused(t, group, n))
        return;
    for (size_t i = 1; i < n; i++) {
        const struct orl_surface *const s = group[i].surface;
        const int way = orl_dot(s->normal, group[0].surface->normal) < 0;
        if (!best[way] || orl_coincidence_compare(t->d, s, best[way]) > 0)
            best[way] = s;
    }
    if (best[1]) { /* one of them may win from both sides */
        const int order = orl_coincidence_compare(t->d, best[0], best[1]);
        best[order < 0 ? 0 : 1] = order == 0 ? best[1] : best[order < 0 ? 1 : 0];
    }
    for (size_t i = 0; i < n; i++) {
        const struct orl_surface *const s = group[i].surface;
        const int way = orl_dot(s->normal, group[0].surface->normal) < 0;
        if (s != best[0] && s != best[1])
            drop_surface(t, s, best[way] ? best[way] : best[0]);
    }
}

/* Compares materials with the first surface's only. */
static void drop_quadrics(struct dropping *t, const struct entry *group, size_t n)
{
    const struct orl_surface *const first = group[0].surface;
    if (!orl_material_is_two_sided(&t->d->materials[first->material]))
        return;
    for (size_t i = 1; i < n; i++)
        if (orl_surfaces_alike(t->d, first, group[i].surface))
            drop_surface(t, group[i].surface, first);
}

static void remove_gone(const struct dropping *t)
{
    size_t kept = 0;
    for (size_t i = 0; i < t->d->n_surfaces; i++)
        if (!t->gone[i])
            t->d->surfaces[kept++] = t->d->surfaces[i];
    t->d->n_surfaces = kept;
}

int orl_duplicates_drop(struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                        struct orl_coincidence_warnings *warnings)
{
    struct orl_parsed_scene *const d = parsed_scene;
    struct dropping t = {.d = d, .is_cut = is_cut, .warnings = warnings};
    struct entry *const entries = malloc((d->n_surfaces + 1) * sizeof *entries);
    size_t n = 0;
    t.gone = calloc(d->n_surfaces + 1, sizeof *t.gone);
    int code = entries && t.gone ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < d->n_surfaces; i++)
        if (!orl_surface_is_hole(d, &d->surfaces[i]) && !orl_surface_is_proxy(d, &d->surfaces[i]))
            entries[n++] = entry_of(&d->surfaces[i]);
    if (code == 0)
        code = orl_sort(entries, n, sizeof *entries, compare_entries, d->cancel);
    for (size_t first = 0, next; code == 0 && first < n; first = next) {
        for (next = first + 1; next < n && compare_places(&entries[first], &entries[next]) == 0;)
            next++;
        if (next - first > 1 && entries[first].surface->kind == ORL_SURFACE_POLYGON)
            drop_polygons(&t, entries + first, next - first);
        else if (next - first > 1)
            drop_quadrics(&t, entries + first, next - first);
    }
    if (t.n_gone > 0)
        remove_gone(&t);
    free(entries);
    free(t.gone);
    return code;
}
