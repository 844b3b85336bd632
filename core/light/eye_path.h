/*
 * Paths from eyes and sensors against the light: one loop for all techniques, which define by a
 * visitor (callbacks) what they add. The radiance that a path has seen is a sum; each part is
 * weighted by the path's throughput where it was found:
 * - the domes, where the ray meets no surface: added here
 * - light of suns and lamps that volumes scatter: added here
 * - light outdoors, where the path leaves a sealed building: the visitor's on_outdoors
 * - emission and reflection of each surface: the visitor's met
 * Shadow rays find lamps, too; chance (direct.h) has the MIS weight of the path's own share.
 *
 * The loop is inlined with a visitor that is constant at the call, so that neither costs a function
 * call.
 */
#ifndef ORL_LIGHT_EYE_PATH_H
#define ORL_LIGHT_EYE_PATH_H

#include <oriel/base/input_checks.h>

#include "light/direct.h"
#include "light/path.h"
#include "scene/built/scene.h"

enum {
    ORL_EYE_PATH_MOST_HITS = 64
}; /* surfaces; longer paths are cut and counted as paths_capped */

struct orl_eye_path {
    const struct orl_lit_scene *lit_scene;
    struct orl_random *random;
    struct orl_path path;
    struct orl_rgb seen;
    struct orl_mis_pdf chance; /* MIS state for lamps that the path hits next */
    int bounce;
    /* the path is outside a sealed building, and on_outdoors has not been called yet */
    bool outside;
    bool clear;               /* nothing lies between the path and the domes */
    bool next_hit_known, met; /* the next hit is known already; met: there is one */
    struct orl_hit hit;       /* the current hit, or the next one if next_hit_known */
};

struct orl_path_visitor {
    /* Called outdoors. Returns true if the path has entered a building again. NULL: it never
     * does. */
    bool (*on_outdoors)(struct orl_eye_path *p);
    /* Called when the ray meets no surface, after the domes were added. NULL: nothing to add. */
    void (*escaped)(struct orl_eye_path *p);
    /* Called for a surface, at hit. Returns the lobes that may continue the path; 0 ends it. */
    enum orl_lobes (*met)(struct orl_eye_path *p, const struct orl_material *material);
    /* Samples the next direction. NULL: samples with the path's own random numbers. */
    struct orl_surface_sample (*draw)(struct orl_eye_path *p, const struct orl_material *material,
                                      enum orl_lobes lobes);
    /* Called after a volume has scattered the path and set its new direction. Returns false to end
     * the path. NULL: it continues. */
    bool (*scattered)(struct orl_eye_path *p);
    /* Called when a direction is sampled and the weight multiplied, before the path moves on.
     * Sets p->chance; returns false to end the path. */
    bool (*on_sampled)(struct orl_eye_path *p, const struct orl_surface_sample *sample);
};

static inline void orl_eye_path_add_radiance(struct orl_eye_path *p, struct orl_rgb radiance)
{
    p->seen = orl_rgb_add(p->seen, orl_rgb_mul(p->path.weight, radiance));
}

/* Sets the next hit of the path, if it is known already; NULL: the ray meets nothing. */
static inline void orl_eye_path_set_next_hit(struct orl_eye_path *p, const struct orl_hit *hit)
{
    p->next_hit_known = true;
    p->met = hit != NULL;
    if (hit)
        p->hit = *hit;
}

/* Updates `outside` and `clear` if the scattering event crosses a port. */
static inline void orl_eye_path_cross_port(struct orl_eye_path *p,
                                           const struct orl_surface_sample *sample)
{
    p->outside =
        orl_lit_scene_outside_after(p->lit_scene, &p->hit, sample->transmitted, p->outside);
    p->clear = sample->transmitted && orl_lit_scene_leaves_clear(p->lit_scene, &p->hit);
}

/* Samples scattering in a volume on the way to the next hit. Returns true if the path is scattered,
 * with its new origin and direction set. */
static inline bool orl_eye_path_scatter_volume(struct orl_eye_path *p)
{
    const struct orl_lit_scene *const lit_scene = p->lit_scene;
    const struct orl_volume_event event =
        orl_volume_sample_event(lit_scene->scene, p->path.origin, p->path.direction,
                                p->met ? p->hit.distance : INFINITY, p->random);
    p->path.weight = orl_rgb_mul(p->path.weight, event.weight);
    if (!event.scattered)
        return false;
    p->path.origin = orl_madd(p->path.origin, p->path.direction, event.distance);
    orl_eye_path_add_radiance(p, orl_direct_in_volume(lit_scene, p->path.origin, p->path.direction,
                                                      event.asymmetry, p->random));
    const double u0 = orl_random_uniform(p->random), u[2] = {u0, orl_random_uniform(p->random)};
    p->path.direction = orl_phase_function_sample(event.asymmetry, p->path.direction, u);
    p->chance = orl_mis_pdf_zero();
    return true;
}

/* Follows the path to its end. Counts paths that are cut in health->paths_capped. */
static inline __attribute__((always_inline)) void
orl_eye_path_trace(struct orl_eye_path *p, const struct orl_path_visitor *visitor,
                   struct orl_health *health)
{
    const struct orl_lit_scene *lit_scene = p->lit_scene;
    for (; p->bounce < ORL_EYE_PATH_MOST_HITS; p->bounce++) {
        if (p->clear && !lit_scene->scene->mist) {
            orl_eye_path_add_radiance(p, orl_lit_scene_dome_radiance(lit_scene, p->path.direction));
            return;
        }
        if (p->outside && visitor->on_outdoors && !visitor->on_outdoors(p))
            return;
        if (!p->next_hit_known)
            p->met = orl_path_intersect(lit_scene, &p->path, &p->hit);
        p->next_hit_known = false;
        if (lit_scene->scene->mist && orl_eye_path_scatter_volume(p)) {
            if (!(orl_rgb_max(p->path.weight) > 0) ||
                (visitor->scattered && !visitor->scattered(p)))
                return;
            continue;
        }
        if (!p->met) {
            orl_path_escape(&p->path);
            orl_eye_path_add_radiance(p, orl_lit_scene_dome_radiance(lit_scene, p->path.direction));
            if (visitor->escaped)
                visitor->escaped(p);
            return;
        }
        const struct orl_material *material = orl_lit_scene_material(lit_scene, &p->hit);
        orl_path_attenuate(&p->path, material, &p->hit);
        const enum orl_lobes lobes = visitor->met(p, material);
        if (!lobes)
            return;
        const struct orl_surface_sample sample =
            visitor->draw ? visitor->draw(p, material, lobes)
                          : orl_material_sample(material, &p->hit, orl_path_back(&p->path),
                                                ORL_TRANSPORT_EYE, lobes, p->random);
        if (sample.event == ORL_EVENT_ABSORBED)
            return;
        p->path.weight = orl_rgb_mul(p->path.weight, sample.weight);
        if (!visitor->on_sampled(p, &sample))
            return;
        orl_path_spawn_ray(&p->path, lit_scene, &p->hit, &sample);
    }
    health->paths_capped++;
}

#endif
