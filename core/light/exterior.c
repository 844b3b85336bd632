#include "light/exterior.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 3, MOST_PANES = 64 };

/* Suns and lights on one side of the surface, as its lobes send them towards the eye. */
static struct orl_rgb lobes_of_side(const struct orl_world *world, const struct orl_hit *hit,
                                    struct orl_vec3 eye, struct orl_vec3 side,
                                    struct orl_random *random)
{
    const struct orl_direct_query query = {.point = orl_hit_leave(world->geometry, hit, side),
                                           .normal = side,
                                           .lobes = orl_world_material(world, hit),
                                           .hit = hit,
                                           .eye = eye,
                                           .mirrored = true};
    return orl_direct_light(world, &query, random);
}

/* Lambertian reflection of suns and lights by a surface of that albedo, on the side of the eye. */
static struct orl_rgb diffuse_direct(const struct orl_world *world, const struct orl_hit *hit,
                                     struct orl_vec3 normal, struct orl_rgb albedo,
                                     struct orl_random *random)
{
    const struct orl_direct_query query = {
        .point = orl_hit_leave(world->geometry, hit, normal), .normal = normal, .mirrored = true};
    return orl_rgb_mul(orl_rgb_scale(albedo, 1 / ORL_PI), orl_direct_light(world, &query, random));
}

/* What suns and lights send towards the eye by way of this surface. */
static struct orl_rgb scattered_direct(const struct orl_world *world, const struct orl_hit *hit,
                                       struct orl_vec3 eye, struct orl_random *random)
{
    const struct orl_material *m = orl_world_material(world, hit);
    const struct orl_vec3 normal = hit->front ? hit->normal : orl_neg(hit->normal);
    const struct orl_rgb diffuse = orl_material_diffuse(m);
    struct orl_rgb sum = orl_gray(0);
    if (orl_rgb_max(diffuse) > 0)
        sum = diffuse_direct(world, hit, normal, diffuse, random);
    if (orl_material_has_lobes(m))
        sum = orl_rgb_add(sum, lobes_of_side(world, hit, eye, normal, random));
    if (orl_material_transmits_lobes(m) && orl_world_crossing(world, hit) != ORL_CROSSING_INWARDS)
        sum = orl_rgb_add(sum, lobes_of_side(world, hit, eye, orl_neg(normal), random));
    return sum;
}

/*
 * A BSDF port met from outside after a diffuse bounce. Its sharp lobes would put the sun on the
 * ground as sparks that hardly any path finds, so their flux is kept and their shape is not: light
 * is sent back evenly, by the reflectance for the direction it comes from.
 */
static struct orl_rgb folded_direct(const struct orl_world *world, const struct orl_hit *hit)
{
    const struct orl_material *m = orl_world_material(world, hit);
    const struct orl_vec3 normal = hit->front ? hit->normal : orl_neg(hit->normal);
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->n_suns; i++) {
        const struct orl_vec3 sun = world->suns[i].frame.n;
        const double cosine = orl_dot(sun, normal);
        if (!(cosine > 0))
            continue;
        const struct orl_rgb albedo = orl_material_albedo(m, hit, sun, ORL_LOBE_REFLECTED);
        const struct orl_rgb share = orl_transmittance(
            world, orl_hit_leave(world->geometry, hit, normal), sun, INFINITY, false);
        sum = orl_rgb_add(
            sum, orl_rgb_scale(orl_rgb_mul(orl_rgb_mul(albedo, share), world->suns[i].irradiance),
                               cosine / ORL_PI));
    }
    return sum;
}

/*
 * The domes where nothing stands before them, and what shines there: surfaces outside let light
 * through or stop it, and send none back.
 */
static struct orl_rgb unreflected_radiance(const struct orl_world *world, struct orl_vec3 origin,
                                           struct orl_vec3 direction, struct orl_chance chance,
                                           struct orl_health *health)
{
    struct orl_rgb sum = orl_gray(0), weight = orl_gray(1);
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        health->rays++;
        if (!orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit))
            return orl_rgb_add(sum, orl_rgb_mul(weight, orl_world_dome_radiance(world, direction)));
        const struct orl_material *m = orl_world_material(world, &hit);
        const struct orl_vec3 eye = orl_neg(direction);
        sum = orl_rgb_add(sum, orl_rgb_mul(weight, orl_shining(world, &hit, eye, &chance)));
        weight = orl_rgb_mul(weight, orl_material_straight(m, &hit, eye));
        if (!(orl_rgb_max(weight) > 0) || orl_world_crossing(world, &hit) == ORL_CROSSING_INWARDS)
            return sum;
        origin = orl_hit_leave(world->geometry, &hit, direction);
    }
    return sum;
}

bool orl_port_looks(const struct orl_world *world, const struct orl_port *port)
{
    return !port->clear && !world->omit.exterior;
}

struct orl_rgb orl_port_radiance(const struct orl_world *world, const struct orl_port *port,
                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                 struct orl_random *random, struct orl_health *health)
{
    if (!port->clear)
        return orl_exterior_radiance(world, origin, direction, orl_chance_unsought(), random,
                                     health);
    health->paths++;
    return orl_world_dome_radiance(world, direction);
}

struct orl_rgb orl_exterior_radiance(const struct orl_world *world, struct orl_vec3 origin,
                                     struct orl_vec3 direction, struct orl_chance chance,
                                     struct orl_random *random, struct orl_health *health)
{
    struct orl_hit hit;
    if (world->omit.exterior) {
        health->paths++;
        return unreflected_radiance(world, origin, direction, chance, health);
    }
    const bool met = orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit);
    return orl_exterior_radiance_from(world, direction, met ? &hit : NULL, chance, random, health);
}

struct orl_rgb orl_exterior_radiance_from(const struct orl_world *world, struct orl_vec3 direction,
                                          const struct orl_hit *first, struct orl_chance chance,
                                          struct orl_random *random, struct orl_health *health)
{
    struct orl_rgb sum = orl_gray(0), weight = orl_gray(1), clarity = orl_gray(1);
    const enum orl_lobes back = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_DIFFUSE);
    const struct orl_hit *met = first;
    bool diffused = false;
    struct orl_hit hit;
    health->paths++;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        health->rays++;
        if (!met) {
            const struct orl_rgb sky = orl_world_dome_radiance(world, direction);
            weight = orl_rgb_mul(weight, orl_clarity_after(clarity, INFINITY));
            return orl_rgb_add(sum, orl_rgb_mul(weight, sky));
        }
        hit = *met;
        const struct orl_material *m = orl_world_material(world, &hit);
        const struct orl_vec3 eye = orl_neg(direction);
        weight = orl_rgb_mul(weight, orl_material_dimming(m, &hit, clarity));
        sum = orl_rgb_add(sum, orl_rgb_mul(weight, orl_shining(world, &hit, eye, &chance)));
        const bool barred = orl_world_crossing(world, &hit) == ORL_CROSSING_INWARDS;
        const bool folded = barred && diffused && m->kind == ORL_MATERIAL_BSDF;
        const struct orl_rgb direct =
            folded ? folded_direct(world, &hit) : scattered_direct(world, &hit, eye, random);
        sum = orl_rgb_add(sum, orl_rgb_mul(weight, direct));
        const struct orl_scatter s = orl_scatter_sample(m, &hit, eye, ORL_TRANSPORT_EYE,
                                                        barred ? back : ORL_LOBE_ALL, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return sum;
        chance = folded ? orl_chance_found() : orl_chance_after(world, &hit, eye, &s, chance);
        diffused = diffused || s.event == ORL_EVENT_DIFFUSE;
        weight = orl_rgb_mul(weight, s.weight);
        if (bounce >= SURE_BOUNCES) {
            const double survive = fmin(orl_rgb_max(weight), 1.0);
            if (orl_random_uniform(random) >= survive)
                return sum;
            weight = orl_rgb_scale(weight, 1 / survive);
        }
        clarity = orl_scatter_clarity(m, &s, clarity);
        direction = s.direction;
        const struct orl_vec3 origin = orl_hit_leave(world->geometry, &hit, direction);
        met = orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit) ? &hit
                                                                                         : NULL;
    }
    health->paths_capped++;
    return sum;
}
