/*
 * Paths from eyes and sensors against the light: one loop for all techniques, which define by a
 * sink (callbacks) what they add. The radiance that a path has seen is a sum; each part is weighted
 * by the path's throughput where it was found:
 * - the domes, where the ray meets no surface: added here
 * - light of suns and lamps that mist scatters: added here
 * - light outdoors, where the path leaves a sealed building: the sink's `outdoors`
 * - emission and reflection of each surface: the sink's `met`
 * Shadow rays find lamps, too; chance (direct.h) has the MIS weight of the path's own share.
 *
 * The loop is inlined with a sink that is constant at the call, so that neither costs a function
 * call.
 */
#ifndef ORL_LIGHT_EYE_PATH_H
#define ORL_LIGHT_EYE_PATH_H

#include <oriel/health.h>

#include "light/direct.h"
#include "light/mist.h"
#include "light/path.h"

enum { ORL_EYE_PATH_MOST = 64 }; /* surfaces; longer paths are cut and counted as paths_capped */

struct orl_eye_path {
    const struct orl_world *world;
    struct orl_random *random;
    struct orl_path path;
    struct orl_rgb seen;
    struct orl_chance chance; /* MIS state for lamps that the path hits next */
    int bounce;
    /* the path is outside a sealed building, and `outdoors` has not been called yet */
    bool outside;
    bool clear;         /* nothing lies between the path and the domes */
    bool looked, met;   /* looked: the next hit is known already; met: there is one */
    struct orl_hit hit; /* the current hit, or the next one if looked */
};

struct orl_eye_sink {
    /* Called outdoors. Returns true if the path has entered a building again. NULL: it never
     * does. */
    bool (*outdoors)(struct orl_eye_path *p);
    /* Called when the ray meets no surface, after the domes were added. NULL: nothing to add. */
    void (*escaped)(struct orl_eye_path *p);
    /* Called for a surface, at hit. Returns the lobes that may continue the path; 0 ends it. */
    enum orl_lobes (*met)(struct orl_eye_path *p, const struct orl_material *material);
    /* Samples the next direction. NULL: samples with the path's own random numbers. */
    struct orl_scatter (*draw)(struct orl_eye_path *p, const struct orl_material *material,
                               enum orl_lobes lobes);
    /* Called after mist has scattered the path and set its new direction. Returns false to end
     * the path. NULL: it continues. */
    bool (*scattered)(struct orl_eye_path *p);
    /* Called when a direction is sampled and the weight multiplied, before the path moves on.
     * Sets p->chance; returns false to end the path. */
    bool (*sent_on)(struct orl_eye_path *p, const struct orl_scatter *scatter);
};

static inline void orl_eye_path_see(struct orl_eye_path *p, struct orl_rgb radiance)
{
    p->seen = orl_rgb_add(p->seen, orl_rgb_mul(p->path.weight, radiance));
}

/* Sets the next hit of the path, if it is known already; NULL: the ray meets nothing. */
static inline void orl_eye_path_foresee(struct orl_eye_path *p, const struct orl_hit *hit)
{
    p->looked = true;
    p->met = hit != NULL;
    if (hit)
        p->hit = *hit;
}

/* Updates `outside` and `clear` if the scattering event crosses a port. */
static inline void orl_eye_path_cross(struct orl_eye_path *p, const struct orl_scatter *scatter)
{
    p->outside = orl_world_outside_after(p->world, &p->hit, scatter->transmitted, p->outside);
    p->clear = scatter->transmitted && orl_world_leaves_clear(p->world, &p->hit);
}

/* Samples scattering in mist on the way to the next hit. Returns true if the path is scattered,
 * with its new origin and direction set. */
static inline bool orl_eye_path_scatters(struct orl_eye_path *p)
{
    const struct orl_world *const world = p->world;
    const struct orl_mist_event event =
        orl_mist_meet(world->scene, p->path.origin, p->path.direction,
                      p->met ? p->hit.distance : INFINITY, p->random);
    p->path.weight = orl_rgb_mul(p->path.weight, event.weight);
    if (!event.scattered)
        return false;
    p->path.origin = orl_madd(p->path.origin, p->path.direction, event.distance);
    orl_eye_path_see(
        p, orl_direct_in_mist(world, p->path.origin, p->path.direction, event.forward, p->random));
    const double u0 = orl_random_uniform(p->random), u[2] = {u0, orl_random_uniform(p->random)};
    p->path.direction = orl_phase_sample(event.forward, p->path.direction, u);
    p->chance = orl_chance_found();
    return true;
}

/* Follows the path to its end. Counts paths that are cut in health->paths_capped. */
static inline __attribute__((always_inline)) void
orl_eye_path_follow(struct orl_eye_path *p, const struct orl_eye_sink *sink,
                    struct orl_health *health)
{
    const struct orl_world *world = p->world;
    for (; p->bounce < ORL_EYE_PATH_MOST; p->bounce++) {
        if (p->clear && !world->scene->mist) {
            orl_eye_path_see(p, orl_world_dome_radiance(world, p->path.direction));
            return;
        }
        if (p->outside && sink->outdoors && !sink->outdoors(p))
            return;
        if (!p->looked)
            p->met = orl_path_meet(world, &p->path, &p->hit);
        p->looked = false;
        if (world->scene->mist && orl_eye_path_scatters(p)) {
            if (!(orl_rgb_max(p->path.weight) > 0) || (sink->scattered && !sink->scattered(p)))
                return;
            continue;
        }
        if (!p->met) {
            orl_path_escape(&p->path);
            orl_eye_path_see(p, orl_world_dome_radiance(world, p->path.direction));
            if (sink->escaped)
                sink->escaped(p);
            return;
        }
        const struct orl_material *material = orl_world_material(world, &p->hit);
        orl_path_arrive(&p->path, material, &p->hit);
        const enum orl_lobes lobes = sink->met(p, material);
        if (!lobes)
            return;
        const struct orl_scatter scatter =
            sink->draw ? sink->draw(p, material, lobes)
                       : orl_scatter_sample(material, &p->hit, orl_path_back(&p->path),
                                            ORL_TRANSPORT_EYE, lobes, p->random);
        if (scatter.event == ORL_EVENT_ABSORBED)
            return;
        p->path.weight = orl_rgb_mul(p->path.weight, scatter.weight);
        if (!sink->sent_on(p, &scatter))
            return;
        orl_path_leave(&p->path, world, &p->hit, &scatter);
    }
    health->paths_capped++;
}

#endif
