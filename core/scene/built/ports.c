#include <stdatomic.h>
#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "scene/built/ports.h"
#include "scene/built/scene.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

enum { AT_ONCE = 64 };
static const double least_seen = 1e-3;  /* minimum share of escaping rays for an outside face */
static const double least_contrast = 4; /* minimum ratio of its share to the other face's */

/* Returns how many of n rays (at most AT_ONCE) leave from a side. */
static uint32_t count_leaving(const struct orl_geometry *g, uint32_t facet, bool front, uint32_t n,
                              struct orl_random *random)
{
    const struct orl_vec3 normal = orl_facet_normal(g, facet);
    const struct orl_frame frame = orl_frame_about(front ? normal : orl_neg(normal));
    uint32_t left = 0;
    double u[AT_ONCE][2];
    struct orl_vec3 points[AT_ONCE], directions[AT_ONCE];
    for (uint32_t k = 0; k < n; k++) {
        u[k][0] = orl_random_uniform(random);
        u[k][1] = orl_random_uniform(random);
        const double x = orl_random_uniform(random), y = orl_random_uniform(random);
        directions[k] = orl_to_world(&frame, orl_hemisphere_point(x, y));
    }
    orl_facet_sample_many(g, facet, (const double(*)[2])u, n, points);
    for (uint32_t k = 0; k < n; k++) {
        const struct orl_vec3 start = orl_facet_ray_origin(g, facet, points[k], normal, frame.n);
        left += !orl_geometry_occluded(g, start, directions[k], INFINITY);
    }
    return left;
}

void orl_escape_shares(const struct orl_geometry *geometry, uint32_t facet, uint32_t rays,
                       struct orl_random *random, double ret_shares[2])
{
    uint32_t left[2] = {0, 0}, sent = 0;
    while (sent < rays && !orl_escape_is_decided(left, sent)) {
        const uint32_t n = rays - sent < AT_ONCE ? rays - sent : AT_ONCE;
        for (int side = 0; side < 2; side++)
            left[side] += count_leaving(geometry, facet, side == 0, n, random);
        sent += n;
    }
    for (int side = 0; side < 2; side++)
        ret_shares[side] = (double)left[side] / sent;
}

bool orl_escape_shows_outside(const double shares[2])
{
    const double more = fmax(shares[0], shares[1]), less = fmin(shares[0], shares[1]);
    return more >= least_seen && more >= least_contrast * less;
}

static const double seldom = 2e-3;
/* Weight of a ray that meets a convex mirror. If such mirrors fill a share p of a window's view,
 * they reflect p / 4 of the sun's irradiance onto it; lenses and hollow mirrors of the same size
 * send several times p. */
static const double convex_weight = 0.1;

/* Returns true if a mirror is seen from the side where it spreads light; textured ones are taken to
 * do so. */
static bool is_convex(const struct orl_facet *f, const struct orl_hit *hit)
{
    const bool inwards =
        f->kind == ORL_SURFACE_BUBBLE || f->kind == ORL_SURFACE_TUBE || f->kind == ORL_SURFACE_CUP;
    return orl_surface_kind_is_flat(f->kind) || hit->front != inwards;
}

/* Returns true if a scene has any surface that focuses or spreads the light of a sun. */
static bool has_focusing_surfaces(const struct orl_scene *scene)
{
    struct orl_facet_iterator walk = orl_facet_iterator(scene->geometry);
    while (orl_facet_iterator_next(&walk)) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get(scene->geometry, walk.facet, &own);
        const struct orl_material *m = &scene->parsed_scene.materials[f->material];
        if (orl_material_deviates(m) ||
            (orl_material_is_mirror(m) && (!orl_surface_kind_is_flat(f->kind) || m->texture)))
            return true;
    }
    return false;
}

static double weight_of(struct orl_focusing_probe *probe, const struct orl_hit *hit)
{
    static const double parallel = 0.999;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get(probe->scene->geometry, hit->facet, &own);
    const struct orl_material *m = orl_scene_material(probe->scene, hit->facet);
    const bool flat_normals = orl_surface_kind_is_flat(f->kind);
    if (!orl_material_deviates(m)) {
        const bool curved = !flat_normals || m->texture;
        return !orl_material_is_mirror(m) || !curved ? 0 : is_convex(f, hit) ? convex_weight : 1;
    }
    if (!flat_normals || m->texture || probe->any_orientation)
        return 1;
    for (int i = 0; i < 2; i++) {
        if (!(orl_dot(probe->flat_normals[i], probe->flat_normals[i]) > 0))
            probe->flat_normals[i] = hit->normal;
        if (fabs(orl_dot(probe->flat_normals[i], hit->normal)) >= parallel)
            return 0;
    }
    return 1;
}

void orl_focusing_trace(struct orl_focusing_probe *probe, struct orl_vec3 from,
                        struct orl_vec3 direction)
{
    struct orl_hit hit;
    probe->rays++;
    if (orl_geometry_intersect(probe->scene->geometry, from, direction, INFINITY, &hit))
        probe->focusing_rays += weight_of(probe, &hit);
}

bool orl_focusing_is_significant(const struct orl_focusing_probe *probe)
{
    return probe->focusing_rays > 0 && probe->focusing_rays >= seldom * (double)probe->rays;
}

/*
 * Search for photon ports. Rays are traced from both faces of a window, with all surfaces opaque.
 * The window is a port if rays from one face reach open space much more often than rays from the
 * other. Panes inside a building see open space from neither side (the outer panes block), and
 * free-standing panes see it from both. Windows behind lenses or curved mirrors are not ports
 * (orl_focusing_is_significant): the scene is then open, and photons from suns and sky pass them.
 */
enum { OWNER_PROBES = 128 };
enum { MOST_RAYS = 4000000, MOST_RAYS_A_FACE = 2048, LEAST_RAYS_A_FACE = 64 };
enum { SEAL_PATHS = 16384, SEAL_BOUNCES = 8, SEAL_ESCAPES = 2 };

struct search {
    const struct orl_scene *scene;
    const uint32_t *candidates;
    struct orl_port *found; /* one per candidate; area 0: not a port */
    uint32_t rays;
    bool lenses; /* the scene has lenses or curved mirrors */
    const struct orl_port *ports;
    size_t n_ports;
    atomic_uint escapes;
};

/* Returns a cosine-weighted direction about normal. It projects a point of the unit disc, which
 * is sampled by rejection from the square around it. */
static struct orl_vec3 cosine_direction(struct orl_vec3 normal, struct orl_random *random)
{
    const struct orl_frame frame = orl_frame_about(normal);
    double x, y, square;
    do {
        x = 2 * orl_random_uniform(random) - 1;
        y = 2 * orl_random_uniform(random) - 1;
        square = x * x + y * y;
    } while (square > 1);
    return orl_to_world(&frame, orl_v3(x, y, sqrt(1 - square)));
}

bool orl_port_owns_shared(const struct orl_geometry *g, const struct orl_port *port,
                          struct orl_vec3 point)
{
    const double offset = orl_facet_offset(g, port->facet);
    struct orl_hit hit;
    /* No hit means that the ray passed the rim: no other surface is there either. */
    return !orl_geometry_intersect(g, orl_madd(point, port->outward, offset),
                                   orl_neg(port->outward), 2 * offset, &hit) ||
           hit.facet == port->facet;
}

static bool is_shared(const struct orl_geometry *g, struct orl_port port, struct orl_random *random)
{
    port.shared = true;
    for (int i = 0; i < OWNER_PROBES; i++) {
        const double u[2] = {orl_random_uniform(random), orl_random_uniform(random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(g, port.facet, u, &point, &normal);
        if (!orl_port_owns(g, &port, point))
            return true;
    }
    return false;
}

/* Returns true if lenses or curved mirrors are before a window outdoors. */
static bool is_behind_lenses(const struct search *search, const struct orl_port *port,
                             struct orl_random *random)
{
    const struct orl_geometry *g = search->scene->geometry;
    struct orl_focusing_probe probe = {.scene = search->scene};
    for (uint32_t i = 0; i < search->rays; i++) {
        const double u[2] = {orl_random_uniform(random), orl_random_uniform(random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(g, port->facet, u, &point, &normal);
        orl_focusing_trace(&probe,
                           orl_facet_ray_origin(g, port->facet, point, normal, port->outward),
                           cosine_direction(port->outward, random));
    }
    return orl_focusing_is_significant(&probe);
}

static void test_window(void *arg, size_t index, uint32_t member)
{
    struct search *search = arg;
    const uint32_t facet = search->candidates[index];
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(search->scene->geometry, facet, &own);
    struct orl_random random = orl_random_stream(0, ORL_PURPOSE_PILOT, facet);
    (void)member;
    double shares[2];
    orl_escape_shares(search->scene->geometry, facet, search->rays, &random, shares);
    if (!orl_escape_shows_outside(shares))
        return;
    const bool front = shares[0] > shares[1];
    struct orl_port port = {.facet = facet,
                            .outside_is_front = front,
                            .outward = front ? f->normal : orl_neg(f->normal),
                            .area = f->area};
    port.shared = is_shared(search->scene->geometry, port, &random);
    if (!search->lenses || !is_behind_lenses(search, &port, &random))
        search->found[index] = port;
}

/*
 * Follows a diffuse path from a port's inner face, and counts it if it escapes without crossing a
 * port. Ports block it. Windows that are not ports (curved ones, panes with the sky on both sides)
 * let it through.
 */
static void trace_escape(void *arg, size_t index, uint32_t member)
{
    struct search *search = arg;
    const struct orl_geometry *g = search->scene->geometry;
    const struct orl_port *port = &search->ports[index % search->n_ports];
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_PILOT, index);
    const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
    struct orl_vec3 point, normal;
    (void)member;
    orl_facet_sample(g, port->facet, u, &point, &normal);
    normal = orl_neg(port->outward);
    point = orl_facet_ray_origin(g, port->facet, point, orl_facet_normal(g, port->facet), normal);
    struct orl_vec3 direction = cosine_direction(normal, &random);
    for (int bounce = 0; bounce < SEAL_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(g, point, direction, INFINITY, &hit)) {
            atomic_fetch_add_explicit(&search->escapes, 1, memory_order_relaxed);
            return;
        }
        const bool through = orl_material_is_window(orl_scene_material(search->scene, hit.facet)) &&
                             orl_scene_crossing(search->scene, &hit) == ORL_CROSSING_NONE;
        if (!through)
            direction = cosine_direction(orl_hit_facing(&hit), &random);
        point = orl_hit_ray_origin(g, &hit, direction);
    }
}

static size_t list_candidates(const struct orl_scene *scene, uint32_t *ret_candidates)
{
    size_t n = 0;
    for (size_t i = 0; i < scene->geometry->n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(scene->geometry, i, &own);
        if (f->kind == ORL_SURFACE_POLYGON && f->area > 0 &&
            orl_material_is_window(orl_scene_material(scene, i)))
            ret_candidates[n++] = (uint32_t)i;
    }
    return n;
}

int orl_scene_find_ports(struct orl_scene *scene, struct orl_thread_pool *pool,
                         struct orl_error *err)
{
    const size_t n_facets = scene->geometry->n_facets;
    struct search search = {.scene = scene};
    uint32_t *candidates = malloc((n_facets + 1) * sizeof *candidates);
    struct orl_port *found = NULL;
    int code = ORL_ERR_NOMEM;
    if (!candidates)
        goto done;
    /* Scenes with participating media have no ports: the split of light by ports holds only between
     * surfaces. */
    const size_t n = scene->mist ? 0 : list_candidates(scene, candidates);
    found = calloc(n + 1, sizeof *found);
    scene->port_of_facet = malloc((n_facets + 1) * sizeof *scene->port_of_facet);
    if (!found || !scene->port_of_facet)
        goto done;
    search.candidates = candidates;
    search.lenses = n > 0 && has_focusing_surfaces(scene);
    search.found = found;
    const size_t share = MOST_RAYS / (n + 1);
    search.rays = (uint32_t)(share > MOST_RAYS_A_FACE    ? MOST_RAYS_A_FACE
                             : share < LEAST_RAYS_A_FACE ? LEAST_RAYS_A_FACE
                                                         : share);
    code = orl_parallel_try(pool, n, test_window, &search);
    if (code < 0)
        goto done;
    for (size_t i = 0; i < n_facets; i++)
        scene->port_of_facet[i] = ORL_NO_PORT;
    for (size_t i = 0; i < n; i++) {
        if (found[i].area > 0) {
            scene->port_of_facet[found[i].facet] = (int32_t)scene->n_ports;
            found[scene->n_ports++] = found[i];
        }
    }
    scene->ports = found;
    found = NULL;
    atomic_init(&search.escapes, 0);
    search.ports = scene->ports;
    search.n_ports = scene->n_ports;
    if (scene->n_ports > 0)
        code = orl_parallel_try(pool, SEAL_PATHS, trace_escape, &search);
    if (code < 0)
        goto done;
    scene->open = scene->n_ports == 0 || atomic_load(&search.escapes) >= SEAL_ESCAPES;
done:
    if (code < 0)
        orl_error_set(err, code, "%s while looking for photon ports",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    free(found);
    free(candidates);
    return code;
}

enum orl_port_crossing orl_scene_crossing(const struct orl_scene *scene, const struct orl_hit *hit)
{
    const int32_t port = orl_scene_port_of(scene, hit->facet);
    if (port == ORL_NO_PORT)
        return ORL_CROSSING_NONE;
    return hit->front == scene->ports[port].outside_is_front ? ORL_CROSSING_INWARDS
                                                             : ORL_CROSSING_OUTWARDS;
}
