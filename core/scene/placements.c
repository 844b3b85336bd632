#include "scene/surfaces.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"

const struct orl_quadric orl_quadric_none = {{{0, 0, 0}, {0, 0, 0}}, {0, 0}};

uint64_t orl_parsed_scene_count_surfaces(const struct orl_parsed_scene *parsed_scene)
{
    uint64_t n = parsed_scene->n_surfaces;
    for (size_t i = 0; i < parsed_scene->n_placements; i++)
        n += parsed_scene->prototypes[parsed_scene->placements[i].prototype].n_surfaces;
    return n;
}

/* Returns a surface's name behind the prototype's prefix. */
static const char *own_name(const struct orl_parsed_scene *d, const struct orl_placement *placement,
                            const char *name)
{
    return name + d->prototypes[placement->prototype].prefix_bytes;
}

bool orl_placement_has_name(const struct orl_parsed_scene *parsed_scene,
                            const struct orl_placement *placement, const char *stored,
                            const char *name)
{
    const size_t front = strlen(placement->prefix);
    if (placement->name)
        return strcmp(placement->name, name) == 0;
    return strncmp(placement->prefix, name, front) == 0 &&
           strcmp(own_name(parsed_scene, placement, stored), name + front) == 0;
}

/* ---- One surface ----------------------------------------------------------------------------- */

/* The linear part is orthogonal up to its scale, so its inverse is the transpose over scale
 * squared. */
struct orl_xform orl_xform_inverse(const struct orl_xform *x)
{
    const double by = 1 / (x->scale * x->scale);
    struct orl_xform back = {.scale = 1 / x->scale,
                             .mirrored = x->mirrored,
                             .inverted = x->inverted,
                             .offset = {0, 0, 0}};
    back.row[0] = orl_scale(orl_v3(x->row[0].x, x->row[1].x, x->row[2].x), by);
    back.row[1] = orl_scale(orl_v3(x->row[0].y, x->row[1].y, x->row[2].y), by);
    back.row[2] = orl_scale(orl_v3(x->row[0].z, x->row[1].z, x->row[2].z), by);
    back.offset = orl_neg(orl_xform_vector(&back, x->offset));
    return back;
}

struct orl_vec3 orl_xform_direction(const struct orl_xform *xform, struct orl_vec3 direction)
{
    return orl_scale(orl_xform_vector(xform, direction), 1 / xform->scale);
}

struct orl_vec3 orl_xform_normal(const struct orl_xform *xform, struct orl_vec3 normal)
{
    const struct orl_vec3 turned = orl_xform_direction(xform, normal);
    return xform->inverted ? orl_neg(turned) : turned;
}

struct orl_quadric orl_xform_quadric(const struct orl_xform *xform,
                                     const struct orl_quadric *quadric)
{
    struct orl_quadric placed;
    for (int i = 0; i < 2; i++) {
        placed.center[i] = orl_xform_point(xform, quadric->center[i]);
        placed.radius[i] = xform->scale * quadric->radius[i];
    }
    return placed;
}

enum orl_surface_kind orl_xform_kind(const struct orl_xform *xform, enum orl_surface_kind kind)
{
    static const enum orl_surface_kind inverse[] = {
        [ORL_SURFACE_POLYGON] = ORL_SURFACE_POLYGON, [ORL_SURFACE_SPHERE] = ORL_SURFACE_BUBBLE,
        [ORL_SURFACE_BUBBLE] = ORL_SURFACE_SPHERE,   [ORL_SURFACE_CYLINDER] = ORL_SURFACE_TUBE,
        [ORL_SURFACE_TUBE] = ORL_SURFACE_CYLINDER,   [ORL_SURFACE_CONE] = ORL_SURFACE_CUP,
        [ORL_SURFACE_CUP] = ORL_SURFACE_CONE,        [ORL_SURFACE_RING] = ORL_SURFACE_RING,
    };
    return xform->inverted ? inverse[kind] : kind;
}

/* Transforms the corners and the (u, v) coordinates behind them; reverses their order if the front
 * would change sides. */
static bool transform_polygon(const struct orl_xform *xform, struct orl_surface *surface,
                              struct orl_arena *arena)
{
    enum { PLACE = 2 * sizeof(double) };
    const uint32_t n = surface->n_vertices;
    const bool backwards = xform->mirrored != xform->inverted;
    const struct orl_vec3 *const from = surface->vertices;
    const char *const places = (const char *)orl_surface_uv(surface);
    struct orl_vec3 *const to = orl_arena_alloc(arena, n * (sizeof *to + (places ? PLACE : 0)));
    if (!to)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t at = backwards ? n - 1 - i : i;
        to[i] = orl_xform_point(xform, from[at]);
        if (places)
            memcpy((char *)(to + n) + (size_t)i * PLACE, places + (size_t)at * PLACE, PLACE);
    }
    surface->vertices = to;
    return true;
}

static bool place_quadric(const struct orl_xform *xform, struct orl_surface *surface,
                          struct orl_arena *arena)
{
    struct orl_quadric *const quadric = orl_arena_alloc(arena, sizeof *quadric);
    if (!quadric)
        return false;
    *quadric = orl_xform_quadric(xform, surface->quadric);
    surface->quadric = quadric;
    surface->kind = orl_xform_kind(xform, surface->kind);
    return true;
}

static bool name_surface(const struct orl_parsed_scene *d, const struct orl_placement *placement,
                         struct orl_surface *surface)
{
    const char *const own =
        placement->name ? placement->name : own_name(d, placement, surface->name);
    const char *const prefix = placement->name ? "" : placement->prefix;
    const size_t front = strlen(prefix), length = strlen(own);
    surface->name = orl_arena_alloc_chars(d->outlines, front + length + 1);
    if (!surface->name)
        return false;
    memcpy(surface->name, prefix, front);
    memcpy(surface->name + front, own, length + 1);
    return true;
}

/* ---- Expansion ------------------------------------------------------------------------------- */

struct expansion {
    struct orl_parsed_scene *d;
    size_t *places; /* by prototype: number of its places if it is expanded, else 0 */
    struct orl_surface *surfaces;
    size_t n;
    size_t placement, file, kept; /* next placement, next file; number of placements that stay */
};

/* Appends the surfaces of one place. */
static bool expand_one(struct expansion *e, const struct orl_placement *placement)
{
    const struct orl_prototype *const prototype = &e->d->prototypes[placement->prototype];
    for (size_t i = 0; i < prototype->n_surfaces; i++) {
        struct orl_surface *const surface = &e->surfaces[e->n++];
        *surface = prototype->surfaces[i];
        surface->normal = orl_xform_normal(&placement->xform, surface->normal);
        if (!name_surface(e->d, placement, surface) ||
            !(surface->kind == ORL_SURFACE_POLYGON
                  ? transform_polygon(&placement->xform, surface, e->d->outlines)
                  : place_quadric(&placement->xform, surface, e->d->outlines)))
            return false;
    }
    return true;
}

static bool take_place(struct expansion *e)
{
    struct orl_placement placement = e->d->placements[e->placement++];
    if (e->places[placement.prototype] > 0)
        return expand_one(e, &placement);
    placement.before = e->n;
    e->d->placements[e->kept++] = placement;
    return true;
}

/* Processes the placements and file starts at a surface index, those of earlier files first. */
static bool merge_at(struct expansion *e, size_t index)
{
    const struct orl_parsed_scene *const d = e->d;
    for (;;) {
        const bool place =
            e->placement < d->n_placements && d->placements[e->placement].before == index;
        const bool begins =
            e->file < d->source.n_first_surfaces && d->source.first_surfaces[e->file] == index;
        if (place && (!begins || d->placements[e->placement].main_file < e->file)) {
            if (!take_place(e))
                return false;
        } else if (begins) {
            d->source.first_surfaces[e->file++] = e->n;
        } else {
            return true;
        }
    }
}

static bool merge_surfaces(struct expansion *e)
{
    for (size_t i = 0; i <= e->d->n_surfaces; i++) {
        if (!merge_at(e, i))
            return false;
        if (i < e->d->n_surfaces)
            e->surfaces[e->n++] = e->d->surfaces[i];
    }
    return true;
}

/* Drops the prototypes that have been expanded. */
static void drop_prototypes(struct expansion *e)
{
    struct orl_parsed_scene *const d = e->d;
    size_t kept = 0;
    for (size_t i = 0; i < d->n_prototypes; i++) {
        if (e->places[i] > 0) {
            free(d->prototypes[i].surfaces);
            free(d->prototypes[i].opposed);
            continue;
        }
        e->places[i] = kept; /* from here on the new index of the prototype */
        d->prototypes[kept++] = d->prototypes[i];
    }
    for (size_t i = 0; i < e->kept; i++)
        d->placements[i].prototype = (uint32_t)e->places[d->placements[i].prototype];
    d->n_prototypes = kept;
    d->n_placements = e->kept;
}

/* Chooses the prototypes to expand and returns the number of surfaces that this adds. */
static uint64_t choose_prototypes(struct expansion *e, size_t fewer_than)
{
    const struct orl_parsed_scene *const d = e->d;
    uint64_t n = 0;
    for (size_t i = 0; i < d->n_placements; i++)
        e->places[d->placements[i].prototype]++;
    for (size_t i = 0; i < d->n_prototypes; i++) {
        e->places[i] =
            e->places[i] < fewer_than && !d->prototypes[i].has_patterns ? e->places[i] : 0;
        n += (uint64_t)e->places[i] * d->prototypes[i].n_surfaces;
    }
    return n;
}

static int expand_chosen(struct expansion *e, uint64_t more, struct orl_error *err)
{
    struct orl_parsed_scene *const d = e->d;
    const uint64_t n = d->n_surfaces + more;
    if (n > ORL_LIMIT_SURFACES)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "%llu surfaces, with those of every instance; at most %lu are allowed "
                             "if instances are expanded",
                             (unsigned long long)n, ORL_LIMIT_SURFACES);
    e->surfaces = malloc((n + 1) * sizeof *e->surfaces);
    if (!e->surfaces || !merge_surfaces(e)) {
        free(e->surfaces);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the scene");
    }
    free(d->surfaces);
    d->surfaces = e->surfaces;
    d->n_surfaces = e->n;
    drop_prototypes(e);
    return 0;
}

bool orl_parsed_scene_must_split(const struct orl_parsed_scene *parsed_scene)
{
    for (size_t i = 0; i < parsed_scene->n_surfaces; i++) {
        const struct orl_material *const m =
            &parsed_scene->materials[parsed_scene->surfaces[i].material];
        if (m->kind == ORL_MATERIAL_ANTIMATTER || m->kind == ORL_MATERIAL_MIST ||
            orl_material_thickness(m) != 0)
            return true;
    }
    return false;
}

int orl_placements_expand(struct orl_parsed_scene *parsed_scene, size_t fewer_than,
                          struct orl_error *err)
{
    if (parsed_scene->n_prototypes == 0)
        return 0;
    struct expansion e = {.d = parsed_scene,
                          .places = calloc(parsed_scene->n_prototypes, sizeof *e.places)};
    if (!e.places)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the scene");
    const uint64_t more = choose_prototypes(&e, fewer_than);
    const int code = more > 0 ? expand_chosen(&e, more, err) : 0;
    free(e.places);
    return code;
}
