#include "light/glaze.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/random.h"
#include "scene/geometry/unglazed.h"
#include "scene/material/bounds.h"
#include "scene/material/hemisphere.h"

enum { RAYS = 1024, PROBES = 8, NAME = 128 }; /* rays of a side; probes along each of its sides */
/* As windows are ports (ports.c): the share of rays that leave the scene from its outer side, and
 * how many times the inner side's that is. */
static const double least_seen = 1e-3, least_contrast = 4;

struct candidate {
    size_t number; /* as it was found */
    struct orl_unglazed opening;
    struct orl_vec3 corner; /* moved, as geometry has it */
    double share[2];        /* of rays that leave the scene; from the normal's side first */
};

struct search {
    const struct orl_geometry *geometry;
    const struct candidate *panes; /* those that get one, so far */
    size_t n_panes;
};

/* Returns true if a ray passes one of the panes. */
static bool passes_pane(const struct search *search, struct orl_vec3 from,
                        struct orl_vec3 direction)
{
    for (size_t i = 0; i < search->n_panes; i++) {
        const struct orl_unglazed *o = &search->panes[i].opening;
        const struct orl_vec3 to = orl_sub(search->panes[i].corner, from);
        const double along = orl_dot(to, o->normal) / orl_dot(direction, o->normal);
        if (!(along > 0))
            continue;
        const struct orl_vec3 at = orl_sub(orl_scale(direction, along), to);
        const double u = orl_dot(at, o->sides[0]) / orl_dot(o->sides[0], o->sides[0]);
        const double v = orl_dot(at, o->sides[1]) / orl_dot(o->sides[1], o->sides[1]);
        if (u > 0 && u < 1 && v > 0 && v < 1)
            return true;
    }
    return false;
}

static double share_leaving(const struct search *search, const struct candidate *c, bool front)
{
    const struct orl_unglazed *o = &c->opening;
    const struct orl_vec3 normal = front ? o->normal : orl_neg(o->normal);
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, o->surface);
    size_t left = 0;
    for (int i = 0; i < RAYS; i++) {
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        const double x = orl_random_uniform(&random), y = orl_random_uniform(&random);
        const struct orl_vec3 from = orl_madd(orl_madd(c->corner, o->sides[0], u), o->sides[1], v);
        const struct orl_vec3 direction = orl_hemisphere_about(normal, x, y);
        left += !orl_geometry_occluded(search->geometry, from, direction, INFINITY) &&
                !passes_pane(search, from, direction);
    }
    return (double)left / RAYS;
}

/* Returns true if nearly all of an opening has a window behind it, as a frame's has: that one is
 * the port. */
static bool is_glazed(const struct orl_scene *scene, const struct candidate *c)
{
    static const double nearly_all = 0.9;
    const struct orl_unglazed *o = &c->opening;
    const struct orl_vec3 inwards = c->share[0] > c->share[1] ? orl_neg(o->normal) : o->normal;
    size_t windows = 0;
    for (int i = 0; i < PROBES; i++)
        for (int k = 0; k < PROBES; k++) {
            const struct orl_vec3 from =
                orl_madd(orl_madd(c->corner, o->sides[0], (i + 0.5) / PROBES), o->sides[1],
                         (k + 0.5) / PROBES);
            struct orl_hit hit;
            windows += orl_geometry_intersect(scene->geometry, from, inwards, INFINITY, &hit) &&
                       orl_material_is_window(orl_scene_material(scene, hit.facet));
        }
    return (double)windows >= nearly_all * PROBES * PROBES;
}

static bool lets_daylight_in(const double share[2])
{
    const double more = fmax(share[0], share[1]), less = fmin(share[0], share[1]);
    return more >= least_seen && more >= least_contrast * less;
}

/* The most open first. */
static int compare(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    const double p = fmax(x->share[0], x->share[1]), q = fmax(y->share[0], y->share[1]);
    return p != q ? (p < q ? 1 : -1)
                  : (x->opening.surface > y->opening.surface) -
                        (x->opening.surface < y->opening.surface);
}

static int compare_numbers(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

/* Moves those that get a pane to the front, as they were found; returns how many. */
static size_t choose(const struct orl_scene *scene, struct candidate *candidates, size_t n)
{
    struct search search = {.geometry = scene->geometry};
    for (size_t i = 0; i < n; i++)
        for (int side = 0; side < 2; side++)
            candidates[i].share[side] = share_leaving(&search, &candidates[i], side == 0);
    qsort(candidates, n, sizeof *candidates, compare);
    search.panes = candidates;
    for (size_t i = 0; i < n; i++) {
        struct candidate c = candidates[i];
        if (!lets_daylight_in(c.share) || is_glazed(scene, &c))
            continue;
        for (int side = 0; side < 2 && search.n_panes > 0; side++)
            c.share[side] = share_leaving(&search, &c, side == 0);
        if (lets_daylight_in(c.share))
            candidates[search.n_panes++] = c;
    }
    qsort(candidates, search.n_panes, sizeof *candidates, compare_numbers);
    return search.n_panes;
}

static int add_material(struct orl_description *d, uint32_t *ret_index)
{
    static const char name[] = "opening";
    struct orl_material *grown = realloc(d->materials, (d->n_materials + 1) * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    d->materials = grown;
    grown[d->n_materials] =
        (struct orl_material){.kind = ORL_MATERIAL_GLASS,
                              .name = orl_arena_text(d->arena, name, sizeof name - 1),
                              .color = orl_gray(1),
                              .transmissivity = orl_gray(1),
                              .ior = 1,
                              .lining = -1,
                              .sky = -1};
    *ret_index = (uint32_t)d->n_materials++;
    return grown[*ret_index].name ? 0 : ORL_ERR_NOMEM;
}

/* Appends a pane; it is named, and stands in the files, as one of those about the opening. */
static int add_pane(struct orl_description *d, const struct orl_unglazed *o, uint32_t material)
{
    const struct orl_surface *about = &d->surfaces[o->surface];
    struct orl_vec3 *const corners = orl_arena_take(d->arena, 4 * sizeof *corners);
    char name[NAME];
    const int length = snprintf(name, sizeof name, "opening in %.100s", about->name);
    char *const kept = orl_arena_text(d->arena, name, (size_t)length);
    if (!corners || !kept)
        return ORL_ERR_NOMEM;
    corners[0] = o->corner;
    corners[1] = orl_add(o->corner, o->sides[0]);
    corners[2] = orl_add(corners[1], o->sides[1]);
    corners[3] = orl_add(o->corner, o->sides[1]);
    d->surfaces[d->n_surfaces++] = (struct orl_surface){.kind = ORL_SURFACE_POLYGON,
                                                        .material = material,
                                                        .n_vertices = 4,
                                                        .line = about->line,
                                                        .name = kept,
                                                        .file = about->file,
                                                        .vertices = corners,
                                                        .normal = o->normal};
    return 0;
}

static int add_panes(struct orl_description *d, const struct candidate *candidates, size_t n)
{
    uint32_t material = 0;
    struct orl_surface *grown = realloc(d->surfaces, (d->n_surfaces + n) * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    d->surfaces = grown;
    int code = add_material(d, &material);
    for (size_t i = 0; i < n && code == 0; i++)
        code = add_pane(d, &candidates[i].opening, material);
    return code;
}

/* Fills ret_candidates[ORL_MOST_UNGLAZED]. */
static int list_candidates(const struct orl_scene *scene, struct candidate *ret_candidates,
                           size_t *ret_n)
{
    struct orl_unglazed *const openings = malloc(ORL_MOST_UNGLAZED * sizeof *openings);
    const int code =
        openings ? orl_unglazed_find(&scene->description, openings, ret_n) : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < *ret_n; i++)
        ret_candidates[i] =
            (struct candidate){.number = i,
                               .opening = openings[i],
                               .corner = orl_sub(openings[i].corner, scene->geometry->center)};
    free(openings);
    return code;
}

static bool has_mist(const struct orl_description *d)
{
    for (size_t i = 0; i < d->n_materials; i++)
        if (d->materials[i].kind == ORL_MATERIAL_MIST)
            return true;
    return false;
}

int orl_scene_glaze_openings(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_description *const d = &scene->description;
    if (!d->surfaces || has_mist(d))
        return 0;
    struct candidate *const candidates = malloc(ORL_MOST_UNGLAZED * sizeof *candidates);
    size_t n = 0;
    int code = candidates ? list_candidates(scene, candidates, &n) : ORL_ERR_NOMEM;
    n = code == 0 ? choose(scene, candidates, n) : 0;
    if (n > 0)
        code = add_panes(d, candidates, n);
    free(candidates);
    if (code == ORL_ERR_CANCELLED)
        return orl_error_set(err, code, "cancelled while looking for openings");
    if (code < 0 || n == 0)
        return code;
    scene->n_openings = n;
    orl_geometry_free(scene->geometry);
    scene->geometry = NULL;
    return orl_geometry_new(d, &scene->geometry, err);
}
