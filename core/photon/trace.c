#include "photon/trace.h"

#include <stdlib.h>

#include "photon/facing.h"

static void deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                    uint8_t batch)
{
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
    deposits->photons[deposits->count++] = (struct orl_photon){
        .position = {(float)hit->point.x, (float)hit->point.y, (float)hit->point.z},
        .flux = {(float)flux.r, (float)flux.g, (float)flux.b},
        .normal = orl_normal_encode(lit),
        .batch = batch};
}

/* Russian roulette by the luma of what is left; false: dead. */
static bool survives(struct orl_rgb weight, struct orl_rgb *flux, struct orl_random *random)
{
    const double chance = orl_luma(weight);
    if (chance < 1 && orl_random_uniform(random) >= chance)
        return false;
    *flux = orl_rgb_scale(orl_rgb_mul(*flux, weight), chance < 1 ? 1 / chance : 1);
    return true;
}

void orl_trace_photon(const struct orl_world *world, const struct orl_flight *flight, bool caustic,
                      uint8_t batch, struct orl_random *random, struct orl_deposits *deposits)
{
    struct orl_vec3 origin = flight->origin, direction = flight->direction;
    struct orl_rgb flux = flight->flux;
    bool scattered = flight->scattered, crossed = flight->from_port, outside = false;
    for (int bounce = 0; bounce < ORL_TRACE_MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        deposits->rays++;
        if (!orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit)) {
            deposits->escaped++;
            return;
        }
        const struct orl_material *m = orl_world_material(world, &hit);
        const bool diffuse = orl_rgb_max(orl_material_diffuse(m)) > 0;
        if (diffuse && !outside && (!caustic || scattered))
            deposit(deposits, &hit, flux, batch);
        const enum orl_lobes lobes =
            caustic ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED) : ORL_LOBE_ALL;
        const struct orl_scatter s =
            orl_scatter_sample(m, &hit, orl_neg(direction), ORL_TRANSPORT_LIGHT, lobes, random);
        if (s.event == ORL_EVENT_ABSORBED || !survives(s.weight, &flux, random))
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
        if (s.event != ORL_EVENT_STRAIGHT)
            scattered = true;
        origin = orl_hit_leave(world->geometry, &hit, s.direction);
        direction = s.direction;
    }
    deposits->capped++;
}
