/*
 * Paths from eyes and sensors against the light: one loop for all who follow them, who say by a
 * sink what they add. What a path has seen is a sum of radiance, each part by the path's weight
 * where it was found:
 *   - the domes, where nothing is met any more; here
 *   - in mist, what suns and lamps send there; here
 *   - light outdoors, where a sealed building is left: the sink's `outdoors`
 *   - at each surface what it shines and reflects: the sink's `met`
 * Lamps are counted twice where shadow rays look for them too; chance (direct.h) says what is left.
 *
 * The loop is inlined with a sink that is constant where it is called, so that neither costs a
 * call.
 */
#ifndef ORL_LIGHT_EYE_PATH_H
#define ORL_LIGHT_EYE_PATH_H

#include <oriel/health.h>

#include "light/direct.h"
#include "light/mist.h"
#include "light/path.h"

enum { ORL_EYE_PATH_MOST = 64 }; /* surfaces; what goes on then is cut, and counted as capped */

struct orl_eye_path {
    const struct orl_world *world;
    struct orl_random *random;
    struct orl_path path;
    struct orl_rgb seen;
    struct orl_chance chance; /* of lamps met now, what is left to count */
    int bounce;
    bool outside;       /* of a sealed building, not looked at yet */
    bool clear;         /* nothing is in its way to the domes */
    bool looked, met;   /* what lies ahead is known; is there anything? */
    struct orl_hit hit; /* what was met, or lies ahead */
};

struct orl_eye_sink {
    /* Outdoors: true when the path has come in again. NULL: it never is. */
    bool (*outdoors)(struct orl_eye_path *p);
    /* Nothing is met: the domes have been seen. NULL: nothing to add. */
    void (*escaped)(struct orl_eye_path *p);
    /* A surface, at hit. Which of its lobes may send the path on; 0: it ends here. */
    enum orl_lobes (*met)(struct orl_eye_path *p, const struct orl_material *material);
    /* Draws a way on; NULL: by the path's own random numbers. */
    struct orl_scatter (*draw)(struct orl_eye_path *p, const struct orl_material *material,
                               enum orl_lobes lobes);
    /* Scattered by mist, and on its new way. False: it ends here. NULL: it goes on. */
    bool (*scattered)(struct orl_eye_path *p);
    /* Drawn, weighed, and not yet on its way. Sets what it may still count; false: it ends here. */
    bool (*sent_on)(struct orl_eye_path *p, const struct orl_scatter *scatter);
};

static inline void orl_eye_path_see(struct orl_eye_path *p, struct orl_rgb radiance)
{
    p->seen = orl_rgb_add(p->seen, orl_rgb_mul(p->path.weight, radiance));
}

/* A path that knows what lies ahead: nothing, when hit is NULL. */
static inline void orl_eye_path_foresee(struct orl_eye_path *p, const struct orl_hit *hit)
{
    p->looked = true;
    p->met = hit != NULL;
    if (hit)
        p->hit = *hit;
}

/* Sent on through a port, maybe. */
static inline void orl_eye_path_cross(struct orl_eye_path *p, const struct orl_scatter *scatter)
{
    p->outside = orl_world_outside_after(p->world, &p->hit, scatter->transmitted, p->outside);
    p->clear = scatter->transmitted && orl_world_leaves_clear(p->world, &p->hit);
}

/* What mist makes of its way ahead: true when it is scattered, and on another. */
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

/* Follows it to its end; paths that are cut are counted into health. */
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
