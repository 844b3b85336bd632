#include "render/backward.h"

#include "scene/hemisphere.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 3, LAMPS_A_SAMPLE = 8 };

/* A path on its way, from the last place where light was asked for in all its parts. */
struct walk {
    const struct orl_backward *backward;
    struct orl_random *random;
    struct orl_health *health;
    uint32_t group;
    struct orl_vec3 origin, direction;
    struct orl_rgb weight, clarity;
    struct orl_rgb sum;
    double cos_start, travelled; /* since that place */
    bool straight;               /* nothing but panes since then */
    bool lamps_sampled;          /* lamps met now were already counted by shadow rays */
    bool from_eye;    /* nothing but mirrors, panes and lenses between here and the eye */
    uint32_t mirrors; /* since then */
    bool outside;
    bool met; /* a surface, at hit */
    struct orl_hit hit;
};

static void collect(struct walk *w, struct orl_rgb radiance)
{
    w->sum = orl_rgb_add(w->sum, orl_rgb_mul(w->weight, radiance));
}

/* Mean of a few lamps, neighbours in order of emission, which are far apart in space. */
static struct orl_rgb some_lamps(const struct orl_vpls *vpls, uint32_t group, size_t first,
                                 uint32_t lamps, struct orl_vec3 point, struct orl_vec3 normal)
{
    const size_t count = vpls->first[group + 1] - vpls->first[group];
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t k = 0; k < lamps && count > 0; k++)
        sum = orl_rgb_add(sum, orl_vpl_light(vpls, group, (first + k) % count, point, normal));
    return orl_rgb_scale(sum, 1.0 / lamps);
}

/* Light that a diffuse surface on the way reflects: its share of what virtual lamps leave. */
static double add_diffuse(struct walk *w, const struct orl_hit *hit, struct orl_rgb albedo)
{
    const struct orl_world *world = w->backward->world;
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    const double left = w->straight ? orl_vpl_left(&w->backward->vpls, w->cos_start,
                                                   orl_dot(w->direction, hit->normal), w->travelled)
                                    : 1;
    if (!(left > 0))
        return 0;
    const struct orl_direct_query query = {.point = orl_hit_leave(world->geometry, hit, lit),
                                           .normal = lit,
                                           .through_ports = true,
                                           .mirrored = true};
    const struct orl_rgb e = orl_rgb_add(
        orl_direct_light(world, &query, w->random),
        some_lamps(&w->backward->vpls, w->group, (size_t)orl_random_bits(w->random) >> 8,
                   w->from_eye ? LAMPS_A_SAMPLE : 1, query.point, lit));
    collect(w, orl_rgb_scale(orl_rgb_mul(albedo, e), left / ORL_PI));
    return left;
}

/* Suns and lamps in the lobes of a surface, seen from where the path comes from. */
static void add_lobes(struct walk *w, const struct orl_hit *hit, const struct orl_material *m)
{
    const struct orl_world *world = w->backward->world;
    const struct orl_vec3 seen = hit->front ? hit->normal : orl_neg(hit->normal);
    for (int side = 0; side < (orl_material_transmits_lobes(m) ? 2 : 1); side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_direct_query query = {.point = orl_hit_leave(world->geometry, hit, normal),
                                               .normal = normal,
                                               .through_ports = true,
                                               .lobes = m,
                                               .hit = hit,
                                               .eye = orl_neg(w->direction),
                                               .mirrored = true};
        collect(w, orl_direct_light(world, &query, w->random));
    }
}

/* Beyond all surfaces. A sun's disc counts only where no shadow ray could have looked for it. */
static void escape(struct walk *w)
{
    const struct orl_world *world = w->backward->world;
    w->weight = orl_rgb_mul(w->weight, orl_clarity_after(w->clarity, INFINITY));
    collect(w, orl_world_dome_radiance(world, w->direction));
    if (w->from_eye || (w->mirrors > 1 && !w->lamps_sampled))
        collect(w, orl_world_sun_radiance(world, w->direction));
}

static bool survives(struct walk *w, int bounce)
{
    const double chance = fmin(orl_rgb_max(w->weight), 1.0);
    if (bounce < SURE_BOUNCES && chance > 0.05)
        return true;
    if (orl_random_uniform(w->random) >= chance)
        return false;
    w->weight = orl_rgb_scale(w->weight, 1 / chance);
    return true;
}

/* A new place to ask for light at: the ray from there is aimed as the first one was. */
static bool go_on_diffusely(struct walk *w, double left)
{
    const struct orl_world *world = w->backward->world;
    const struct orl_vec3 lit = w->hit.front ? w->hit.normal : orl_neg(w->hit.normal);
    const double u0 = orl_random_uniform(w->random), u1 = orl_random_uniform(w->random);
    const double u[3] = {u0, u1, orl_random_uniform(w->random)};
    struct orl_aimed aimed;
    w->origin = orl_hit_leave(world->geometry, &w->hit, lit);
    if (!orl_aim_sample(&w->backward->aim, w->origin, lit, u, &aimed))
        return false;
    w->weight = orl_rgb_scale(w->weight, left * aimed.weight / ORL_PI);
    w->direction = aimed.direction;
    w->cos_start = orl_dot(aimed.direction, lit);
    w->met = aimed.met;
    w->hit = aimed.hit;
    w->travelled = 0;
    w->straight = w->lamps_sampled = true;
    w->from_eye = false;
    w->mirrors = 0;
    return true;
}

static void note_event(struct walk *w, enum orl_event event)
{
    if (event == ORL_EVENT_STRAIGHT)
        return;
    w->straight = false;
    /* Refracted suns have no images either. */
    w->mirrors += event == ORL_EVENT_MIRROR ? 1 : event == ORL_EVENT_REFRACTED ? 2 : 0;
    if (event == ORL_EVENT_GLOSSY)
        w->mirrors = 0;
    w->from_eye = w->from_eye && event != ORL_EVENT_GLOSSY;
    w->lamps_sampled = event == ORL_EVENT_GLOSSY;
}

/* The surface's own next direction, followed to the next hit; false when the path ends. */
static bool scatter(struct walk *w, const struct orl_material *m, double diffuse_left)
{
    const struct orl_world *world = w->backward->world;
    const enum orl_lobes lobes = diffuse_left > 0
                                     ? ORL_LOBE_ALL
                                     : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    const struct orl_scatter s =
        orl_scatter_sample(m, &w->hit, orl_neg(w->direction), ORL_TRANSPORT_EYE, lobes, w->random);
    if (s.event == ORL_EVENT_ABSORBED)
        return false;
    w->weight = orl_rgb_mul(w->weight, s.weight);
    w->clarity = orl_scatter_clarity(m, &s, w->clarity);
    if (s.event == ORL_EVENT_DIFFUSE)
        return go_on_diffusely(w, diffuse_left);
    note_event(w, s.event);
    if (s.transmitted && !world->open && orl_world_crossing(world, &w->hit) != ORL_CROSSING_NONE)
        w->outside = orl_world_crossing(world, &w->hit) == ORL_CROSSING_OUTWARDS;
    w->origin = orl_hit_leave(world->geometry, &w->hit, s.direction);
    w->direction = s.direction;
    if (!w->outside || w->from_eye)
        w->met =
            orl_geometry_intersect(world->geometry, w->origin, w->direction, INFINITY, &w->hit);
    return true;
}

/* Follows the path from its first hit to its end. */
static void follow(struct walk *w)
{
    const struct orl_world *world = w->backward->world;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        const bool enters =
            w->from_eye && w->met && orl_world_crossing(world, &w->hit) == ORL_CROSSING_INWARDS;
        if (w->outside && !enters && !(w->from_eye && !w->met)) {
            collect(w, orl_exterior_radiance(world, w->origin, w->direction, w->lamps_sampled,
                                             w->random, w->health));
            return;
        }
        if (!w->met) {
            escape(w);
            return;
        }
        const struct orl_material *m = orl_world_material(world, &w->hit);
        const struct orl_rgb albedo = orl_material_diffuse(m);
        double left = 0;
        w->weight = orl_rgb_mul(w->weight, orl_material_dimming(m, &w->hit, w->clarity));
        w->travelled += w->hit.distance;
        if (orl_material_glows(m) || (orl_material_is_lamp(m) && !w->lamps_sampled))
            collect(w, orl_material_emission(m, &w->hit, orl_neg(w->direction)));
        if (orl_rgb_max(albedo) > 0)
            left = add_diffuse(w, &w->hit, albedo);
        if (orl_material_has_lobes(m))
            add_lobes(w, &w->hit, m);
        if (!survives(w, bounce) || !scatter(w, m, left))
            return;
    }
}

/* ---- Rays from a place ----------------------------------------------------------------------- */

static struct orl_rgb look(struct walk *w, struct orl_vec3 point, struct orl_vec3 normal,
                           const double u[3])
{
    const struct orl_world *world = w->backward->world;
    struct orl_aimed aimed;
    if (w->outside)
        return orl_rgb_scale(orl_exterior_radiance(world, point,
                                                   orl_hemisphere_about(normal, u[0], u[1]), true,
                                                   w->random, w->health),
                             ORL_PI);
    if (!orl_aim_sample(&w->backward->aim, point, normal, u, &aimed))
        return orl_gray(0);
    w->origin = point;
    w->direction = aimed.direction;
    w->cos_start = orl_dot(aimed.direction, normal);
    w->weight = orl_gray(aimed.weight);
    w->clarity = orl_gray(1);
    w->straight = w->lamps_sampled = true;
    w->clarity = orl_gray(1);
    w->met = aimed.met;
    w->hit = aimed.hit;
    follow(w);
    return w->sum;
}

/* One sample of everything. */
static struct orl_rgb sample(const struct orl_backward *b, struct orl_vec3 point,
                             struct orl_vec3 normal, bool outside, uint32_t group, uint32_t i,
                             uint64_t index, struct orl_health *health)
{
    double u[5];
    struct orl_random random = orl_random_stream(b->seed, ORL_PURPOSE_SENSOR,
                                                 ((index * ORL_MAP_BATCHES + group) << 24) + i);
    const uint32_t sequence =
        (uint32_t)orl_mix64(b->seed ^ orl_mix64(index * ORL_MAP_BATCHES + group + 1));
    struct walk w = {
        .backward = b, .random = &random, .group = group, .outside = outside, .health = health};
    orl_sobol_point(&b->sobol, i, sequence, 5, u);
    const struct orl_direct_query direct = {
        .point = point, .normal = normal, .through_ports = true, .mirrored = true, .u = u + 3};
    struct orl_rgb sum = orl_direct_light(b->world, &direct, &random);
    sum = orl_rgb_add(sum, look(&w, point, normal, u));
    if (!outside)
        sum = orl_rgb_add(sum,
                          some_lamps(&b->vpls, group, (size_t)sequence + (size_t)i * LAMPS_A_SAMPLE,
                                     LAMPS_A_SAMPLE, point, normal));
    return sum;
}

int orl_backward_init(struct orl_backward *backward, const struct orl_world *world, uint64_t seed,
                      const struct orl_photon *photons, size_t count, uint64_t emitted)
{
    *backward = (struct orl_backward){.world = world, .seed = seed};
    orl_sobol_init(&backward->sobol);
    orl_aim_init(&backward->aim, world);
    return orl_vpls_init(&backward->vpls, world, photons, count, emitted);
}

void orl_backward_done(struct orl_backward *backward)
{
    orl_vpls_done(&backward->vpls);
}

struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            uint32_t samples, uint64_t index,
                                            struct orl_health *health)
{
    const struct orl_world *world = backward->world;
    /* A sensor written down as lying on a surface is to look away from it, not at it. */
    const struct orl_vec3 point = orl_madd(position, normal, world->geometry->radius * 0x1p-18);
    const bool outside = orl_world_is_outside(world, point);
    const uint32_t each = samples / ORL_MAP_BATCHES > 0 ? samples / ORL_MAP_BATCHES : 1;
    struct orl_rgb mean = orl_gray(0);
    double means[ORL_MAP_BATCHES], square = 0;
    for (uint32_t group = 0; group < ORL_MAP_BATCHES; group++) {
        struct orl_rgb sum = orl_gray(0);
        for (uint32_t i = 0; i < each; i++)
            sum = orl_rgb_add(sum, orl_health_keep(health, sample(backward, point, normal, outside,
                                                                  group, i, index, health)));
        sum = orl_rgb_scale(sum, 1.0 / each);
        means[group] = orl_luma(sum);
        mean = orl_rgb_add(mean, orl_rgb_scale(sum, 1.0 / ORL_MAP_BATCHES));
    }
    for (uint32_t group = 0; group < ORL_MAP_BATCHES; group++)
        square += (means[group] - orl_luma(mean)) * (means[group] - orl_luma(mean));
    const double degrees = (double)ORL_MAP_BATCHES * (ORL_MAP_BATCHES - 1);
    return (struct orl_estimate){mean, sqrt(square / degrees)};
}

struct orl_rgb orl_backward_radiance(const struct orl_backward *backward, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside, uint32_t group,
                                     struct orl_random *random, struct orl_health *health)
{
    struct walk w = {.backward = backward,
                     .random = random,
                     .group = group,
                     .origin = origin,
                     .direction = direction,
                     .weight = {1, 1, 1},
                     .clarity = {1, 1, 1},
                     .health = health,
                     .from_eye = true,
                     .outside = outside};
    w.met = orl_geometry_intersect(backward->world->geometry, origin, direction, INFINITY, &w.hit);
    follow(&w);
    return orl_health_keep(health, w.sum);
}
