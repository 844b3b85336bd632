#include "light/exterior.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 3, MOST_PANES = 64 };

/* A path outdoors. */
struct outing {
    const struct orl_world *world;
    bool enters; /* it may pass ports, as light may that it meets; else it looks for first light */
    bool diffused;
    struct orl_random *random;
};

/* Suns and lights on one side of the surface, as its lobes send them towards the eye. */
static struct orl_rgb lobes_of_side(const struct outing *o, const struct orl_hit *hit,
                                    struct orl_vec3 eye, struct orl_vec3 side)
{
    const struct orl_direct_query query = {.point = orl_hit_leave(o->world->geometry, hit, side),
                                           .normal = side,
                                           .through_ports = o->enters,
                                           .lobes = orl_world_material(o->world, hit),
                                           .hit = hit,
                                           .eye = eye,
                                           .mirrored = true};
    return orl_direct_light(o->world, &query, o->random);
}

/* Lambertian reflection of suns and lights by a surface of that albedo, on the side of the eye. */
static struct orl_rgb diffuse_direct(const struct outing *o, const struct orl_hit *hit,
                                     struct orl_vec3 normal, struct orl_rgb albedo)
{
    const struct orl_direct_query query = {.point = orl_hit_leave(o->world->geometry, hit, normal),
                                           .normal = normal,
                                           .through_ports = o->enters,
                                           .mirrored = true};
    return orl_rgb_mul(orl_rgb_scale(albedo, 1 / ORL_PI),
                       orl_direct_light(o->world, &query, o->random));
}

/*
 * Whether light from behind the surface is this path's to find. First light has passed no port: not
 * that of a pane in front of another one either, which sends it in itself.
 */
static bool looks_behind(const struct outing *o, const struct orl_hit *hit)
{
    return o->enters || orl_world_crossing(o->world, hit) == ORL_CROSSING_NONE;
}

/* What suns and lights send towards the eye by way of this surface. */
static struct orl_rgb scattered_direct(const struct outing *o, const struct orl_hit *hit,
                                       struct orl_vec3 eye)
{
    const struct orl_material *m = orl_world_material(o->world, hit);
    const struct orl_vec3 normal = hit->front ? hit->normal : orl_neg(hit->normal);
    const struct orl_rgb diffuse = orl_material_diffuse(m);
    struct orl_rgb sum = orl_gray(0);
    if (orl_rgb_max(diffuse) > 0)
        sum = diffuse_direct(o, hit, normal, diffuse);
    if (orl_material_has_lobes(m))
        sum = orl_rgb_add(sum, lobes_of_side(o, hit, eye, normal));
    if (orl_material_transmits_lobes(m) && looks_behind(o, hit))
        sum = orl_rgb_add(sum, lobes_of_side(o, hit, eye, orl_neg(normal)));
    return sum;
}

/*
 * A BSDF port met from outside after a diffuse bounce. Its sharp lobes would put the sun on the
 * ground as sparks that hardly any path finds, so their flux is kept and their shape is not: light
 * is sent on evenly, by the reflectance or transmittance for the direction it comes from.
 */
static struct orl_rgb folded_direct(const struct outing *o, const struct orl_hit *hit)
{
    const struct orl_world *world = o->world;
    const struct orl_material *m = orl_world_material(world, hit);
    const struct orl_vec3 normal = hit->front ? hit->normal : orl_neg(hit->normal);
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->n_suns; i++) {
        const struct orl_vec3 sun = world->suns[i].frame.n;
        const double cosine = orl_dot(sun, normal);
        if (cosine == 0 || (cosine < 0 && !looks_behind(o, hit)))
            continue;
        const struct orl_vec3 side = cosine > 0 ? normal : orl_neg(normal);
        const struct orl_rgb albedo = orl_material_albedo(
            m, hit, sun, cosine > 0 ? ORL_LOBE_REFLECTED : ORL_LOBE_TRANSMITTED);
        const struct orl_rgb share = orl_transmittance(
            world, orl_hit_leave(world->geometry, hit, side), sun, INFINITY, o->enters);
        sum = orl_rgb_add(
            sum, orl_rgb_scale(orl_rgb_mul(orl_rgb_mul(albedo, share), world->suns[i].irradiance),
                               fabs(cosine) / ORL_PI));
    }
    return sum;
}

/*
 * The domes where nothing stands before them, and what shines there: surfaces outside let light
 * through or stop it, and send none back.
 */
static struct orl_rgb unreflected_radiance(const struct outing *o, struct orl_vec3 origin,
                                           struct orl_vec3 direction, struct orl_chance chance,
                                           struct orl_health *health)
{
    const struct orl_world *world = o->world;
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
        if (!(orl_rgb_max(weight) > 0) || !looks_behind(o, &hit) ||
            orl_world_crossing(world, &hit) == ORL_CROSSING_INWARDS)
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
                                     health, NULL);
    health->paths++;
    return orl_world_dome_radiance(world, direction);
}

/* Scattered at a surface; false: the path has ended. */
static bool goes_on(struct orl_random *random, const struct orl_scatter *s, int bounce,
                    struct orl_rgb *weight)
{
    if (s->event == ORL_EVENT_ABSORBED)
        return false;
    *weight = orl_rgb_mul(*weight, s->weight);
    if (bounce < SURE_BOUNCES)
        return true;
    const double survive = fmin(orl_rgb_max(*weight), 1.0);
    if (orl_random_uniform(random) >= survive)
        return false;
    *weight = orl_rgb_scale(*weight, 1 / survive);
    return true;
}

/* A path from what it meets first (NULL: nothing) to its end, or to where it enters. */
static struct orl_rgb follow(struct outing *o, struct orl_vec3 direction,
                             const struct orl_hit *first, struct orl_chance chance,
                             struct orl_health *health, struct orl_entry *ret_entry)
{
    const struct orl_world *world = o->world;
    struct orl_rgb sum = orl_gray(0), weight = orl_gray(1), clarity = orl_gray(1);
    const enum orl_lobes back = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_DIFFUSE);
    const struct orl_hit *met = first;
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
        const bool inwards = orl_world_crossing(world, &hit) == ORL_CROSSING_INWARDS;
        const bool folded = inwards && o->diffused && m->kind == ORL_MATERIAL_BSDF;
        const struct orl_rgb direct =
            folded ? folded_direct(o, &hit) : scattered_direct(o, &hit, eye);
        sum = orl_rgb_add(sum, orl_rgb_mul(weight, direct));
        const struct orl_scatter s =
            orl_scatter_sample(m, &hit, eye, ORL_TRANSPORT_EYE,
                               looks_behind(o, &hit) ? ORL_LOBE_ALL : back, o->random);
        if (!goes_on(o->random, &s, bounce, &weight))
            return sum;
        chance = folded ? orl_chance_found() : orl_chance_after(world, &hit, eye, &s, chance);
        o->diffused = o->diffused || s.event == ORL_EVENT_DIFFUSE;
        clarity = orl_scatter_clarity(m, &s, clarity);
        direction = s.direction;
        const struct orl_vec3 origin = orl_hit_leave(world->geometry, &hit, direction);
        if (inwards && s.transmitted && ret_entry) {
            *ret_entry = (struct orl_entry){true, origin, direction, weight, clarity, chance};
            return sum;
        }
        met = orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit) ? &hit
                                                                                         : NULL;
    }
    health->paths_capped++;
    return sum;
}

struct orl_rgb orl_exterior_radiance_from(const struct orl_world *world, struct orl_vec3 direction,
                                          const struct orl_hit *first, struct orl_chance chance,
                                          struct orl_random *random, struct orl_health *health)
{
    struct outing outing = {.world = world, .random = random};
    return follow(&outing, direction, first, chance, health, NULL);
}

struct orl_rgb orl_exterior_radiance(const struct orl_world *world, struct orl_vec3 origin,
                                     struct orl_vec3 direction, struct orl_chance chance,
                                     struct orl_random *random, struct orl_health *health,
                                     struct orl_entry *ret_entry)
{
    struct outing outing = {.world = world, .enters = ret_entry != NULL, .random = random};
    struct orl_hit hit;
    if (ret_entry)
        ret_entry->entered = false;
    if (world->omit.exterior) {
        health->paths++;
        return unreflected_radiance(&outing, origin, direction, chance, health);
    }
    const bool met = orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit);
    return follow(&outing, direction, met ? &hit : NULL, chance, health, ret_entry);
}
