#include "photon/trace.h"

#include <stdlib.h>

#include "photon/facing.h"

/* Leaves a photon; one that is no finite number, also as floats, is dropped and counted. */
static void deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                    uint8_t batch, enum orl_photon_class class)
{
    const struct orl_vec3 p = hit->point;
    const float sum = (float)flux.r + (float)flux.g + (float)flux.b + (float)(p.x + p.y + p.z);
    if (!isfinite(sum)) {
        deposits->health.non_finite++;
        return;
    }
    if (deposits->count == deposits->capacity) {
        const size_t capacity = deposits->capacity ? 2 * deposits->capacity : 4096;
        struct orl_photon *grown = realloc(deposits->photons, capacity * sizeof *deposits->photons);
        if (!grown) {
            deposits->out_of_memory = true;
            return;
        }
        deposits->photons = grown;
        deposits->capacity = capacity;
    }
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    deposits->photons[deposits->count++] =
        (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                            .flux = {(float)flux.r, (float)flux.g, (float)flux.b},
                            .normal = orl_normal_encode(lit),
                            .batch = batch,
                            .tag = (uint8_t) class,
                            .facet = hit->facet};
}

/* A photon under way. */
struct course {
    struct orl_vec3 origin, direction;
    struct orl_rgb flux;
    double fate, alive;
    struct orl_rgb clarity;      /* of what it flies through */
    double focus, flown, spread; /* off a spotlight: until it is scattered */
};

/*
 * Roulette: false when the chance of being alive has fallen to the photon's fate. spared: as much
 * flux as it is to lose besides (first.h); or 1.
 */
static bool survives(struct course *c, struct orl_rgb weight, double spared)
{
    const double chance = fmin(orl_luma(weight) / spared, 1);
    c->alive *= chance;
    if (!(c->alive > c->fate))
        return false;
    c->flux = orl_rgb_scale(orl_rgb_mul(c->flux, weight), 1 / chance);
    return true;
}

/*
 * What roulette says where only the albedo counts: it is known before a direction is drawn, and
 * most photons end there.
 */
static bool ends_here(const struct course *c, const struct orl_material *m, struct orl_rgb albedo,
                      double spared, bool caustic)
{
    return orl_material_is_matt(m) &&
           (caustic || !(c->alive * fmin(orl_luma(albedo) / spared, 1) > c->fate));
}

/* What the way to a hit does: a medium dims; a spotlight's beam is wider than its lamp (lamp.c). */
static bool arrives(struct course *c, const struct orl_material *m, const struct orl_hit *hit)
{
    if (c->focus > 0) {
        const double before = c->spread;
        c->flown += hit->distance;
        c->spread = fmax(orl_spot_spread(c->focus, c->flown), 1e-12);
        c->flux = orl_rgb_scale(c->flux, c->spread / before);
    }
    const struct orl_rgb left = orl_material_dimming(m, hit, c->clarity);
    return orl_is_clear(left) || survives(c, left, 1);
}

/* A ray that met nothing: from within a sealed building that is a leak. */
static void escape(const struct orl_world *world, struct orl_vec3 origin, struct orl_vec3 direction,
                   bool inside, struct orl_health *health)
{
    if (world->open || !inside)
        return;
    if (health->rays_leaked++ == 0) {
        health->leak_from = origin;
        health->leak_towards = direction;
    }
}

/* On to where the scatter sends it. */
static void depart(struct course *c, const struct orl_world *world, const struct orl_material *m,
                   const struct orl_hit *hit, const struct orl_scatter *s)
{
    if (s->event == ORL_EVENT_DIFFUSE || s->event == ORL_EVENT_GLOSSY)
        c->focus = 0;
    c->clarity = orl_scatter_clarity(m, s, c->clarity);
    c->origin = orl_hit_leave(world->geometry, hit, s->direction);
    c->direction = s->direction;
}

static enum orl_photon_class class_after(enum orl_photon_class class, enum orl_event event)
{
    if (event == ORL_EVENT_STRAIGHT || class == ORL_PHOTON_REST)
        return class;
    return event == ORL_EVENT_DIFFUSE ? ORL_PHOTON_REST : ORL_PHOTON_CAUSTIC;
}

static void give_up(struct orl_deposits *deposits, struct orl_rgb flux)
{
    deposits->health.photons_capped++;
    orl_sum_add(&deposits->flux_capped, orl_luma(flux));
}

/* Caustic photons by way of what the plan leaves out. */
static bool is_left_out(const struct orl_world *world, struct orl_deflection way)
{
    return (way.mirror && world->omit.mirror_caustics) || (way.lobe && world->omit.lobe_caustics);
}

void orl_trace_photon(const struct orl_world *world, const struct orl_flight *flight, bool caustic,
                      uint8_t batch, struct orl_random *random, struct orl_deposits *deposits)
{
    const enum orl_lobes lobes =
        caustic ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED) : ORL_LOBE_ALL;
    struct course c = {.origin = flight->origin,
                       .direction = flight->direction,
                       .flux = orl_health_keep(&deposits->health, flight->flux),
                       .fate = flight->fate,
                       .alive = 1,
                       .clarity = flight->from_port ? flight->clarity : orl_gray(1),
                       .focus = flight->focus,
                       .spread = 1};
    struct orl_deflection way = flight->way;
    bool crossed = flight->from_port, outside = false;
    enum orl_photon_class class = !flight->from_light        ? ORL_PHOTON_REST
                                  : (way.mirror || way.lobe) ? ORL_PHOTON_CAUSTIC
                                                             : ORL_PHOTON_LIGHT;
    const uint32_t most = world->omit.most_reflections < ORL_ALL_REFLECTIONS
                              ? world->omit.most_reflections
                              : UINT32_MAX;
    uint32_t reflections = 0;
    int unseen = 0;
    if (caustic && is_left_out(world, way))
        return;
    deposits->health.photons++;
    orl_sum_add(&deposits->flux, orl_luma(c.flux));
    for (int bounce = 0; bounce < ORL_TRACE_MOST_BOUNCES && unseen < ORL_TRACE_MOST_UNSEEN;
         bounce++) {
        struct orl_hit hit;
        deposits->health.rays++;
        if (!orl_geometry_intersect(world->geometry, c.origin, c.direction, INFINITY, &hit)) {
            escape(world, c.origin, c.direction, crossed && !outside, &deposits->health);
            return;
        }
        const struct orl_material *m = orl_world_material(world, &hit);
        const struct orl_rgb albedo = orl_material_diffuse(m);
        const bool diffuse = orl_rgb_max(albedo) > 0;
        if (!arrives(&c, m, &hit))
            return;
        unseen++;
        if (diffuse && !outside && (caustic ? way.mirror || way.lobe : reflections < most)) {
            if (caustic || !world->omit.counted_light || class == ORL_PHOTON_REST)
                deposit(deposits, &hit, c.flux, batch, class);
            unseen = 0;
        }
        const double spared = class == ORL_PHOTON_REST ? 1 : flight->reflected;
        if (ends_here(&c, m, albedo, spared, caustic))
            return;
        const struct orl_scatter s =
            orl_scatter_sample(m, &hit, orl_neg(c.direction), ORL_TRANSPORT_LIGHT, lobes, random);
        if (s.event == ORL_EVENT_ABSORBED ||
            !survives(&c, orl_health_keep(&deposits->health, s.weight),
                      s.event == ORL_EVENT_DIFFUSE ? spared : 1))
            return;
        if (s.transmitted) {
            const enum orl_crossing crossing = orl_world_crossing(world, &hit);
            /* What crosses a port inwards for the first time is the port's own to emit. */
            if (crossing == ORL_CROSSING_INWARDS && !crossed)
                return;
            if (crossing != ORL_CROSSING_NONE) {
                crossed = true;
                outside = !world->open && crossing == ORL_CROSSING_OUTWARDS;
            }
        }
        way = orl_deflected(way, s.event);
        reflections += s.event == ORL_EVENT_DIFFUSE;
        if (caustic ? is_left_out(world, way) : reflections >= most)
            return;
        class = class_after(class, s.event);
        depart(&c, world, m, &hit, &s);
    }
    give_up(deposits, c.flux);
}

struct orl_health orl_deposits_health(const struct orl_deposits *deposits)
{
    struct orl_health health = deposits->health;
    health.flux_w = orl_sum_value(&deposits->flux);
    health.flux_capped_w = orl_sum_value(&deposits->flux_capped);
    return health;
}
