#include "light/reach.h"

#include <stdatomic.h>

#include "base/random.h"
#include "light/path.h"
#include "scene/material/hemisphere.h"

enum { MOST_BOUNCES = 64, CHUNK = 64 };

struct quest {
    const struct orl_world *world;
    const struct orl_outlook *outlooks;
    size_t count, paths;
    atomic_bool found;
};

static struct orl_vec3 sample_direction(const struct orl_outlook *outlook,
                                        struct orl_random *random)
{
    const double u = orl_random_uniform(random), v = orl_random_uniform(random);
    if (orl_dot(outlook->normal, outlook->normal) > 0)
        return orl_hemisphere_about(outlook->normal, u, v);
    const double z = 2 * u - 1, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * ORL_PI * v;
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/* Returns true if a random point of a random lamp is visible; windows do not block. */
static bool sees_lamp(const struct orl_world *world, struct orl_vec3 point,
                      struct orl_random *random)
{
    const struct orl_geometry *g = world->geometry;
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const double u[2] = {orl_random_uniform(random), u1};
    struct orl_vec3 there, normal;
    struct orl_hit hit;
    if (world->n_emitters == 0)
        return false;
    const uint32_t facet = world->emitters[(size_t)(u0 * (double)world->n_emitters)].facet;
    orl_facet_sample(g, facet, u, &there, &normal);
    struct orl_path path = orl_path_from(point, orl_normalize(orl_sub(there, point)));
    for (int pane = 0; pane < MOST_BOUNCES; pane++) {
        if (!orl_path_meet(world, &path, &hit))
            return false;
        if (hit.facet == facet)
            return true;
        if (!orl_material_is_window(orl_world_material(world, &hit)))
            return false;
        orl_path_pass(&path, world, &hit);
    }
    return false;
}

/*
 * Returns true if there is a sun or a dome, and a ray that met no surface escapes through a hole.
 * Rays have float coordinates: one in ten million leaves a hit slightly beyond the edge where two
 * walls meet, and so escapes. A ray that also escapes from slightly before that hit has found a
 * hole.
 */
static bool is_real_escape(const struct orl_world *world, struct orl_vec3 before,
                           struct orl_vec3 direction)
{
    struct orl_hit hit;
    return world->n_suns + world->n_domes > 0 &&
           !orl_geometry_intersect(world->geometry, before, direction, INFINITY, &hit);
}

static bool finds_light(const struct quest *quest, size_t number)
{
    const struct orl_world *world = quest->world;
    const struct orl_outlook *outlook = &quest->outlooks[number % quest->count];
    const double little = 1e-4 * world->geometry->radius;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, number);
    struct orl_vec3 before = outlook->point;
    struct orl_path path = orl_path_from(before, sample_direction(outlook, &random));
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (sees_lamp(world, path.origin, &random))
            return true;
        if (!orl_path_meet(world, &path, &hit))
            return is_real_escape(world, before, path.direction);
        before = orl_madd(hit.point, path.direction, -fmin(little, 0.5 * hit.distance));
        const bool window = orl_material_is_window(orl_world_material(world, &hit));
        if (!window) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            path.direction = orl_hemisphere_about(orl_hit_facing(&hit), u, v);
        }
        orl_path_pass(&path, world, &hit);
        if (window)
            before = path.origin;
    }
    return false;
}

static void trace_chunk(void *arg, size_t chunk, uint32_t member)
{
    struct quest *quest = arg;
    const size_t end = (chunk + 1) * CHUNK < quest->paths ? (chunk + 1) * CHUNK : quest->paths;
    (void)member;
    for (size_t path = chunk * CHUNK; path < end; path++) {
        /* The result does not depend on which path finds light first. */
        if (atomic_load_explicit(&quest->found, memory_order_relaxed))
            return;
        if (finds_light(quest, path))
            atomic_store_explicit(&quest->found, true, memory_order_relaxed);
    }
}

bool orl_light_reaches(const struct orl_world *world, const struct orl_outlook *outlooks,
                       size_t count, size_t paths, struct orl_crew *crew)
{
    struct quest quest = {.world = world, .outlooks = outlooks, .count = count, .paths = paths};
    atomic_init(&quest.found, false);
    const int code =
        count > 0 ? orl_crew_try(crew, (paths + CHUNK - 1) / CHUNK, trace_chunk, &quest) : 0;
    return code < 0 || atomic_load(&quest.found);
}
