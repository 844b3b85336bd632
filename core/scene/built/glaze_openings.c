#include "scene/built/ports.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

enum { RAYS = 1024 }; /* for each side of an opening */
enum { PROBES = 16 }; /* along each edge of an opening */
/* sides of windows per opening that are tested for being outer sides */
enum { MOST_WINDOWS = 8 };
enum { OFTEN = 11 }; /* rays that must hit a window before it is tested */
enum { NAME = 128 };

struct candidate {
    size_t number; /* index in the order of orl_unglazed_find */
    struct orl_unglazed_opening opening;
    struct orl_vec3 corner; /* in the geometry's moved coordinates */
    /* shares of rays that leave the scene on the normal's side and on the other one */
    double shares[2];
};

struct search {
    const struct orl_scene *scene;
    const struct candidate *panes; /* the openings that get panes, so far */
    size_t n_panes;
};

static struct orl_vec3 point_of(const struct candidate *c, double u, double v)
{
    return orl_madd(orl_madd(c->corner, c->opening.sides[0], u), c->opening.sides[1], v);
}

/* Returns true if a ray passes one of the panes. */
static bool passes_pane(const struct search *search, struct orl_vec3 from,
                        struct orl_vec3 direction)
{
    for (size_t i = 0; i < search->n_panes; i++) {
        const struct orl_unglazed_opening *o = &search->panes[i].opening;
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

/* A ray from a random point of an opening to one of its sides, cosine-weighted. */
struct ray {
    struct orl_vec3 from, direction;
};

static struct ray draw_ray(const struct candidate *c, bool front, struct orl_random *random)
{
    const double u = orl_random_uniform(random), v = orl_random_uniform(random);
    const double x = orl_random_uniform(random), y = orl_random_uniform(random);
    const struct orl_vec3 normal = c->opening.normal;
    return (struct ray){point_of(c, u, v),
                        orl_hemisphere_about(front ? normal : orl_neg(normal), x, y)};
}

static struct orl_random random_of(const struct candidate *c)
{
    return orl_random_stream(2, ORL_PURPOSE_PILOT, c->number);
}

static bool ray_leaves(const struct search *search, const struct candidate *c, bool front,
                       struct orl_random *random)
{
    const struct ray ray = draw_ray(c, front, random);
    return !orl_geometry_occluded(search->scene->geometry, ray.from, ray.direction, INFINITY) &&
           !passes_pane(search, ray.from, ray.direction);
}

static void find_shares(const struct search *search, struct candidate *c)
{
    struct orl_random random[2] = {random_of(c), random_of(c)};
    uint32_t left[2] = {0, 0}, sent = 0;
    for (; sent < RAYS && !orl_escape_is_decided(left, sent); sent++)
        for (int side = 0; side < 2; side++)
            left[side] += ray_leaves(search, c, side == 0, &random[side]);
    for (int side = 0; side < 2; side++)
        c->shares[side] = (double)left[side] / sent;
}

/* Returns true if nothing lies in the opening. orl_unglazed_find searches planes only, so round
 * surfaces and instances have to be excluded here. */
static bool is_free(const struct orl_geometry *g, const struct candidate *c)
{
    const struct orl_vec3 normal = c->opening.normal;
    const double clear = g->radius * 0x1p-20;
    for (int i = 0; i < PROBES; i++)
        for (int k = 0; k < PROBES; k++) {
            const struct orl_vec3 at = point_of(c, (i + 0.5) / PROBES, (k + 0.5) / PROBES);
            if (orl_geometry_occluded(g, orl_madd(at, normal, clear), orl_neg(normal), 2 * clear))
                return false;
        }
    return true;
}

/* A side of a window that rays from an opening hit. */
struct met {
    uint32_t facet;
    bool front;
    size_t rays;
};

static bool is_outer_side(const struct orl_geometry *g, const struct met *met)
{
    struct orl_random random =
        orl_random_stream(2, ORL_PURPOSE_PILOT, ((uint64_t)met->facet + 1) << 32);
    double shares[2];
    orl_escape_shares(g, met->facet, RAYS, &random, shares);
    return orl_escape_shows_outside(shares) && (shares[0] > shares[1]) == met->front;
}

/*
 * Returns true if the opening is before windows, as that of a frame or of a courtyard does: its
 * rays inwards often hit the outer side of a window. Those windows are ports, and must remain so.
 */
static bool is_before_windows(const struct orl_scene *scene, const struct candidate *c)
{
    struct orl_random random = random_of(c);
    struct met met[MOST_WINDOWS];
    size_t n = 0;
    for (int i = 0; i < RAYS; i++) {
        const struct ray ray = draw_ray(c, c->shares[0] < c->shares[1], &random);
        struct orl_hit hit;
        size_t at = 0;
        if (!orl_geometry_intersect(scene->geometry, ray.from, ray.direction, INFINITY, &hit) ||
            orl_facet_is_instanced(scene->geometry, hit.facet) ||
            !orl_material_is_window(orl_scene_material(scene, hit.facet)))
            continue;
        while (at < n && (met[at].facet != hit.facet || met[at].front != hit.front))
            at++;
        if (at == n && n < MOST_WINDOWS)
            met[n++] = (struct met){hit.facet, hit.front, 0};
        if (at < n && ++met[at].rays == OFTEN && is_outer_side(scene->geometry, &met[at]))
            return true;
    }
    return false;
}

/* Returns true if lenses or curved mirrors are before the opening outdoors. */
static bool is_behind_lenses(const struct orl_scene *scene, const struct candidate *c)
{
    struct orl_random random = random_of(c);
    struct orl_focusing_probe probe = {.scene = scene, .any_orientation = true};
    for (int i = 0; i < RAYS; i++) {
        const struct ray ray = draw_ray(c, c->shares[0] > c->shares[1], &random);
        orl_focusing_trace(&probe, ray.from, ray.direction);
    }
    return orl_focusing_is_significant(&probe);
}

static double larger_share(const struct candidate *c)
{
    return fmax(c->shares[0], c->shares[1]);
}

/* Sorts by the larger share, in descending order. */
static int compare_shares(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    const double p = larger_share(x), q = larger_share(y);
    return p != q ? (p < q ? 1 : -1) : (x->number > y->number) - (x->number < y->number);
}

static int compare_numbers(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

/* Moves the candidates that get panes to the front, in the order in which they were found.
 * Returns 0 or ORL_ERR_CANCELLED. */
static int choose_openings(const struct orl_scene *scene, struct candidate *candidates, size_t n,
                           size_t *ret_n)
{
    const atomic_bool *const cancel = scene->parsed_scene.cancel;
    struct search search = {.scene = scene, .panes = candidates};
    for (size_t i = 0; i < n && !orl_is_cancelled(cancel); i++)
        find_shares(&search, &candidates[i]);
    qsort(candidates, n, sizeof *candidates, compare_shares);
    for (size_t i = 0; i < n && !orl_is_cancelled(cancel); i++) {
        struct candidate c = candidates[i];
        if (!orl_escape_shows_outside(c.shares) || !is_free(scene->geometry, &c) ||
            is_before_windows(scene, &c) || is_behind_lenses(scene, &c))
            continue;
        if (search.n_panes > 0)
            find_shares(&search, &c);
        if (orl_escape_shows_outside(c.shares))
            candidates[search.n_panes++] = c;
    }
    qsort(candidates, search.n_panes, sizeof *candidates, compare_numbers);
    *ret_n = search.n_panes;
    return orl_is_cancelled(cancel) ? ORL_ERR_CANCELLED : 0;
}

static int add_material(struct orl_parsed_scene *d, uint32_t *ret_index)
{
    static const char name[] = "opening";
    const struct orl_material pane = {.kind = ORL_MATERIAL_GLASS,
                                      .name = orl_arena_copy_text(d->arena, name, sizeof name - 1),
                                      .color = orl_gray(1),
                                      .sky = -1,
                                      .as.glass = {orl_gray(1), 1}};
    return pane.name ? orl_parsed_scene_add_material(d, &pane, ret_index) : ORL_ERR_NOMEM;
}

/* Appends a pane. Its name, file and line are those of a surface around the opening. */
static int add_pane(struct orl_parsed_scene *d, const struct orl_unglazed_opening *o,
                    uint32_t material)
{
    const struct orl_surface *about = &d->surfaces[o->surface];
    struct orl_vec3 *const corners = orl_arena_alloc(d->arena, 4 * sizeof *corners);
    char name[NAME];
    const int length = snprintf(name, sizeof name, "opening in %.100s", about->name);
    char *const kept = orl_arena_copy_text(d->arena, name, (size_t)length);
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

static int add_panes(struct orl_parsed_scene *d, const struct candidate *candidates, size_t n)
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

/* Fills ret_candidates[ORL_UNGLAZED_OPENINGS_MAX]. */
static int list_candidates(const struct orl_scene *scene, struct candidate *ret_candidates,
                           size_t *ret_n)
{
    struct orl_unglazed_opening *const openings =
        malloc(ORL_UNGLAZED_OPENINGS_MAX * sizeof *openings);
    const int code =
        openings ? orl_unglazed_find(&scene->parsed_scene, openings, ret_n) : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < *ret_n; i++)
        ret_candidates[i] =
            (struct candidate){.number = i,
                               .opening = openings[i],
                               .corner = orl_sub(openings[i].corner, scene->geometry->center)};
    free(openings);
    return code;
}

static bool has_mist(const struct orl_parsed_scene *d)
{
    for (size_t i = 0; i < d->n_materials; i++)
        if (d->materials[i].kind == ORL_MATERIAL_MIST)
            return true;
    return false;
}

int orl_scene_glaze_openings(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_parsed_scene *const d = &scene->parsed_scene;
    if (!d->surfaces || has_mist(d))
        return 0;
    struct candidate *const candidates = malloc(ORL_UNGLAZED_OPENINGS_MAX * sizeof *candidates);
    size_t n = 0;
    int code = candidates ? list_candidates(scene, candidates, &n) : ORL_ERR_NOMEM;
    if (code == 0)
        code = choose_openings(scene, candidates, n, &n);
    if (code == 0 && n > 0)
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
