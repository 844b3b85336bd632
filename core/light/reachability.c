#include "light/enclosures.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "light/path.h"
#include "scene/material/scatter.h"

enum { MOST_BOUNCES = 64, CHUNK = 64 };

struct search {
    const struct orl_lit_scene *lit_scene;
    const struct orl_query_point *query_points;
    size_t count, paths;
    atomic_bool found;
};

static struct orl_vec3 sample_direction(const struct orl_query_point *query_point,
                                        struct orl_random *random)
{
    const double u = orl_random_uniform(random), v = orl_random_uniform(random);
    if (orl_dot(query_point->normal, query_point->normal) > 0)
        return orl_hemisphere_about(query_point->normal, u, v);
    const double z = 2 * u - 1, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * ORL_PI * v;
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/* Returns true if a random point of a random lamp is visible; windows do not block. */
static bool sees_lamp(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                      struct orl_random *random)
{
    const struct orl_geometry *g = lit_scene->geometry;
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const double u[2] = {orl_random_uniform(random), u1};
    struct orl_vec3 there, normal;
    struct orl_hit hit;
    if (lit_scene->n_emitters == 0)
        return false;
    const uint32_t facet = lit_scene->emitters[(size_t)(u0 * (double)lit_scene->n_emitters)].facet;
    orl_facet_sample(g, facet, u, &there, &normal);
    struct orl_path path = orl_path_from(point, orl_normalize(orl_sub(there, point)));
    for (int pane = 0; pane < MOST_BOUNCES; pane++) {
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return false;
        if (hit.facet == facet)
            return true;
        if (!orl_material_is_window(orl_lit_scene_material(lit_scene, &hit)))
            return false;
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
    return false;
}

/*
 * Returns true if there is a sun or a dome, and a ray that met no surface escapes through a hole.
 * Rays have float coordinates: one in ten million leaves a hit slightly beyond the edge where two
 * walls meet, and so escapes. A ray that also escapes from slightly before that hit has found a
 * hole.
 */
static bool is_real_escape(const struct orl_lit_scene *lit_scene, struct orl_vec3 before,
                           struct orl_vec3 direction)
{
    struct orl_hit hit;
    return lit_scene->n_suns + lit_scene->n_domes > 0 &&
           !orl_geometry_intersect(lit_scene->geometry, before, direction, INFINITY, &hit);
}

static bool finds_light(const struct search *search, size_t number)
{
    const struct orl_lit_scene *lit_scene = search->lit_scene;
    const struct orl_query_point *query_point = &search->query_points[number % search->count];
    const double little = 1e-4 * lit_scene->geometry->radius;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, number);
    struct orl_vec3 before = query_point->point;
    struct orl_path path = orl_path_from(before, sample_direction(query_point, &random));
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (sees_lamp(lit_scene, path.origin, &random))
            return true;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return is_real_escape(lit_scene, before, path.direction);
        before = orl_madd(hit.point, path.direction, -fmin(little, 0.5 * hit.distance));
        const bool window = orl_material_is_window(orl_lit_scene_material(lit_scene, &hit));
        if (!window) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            path.direction = orl_hemisphere_about(orl_hit_facing(&hit), u, v);
        }
        orl_path_skip_surface(&path, lit_scene, &hit);
        if (window)
            before = path.origin;
    }
    return false;
}

static void trace_chunk(void *arg, size_t chunk, uint32_t member)
{
    struct search *search = arg;
    const size_t end = (chunk + 1) * CHUNK < search->paths ? (chunk + 1) * CHUNK : search->paths;
    (void)member;
    for (size_t path = chunk * CHUNK; path < end; path++) {
        /* The result does not depend on which path finds light first. */
        if (atomic_load_explicit(&search->found, memory_order_relaxed))
            return;
        if (finds_light(search, path))
            atomic_store_explicit(&search->found, true, memory_order_relaxed);
    }
}

bool orl_light_reaches(const struct orl_lit_scene *lit_scene,
                       const struct orl_query_point *query_points, size_t count, size_t paths,
                       struct orl_thread_pool *pool)
{
    struct search search = {
        .lit_scene = lit_scene, .query_points = query_points, .count = count, .paths = paths};
    atomic_init(&search.found, false);
    const int code =
        count > 0 ? orl_parallel_try(pool, (paths + CHUNK - 1) / CHUNK, trace_chunk, &search) : 0;
    return code < 0 || atomic_load(&search.found);
}

/* Test whether a point is outside a sealed building, by tracing rays from it. */

enum { RAYS = 32, BOUNCES = 64, MARGIN = 2 };

/* Numbers of ports that rays met by their outer and by their inner faces. */
struct vote_counts {
    int outside, inside;
};

static struct orl_vec3 direction_of(int ray)
{
    const double z = 1 - (2 * ray + 1.0) / RAYS, s = sqrt(1 - z * z);
    const double phi = 2.399963229728653 * ray;
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/* Counts a hit of a port, also of one that is closed temporarily. Returns true if it is one. */
static bool count_port(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                       struct vote_counts *vote_counts)
{
    const enum orl_port_crossing crossing = orl_scene_crossing(lit_scene->scene, hit);
    vote_counts->outside += crossing == ORL_CROSSING_INWARDS;
    vote_counts->inside += crossing == ORL_CROSSING_OUTWARDS;
    return crossing != ORL_CROSSING_NONE;
}

/* Follows a diffuse path from the point. It stays on its side of the surfaces until it meets a
 * port or leaves the scene. Windows that are not ports let it through. */
static void trace_walk(const struct orl_lit_scene *lit_scene, struct orl_vec3 point, int ray,
                       struct vote_counts *vote_counts)
{
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, (uint64_t)ray);
    struct orl_vec3 direction = direction_of(ray);
    for (int bounce = 0; bounce < BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(lit_scene->geometry, point, direction, INFINITY, &hit)) {
            vote_counts->outside++;
            return;
        }
        if (count_port(lit_scene, &hit, vote_counts))
            return;
        if (!orl_material_is_window(orl_scene_material(lit_scene->scene, hit.facet))) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            direction = orl_hemisphere_about(orl_hit_facing(&hit), u, v);
        }
        point = orl_hit_ray_origin(lit_scene->geometry, &hit, direction);
    }
}

/*
 * No point inside sees past the walls, and most points outside do. Points outside that do not,
 * between slats and the pane behind them, see a pane's outer face.
 */
bool orl_lit_scene_is_outside(const struct orl_lit_scene *lit_scene, struct orl_vec3 point)
{
    struct vote_counts vote_counts = {0, 0};
    if (lit_scene->open)
        return false;
    for (int i = 0; i < RAYS; i++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(lit_scene->geometry, point, direction_of(i), INFINITY, &hit))
            return true;
        count_port(lit_scene, &hit, &vote_counts);
    }
    for (int i = 0; i < RAYS && abs(vote_counts.outside - vote_counts.inside) < MARGIN; i++)
        trace_walk(lit_scene, point, i, &vote_counts);
    return vote_counts.outside > vote_counts.inside;
}
