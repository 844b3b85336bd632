#include "annual/reach.h"

#include <stdlib.h>

#include "base/random.h"
#include "light/direct.h"
#include "light/path.h"
#include "scene/material/hemisphere.h"
#include "scene/material/scatter.h"

/* Rays of a side; fewer of each where there are many. */
enum { MOST_RAYS = 256, LEAST_RAYS = 16, ALL_RAYS = 1 << 20 };
enum { SENSOR_RAYS = 64, PORT_POINTS = 16, MOST_PANES = 64 };

struct flood {
    struct orl_reach *reach;
    uint32_t *queue; /* sides: facet * 2 + (0: front, 1: back) */
    size_t count;
};

/* ---- Surfaces -------------------------------------------------------------------------------- */

static bool is_opaque(const struct orl_material *m, const struct orl_hit *hit)
{
    switch (m->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_ASHIKHMIN:
    case ORL_MATERIAL_MIRROR:
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
        return true;
    case ORL_MATERIAL_GLASS: /* of windows that are closed */
        return !(orl_rgb_max(orl_material_straight(m, hit, orl_hit_facing(hit))) > 0);
    default:
        return false;
    }
}

static void add_side(struct flood *flood, uint32_t side)
{
    if (flood->reach->sides[side])
        return;
    flood->reach->sides[side] = true;
    flood->queue[flood->count++] = side;
}

/* The side that a hit has met; UINT32_MAX: of a placed object. */
static uint32_t side_of(const struct orl_world *world, const struct orl_hit *hit)
{
    return orl_facet_is_placed(world->geometry, hit->facet) ? UINT32_MAX
                                                            : hit->facet * 2 + !hit->front;
}

static void add_hit(struct flood *flood, const struct orl_hit *hit)
{
    const struct orl_world *world = flood->reach->world;
    const uint32_t side = side_of(world, hit);
    if (side == UINT32_MAX) {
        flood->reach->all = true;
        return;
    }
    add_side(flood, side);
    if (orl_world_port_of(world, hit->facet) == ORL_NO_PORT &&
        !is_opaque(orl_world_material(world, hit), hit))
        add_side(flood, side ^ 1);
}

static void shoot_from_side(struct flood *flood, uint32_t side, uint32_t rays)
{
    const struct orl_world *world = flood->reach->world;
    const uint32_t facet = side / 2;
    struct orl_random random = orl_random_stream(side, ORL_PURPOSE_ANNUAL, ~(uint64_t)0);
    for (uint32_t i = 0; i < rays; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        const double v = orl_random_uniform(&random), w = orl_random_uniform(&random);
        struct orl_vec3 point, normal;
        orl_facet_sample(world->geometry, facet, u, &point, &normal);
        const struct orl_vec3 direction =
            orl_hemisphere_about(side & 1 ? orl_neg(normal) : normal, v, w);
        const struct orl_path path = orl_path_from(
            orl_facet_leave(world->geometry, facet, point, normal, direction), direction);
        struct orl_hit hit;
        if (orl_path_meet(world, &path, &hit))
            add_hit(flood, &hit);
    }
}

/* Polls cancellation at each side. */
static int spread(struct flood *flood, const atomic_bool *cancel)
{
    const size_t sides = 2 * flood->reach->world->geometry->n_facets;
    const size_t share = ALL_RAYS / (sides + 1);
    const uint32_t rays = share > MOST_RAYS    ? MOST_RAYS
                          : share < LEAST_RAYS ? LEAST_RAYS
                                               : (uint32_t)share;
    for (size_t i = 0; i < flood->count && !flood->reach->all; i++) {
        if (cancel && atomic_load(cancel))
            return ORL_ERR_CANCELLED;
        shoot_from_side(flood, flood->queue[i], rays);
    }
    return 0;
}

int orl_reach_init(struct orl_reach *reach, const struct orl_world *world,
                   const atomic_bool *cancel)
{
    const size_t sides = 2 * world->geometry->n_facets;
    *reach = (struct orl_reach){.world = world, .sides = calloc(sides + 1, sizeof *reach->sides)};
    struct flood flood = {.reach = reach, .queue = malloc((sides + 1) * sizeof *flood.queue)};
    int code = reach->sides && flood.queue ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < world->n_ports; i++) {
        const struct orl_port *port = &world->ports[i];
        if (orl_facet_is_placed(world->geometry, port->facet))
            reach->all = true;
        else
            add_side(&flood, port->facet * 2 + port->outside_is_front);
    }
    if (code == 0)
        code = spread(&flood, cancel);
    free(flood.queue);
    return code;
}

void orl_reach_done(struct orl_reach *reach)
{
    free(reach->sides);
    *reach = (struct orl_reach){.world = NULL};
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static bool sees_port(const struct orl_reach *reach, const struct orl_place *place,
                      const struct orl_port *port, struct orl_random *random)
{
    const struct orl_world *world = reach->world;
    for (int i = 0; i < PORT_POINTS; i++) {
        const double u[2] = {orl_random_uniform(random), orl_random_uniform(random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(world->geometry, port->facet, u, &point, &normal);
        const struct orl_vec3 way = orl_sub(point, place->point);
        const double distance = orl_length(way);
        if (!(orl_dot(way, place->normal) > 0) || !(orl_dot(way, port->outward) > 0))
            continue;
        if (orl_rgb_max(orl_transmittance(
                world, place->point, orl_scale(way, 1 / distance),
                distance * (1 - 1e-6) - 2 * orl_facet_offset(world->geometry, port->facet), true)) >
            0)
            return true;
    }
    return false;
}

bool orl_reach_has(const struct orl_reach *reach, const struct orl_place *place)
{
    const struct orl_world *world = reach->world;
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_ANNUAL, ~(uint64_t)1);
    if (reach->all)
        return true;
    for (int i = 0; i < SENSOR_RAYS; i++) {
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        const struct orl_path path =
            orl_path_from(place->point, orl_hemisphere_about(place->normal, u, v));
        struct orl_hit hit;
        if (!orl_path_meet(world, &path, &hit))
            continue;
        const uint32_t side = side_of(world, &hit);
        if (side == UINT32_MAX || reach->sides[side])
            return true;
    }
    for (size_t i = 0; i < world->n_ports; i++)
        if (sees_port(reach, place, &world->ports[i], &random))
            return true;
    return false;
}
