#include "annual/sun/mirror_planes.h"

#include <stdlib.h>

#include "light/direct.h"
#include "light/path.h"
#include "scene/material/scatter.h"

enum { MOST_PANES = 64 };

/* ---- Planes ---------------------------------------------------------------------------------- */

static int32_t port_of(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    return lit_scene->open ? ORL_NO_PORT : orl_lit_scene_port_of(lit_scene, facet);
}

/* Returns true if both are ports with outdoors on the same side, or neither is a port. */
static bool are_alike(const struct orl_lit_scene *lit_scene, int32_t a, int32_t b)
{
    if (a == ORL_NO_PORT || b == ORL_NO_PORT)
        return a == b;
    return orl_dot(lit_scene->ports[a].outward, lit_scene->ports[b].outward) > 0;
}

static bool is_in_plane(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                        const struct orl_bounding_rect *pane)
{
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    const struct orl_vec3 from = orl_sub(pane->corner, plane->whole.corner);
    const double near =
        8 * orl_facet_offset(lit_scene->geometry, pane->facet) + 1e-5 * orl_length(from);
    return plane->class == lit_scene->images.class_of[pane->facet] &&
           fabs(orl_dot(from, plane->whole.normal)) < near &&
           fabs(orl_dot(from, pane->normal)) < near &&
           are_alike(lit_scene, plane->port, port_of(lit_scene, pane->facet));
}

/* Returns the plane of a pane, and adds one if necessary; UINT32_MAX: there are too many. */
static uint32_t find_plane(struct orl_mirrors *mirrors, const struct orl_bounding_rect *pane)
{
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    uint32_t i = 0;
    while (i < mirrors->n_planes && !is_in_plane(mirrors, &mirrors->planes[i], pane))
        i++;
    if (i == ORL_MIRRORS_MOST_PLANES)
        return UINT32_MAX;
    if (i < mirrors->n_planes)
        orl_bounding_rect_widen(&mirrors->planes[i].whole, pane);
    else
        mirrors->planes[mirrors->n_planes++] =
            (struct orl_mirror_plane){.whole = *pane,
                                      .class = lit_scene->images.class_of[pane->facet],
                                      .port = port_of(lit_scene, pane->facet)};
    mirrors->planes[i].count++;
    return i;
}

struct candidate {
    double area;
    uint32_t facet;
};

static int larger_first(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    if (x->area != y->area)
        return x->area > y->area ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

static size_t list_candidates(const struct orl_lit_scene *lit_scene, struct candidate *candidates)
{
    size_t n = 0;
    for (size_t i = 0; i < lit_scene->geometry->n_facets; i++)
        if (lit_scene->images.class_of[i] >= 0)
            candidates[n++] =
                (struct candidate){orl_facet_area(lit_scene->geometry, i), (uint32_t)i};
    qsort(candidates, n, sizeof *candidates, larger_first);
    return n;
}

/* Assigns the candidates to planes, and stores the panes of each plane contiguously. */
static void group_by_plane(struct orl_mirrors *mirrors, const struct candidate *candidates,
                           size_t n)
{
    const struct orl_geometry *g = mirrors->lit_scene->geometry;
    uint32_t first = 0;
    for (size_t i = 0; i < g->n_facets; i++)
        mirrors->plane_of[i] = UINT32_MAX;
    for (size_t i = 0; i < n; i++) {
        const struct orl_bounding_rect pane = orl_bounding_rect_of(g, candidates[i].facet);
        mirrors->plane_of[candidates[i].facet] = find_plane(mirrors, &pane);
    }
    for (size_t p = 0; p < mirrors->n_planes; p++) {
        struct orl_mirror_plane *plane = &mirrors->planes[p];
        plane->first = first;
        first += plane->count;
        plane->count = 0;
    }
    for (size_t i = 0; i < n; i++) {
        const uint32_t p = mirrors->plane_of[candidates[i].facet];
        mirrors->n_left_out += p == UINT32_MAX;
        if (p == UINT32_MAX)
            continue;
        struct orl_mirror_plane *plane = &mirrors->planes[p];
        mirrors->panes[plane->first + plane->count++] =
            orl_bounding_rect_of(g, candidates[i].facet);
    }
}

/* ---- Sets of panes --------------------------------------------------------------------------- */

static bool is_before(const struct orl_bounding_rect *pane, const struct orl_bounding_rect *port,
                      struct orl_vec3 outward)
{
    const double margin = 1e-6 * orl_length(orl_sub(port->corner, pane->corner));
    for (int i = 0; i < 4; i++)
        if (orl_dot(orl_sub(orl_bounding_rect_corner(pane, i), port->corner), outward) > margin)
            return true;
    return false;
}

/* Returns true if a ray that leaves the building by some port may reach the pane. */
static bool may_be_beyond(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                          const struct orl_bounding_rect *pane)
{
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    if (mirrors->one_facade && plane->port != ORL_NO_PORT)
        return false;
    if (mirrors->ports->all)
        return true;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        if (is_before(pane, &mirrors->ports->at[i], lit_scene->ports[i].outward))
            return true;
    return false;
}

/* Returns true if a ray that leaves the building by some port may reach the pane from outdoors,
 * with no other port in between. */
static bool may_be_faced(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                         const struct orl_bounding_rect *pane)
{
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    if (plane->port == ORL_NO_PORT || mirrors->ports->all)
        return true;
    const struct orl_vec3 outward = lit_scene->ports[plane->port].outward;
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        const struct orl_bounding_rect *port = &mirrors->ports->at[i];
        if (is_before(pane, port, lit_scene->ports[i].outward) && is_before(port, pane, outward))
            return true;
    }
    return false;
}

/* Sampling weight of a pane. Mirrors beyond a port weigh less, because the port hides most of them.
 * Mirrors that light reaches only by a third window weigh least. */
static double strength_of(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                          const struct orl_bounding_rect *pane, bool beyond)
{
    static const double of_third = 0.1;
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    const struct orl_material *m = orl_lit_scene_material_of(lit_scene, pane->facet);
    const double strength =
        fmin(fmax((beyond ? 1 : 3) * orl_material_max_mirrored(m, true, 0.5), 0.05), 1);
    return beyond && !may_be_faced(mirrors, plane, pane) ? of_third * strength : strength;
}

static void fill_set(struct orl_mirror_set *set, const struct orl_mirrors *mirrors, bool beyond,
                     double *strengths)
{
    for (size_t p = 0; p < mirrors->n_planes; p++)
        for (uint32_t i = 0; i < mirrors->planes[p].count; i++) {
            const struct orl_mirror_plane *plane = &mirrors->planes[p];
            const struct orl_bounding_rect *pane = &mirrors->panes[plane->first + i];
            if (beyond && !may_be_beyond(mirrors, plane, pane))
                continue;
            strengths[set->count] = strength_of(mirrors, plane, pane, beyond);
            set->panes[set->count] = *pane;
            set->planes[set->count++] = (uint32_t)p;
        }
}

static int make_set(struct orl_mirror_set *set, struct orl_mirrors *mirrors, bool beyond)
{
    size_t most = 0;
    for (size_t p = 0; p < mirrors->n_planes; p++)
        most += mirrors->planes[p].count;
    double *strengths = orl_arrays_new(&mirrors->arrays, most, sizeof *strengths);
    set->panes = orl_arrays_new(&mirrors->arrays, most, sizeof *set->panes);
    set->planes = orl_arrays_new(&mirrors->arrays, most, sizeof *set->planes);
    if (mirrors->arrays.failed)
        return ORL_ERR_NOMEM;
    fill_set(set, mirrors, beyond, strengths);
    return orl_pane_bvh_init(&set->tree, set->panes, strengths, set->count);
}

static bool has_one_facade(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 1; i < lit_scene->n_ports; i++)
        if (orl_dot(lit_scene->ports[i].outward, lit_scene->ports[0].outward) < 1 - 1e-9)
            return false;
    return !lit_scene->open && lit_scene->n_ports > 0;
}

int orl_mirrors_init(struct orl_mirrors *mirrors, const struct orl_lit_scene *lit_scene,
                     const struct orl_port_rects *ports)
{
    const size_t n_facets = lit_scene->geometry->n_facets;
    *mirrors = (struct orl_mirrors){.lit_scene = lit_scene,
                                    .ports = ports,
                                    .one_facade = has_one_facade(lit_scene),
                                    .n_left_out = lit_scene->images.n_left_out};
    if (!lit_scene->images.class_of || lit_scene->images.n_mirrors == 0)
        return 0;
    struct candidate *candidates = calloc(n_facets + 1, sizeof *candidates);
    struct orl_arrays *arrays = &mirrors->arrays;
    const size_t n = candidates ? list_candidates(lit_scene, candidates) : 0;
    mirrors->plane_of = orl_arrays_new(arrays, n_facets, sizeof *mirrors->plane_of);
    mirrors->planes = orl_arrays_new(arrays, ORL_MIRRORS_MOST_PLANES, sizeof *mirrors->planes);
    mirrors->panes = orl_arrays_new(arrays, n, sizeof *mirrors->panes);
    int code = candidates && !arrays->failed ? 0 : ORL_ERR_NOMEM;
    if (code == 0)
        group_by_plane(mirrors, candidates, n);
    free(candidates);
    if (code == 0)
        code = make_set(&mirrors->everywhere, mirrors, false);
    return code == 0 ? make_set(&mirrors->beyond, mirrors, true) : code;
}

void orl_mirrors_done(struct orl_mirrors *mirrors)
{
    orl_pane_bvh_done(&mirrors->everywhere.tree);
    orl_pane_bvh_done(&mirrors->beyond.tree);
    orl_arrays_free(&mirrors->arrays);
    *mirrors = (struct orl_mirrors){.planes = NULL};
}

/* ---- Light ----------------------------------------------------------------------------------- */

/* Returns false if the mirror is a window seen from inside and its light cannot have come in
 * through another one. */
static bool lit_from_within(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                            struct orl_vec3 there, struct orl_vec3 image, struct orl_vec3 towards)
{
    if (plane->port == ORL_NO_PORT ||
        orl_dot(image, mirrors->lit_scene->ports[plane->port].outward) <= 0)
        return true;
    return orl_port_rects_passed(mirrors->ports, there, towards, 0, INFINITY);
}

/* Returns true if a ray passes one of the plane's panes; *ret_distance is the distance of the
 * plane. */
static bool is_passed(const struct orl_mirrors *mirrors, const struct orl_mirror_plane *plane,
                      struct orl_vec3 origin, struct orl_vec3 direction, double *ret_distance)
{
    if (!orl_bounding_rect_passed(&plane->whole, origin, direction, 0, ret_distance))
        return false;
    bool passed = plane->count == 1;
    for (uint32_t i = 0; i < plane->count && !passed; i++)
        passed =
            orl_bounding_rect_passed(&mirrors->panes[plane->first + i], origin, direction, 0, NULL);
    return passed;
}

/* Returns sunlight reflected in one plane, or in one facet of it. beyond: the mirror is seen
 * through a port from inside. port: as in orl_mirrors_light_of. */
static struct orl_rgb light_by_plane(const struct orl_mirrors *mirrors, uint32_t plane,
                                     uint32_t facet, struct orl_path path, struct orl_vec3 towards,
                                     bool beyond, int32_t *port)
{
    const struct orl_lit_scene *lit_scene = mirrors->lit_scene;
    bool out = !beyond;
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            break;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const bool here = !orl_facet_is_instanced(lit_scene->geometry, hit.facet) &&
                          mirrors->plane_of[hit.facet] == plane;
        if (here && (!out || (facet != UINT32_MAX && hit.facet != facet)))
            break;
        if (here) {
            const struct orl_rgb share =
                orl_rgb_mul(path.weight, orl_material_mirrored(m, &hit, orl_path_back(&path)));
            if (!(orl_rgb_max(share) > 0))
                break;
            const struct orl_vec3 from = orl_hit_ray_origin(lit_scene->geometry, &hit, towards);
            return orl_rgb_mul(share,
                               orl_transmittance_to_infinity(lit_scene, from, towards, port));
        }
        if (!orl_path_transmit_straight(&path, m, &hit))
            break;
        if (orl_lit_scene_crossing(lit_scene, &hit) == ORL_CROSSING_OUTWARDS) {
            out = true;
            if (*port == ORL_NO_PORT)
                *port = orl_lit_scene_port_of(lit_scene, hit.facet);
        }
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
    return orl_gray(0);
}

struct orl_rgb orl_mirrors_light(const struct orl_mirrors *mirrors,
                                 const struct orl_shading_point *place, struct orl_vec3 towards,
                                 bool beyond, orl_mirrors_response response, const void *ctx)
{
    const struct orl_virtual_suns *images = &mirrors->lit_scene->images;
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < mirrors->n_planes; i++) {
        const struct orl_mirror_plane *plane = &mirrors->planes[i];
        if (mirrors->one_facade && !place->outside && plane->port != ORL_NO_PORT)
            continue;
        const struct orl_vec3 image =
            orl_virtual_sun_reflect(towards, images->mirrors[plane->class]);
        double distance;
        if (!(orl_dot(image, place->normal) > 0) ||
            !is_passed(mirrors, plane, place->point, image, &distance) ||
            !lit_from_within(mirrors, plane, orl_madd(place->point, image, distance), image,
                             towards))
            continue;
        const struct orl_rgb seen = response(ctx, image);
        int32_t port = ORL_NO_PORT;
        if (orl_rgb_max(seen) > 0)
            sum = orl_rgb_add(sum,
                              orl_rgb_mul(seen, light_by_plane(mirrors, i, UINT32_MAX,
                                                               orl_path_from(place->point, image),
                                                               towards, beyond, &port)));
    }
    return sum;
}

/* ---- One pane -------------------------------------------------------------------------------- */

struct orl_cone orl_mirrors_cone(const struct orl_mirrors *mirrors,
                                 const struct orl_mirror_set *set, uint32_t item,
                                 struct orl_vec3 point)
{
    const struct orl_bounding_rect *pane = &set->panes[item];
    const struct orl_vec3 mirror =
        mirrors->lit_scene->images.mirrors[mirrors->planes[set->planes[item]].class];
    const struct orl_cone cone = orl_bounding_rect_cone(pane, point);
    return (struct orl_cone){orl_virtual_sun_reflect(cone.axis, mirror), cone.cosine};
}

struct orl_rgb orl_mirrors_light_of(const struct orl_mirrors *mirrors,
                                    const struct orl_mirror_set *set, uint32_t item,
                                    const struct orl_shading_point *place, struct orl_vec3 towards,
                                    orl_mirrors_response response, const void *ctx, int32_t *port)
{
    const struct orl_bounding_rect *pane = &set->panes[item];
    const uint32_t p = set->planes[item];
    const struct orl_mirror_plane *plane = &mirrors->planes[p];
    const bool beyond = set == &mirrors->beyond;
    if (mirrors->one_facade && !place->outside && plane->port != ORL_NO_PORT)
        return orl_gray(0);
    const struct orl_vec3 image =
        orl_virtual_sun_reflect(towards, mirrors->lit_scene->images.mirrors[plane->class]);
    double distance;
    if (!(orl_dot(image, place->normal) > 0) ||
        !orl_bounding_rect_passed(pane, place->point, image, 0, &distance) ||
        (beyond &&
         !orl_port_rects_passed(mirrors->ports, place->point, image, 0, distance * (1 - 1e-6))) ||
        !lit_from_within(mirrors, plane, orl_madd(place->point, image, distance), image, towards))
        return orl_gray(0);
    const struct orl_rgb seen = response(ctx, image);
    if (!(orl_rgb_max(seen) > 0))
        return seen;
    return orl_rgb_mul(seen,
                       light_by_plane(mirrors, p, pane->facet, orl_path_from(place->point, image),
                                      towards, beyond, port));
}
