/*
 * A path of light through the scene, with the light (photons) or against it (from eyes and
 * sensors), and the steps that all paths have:
 *   intersect    find the next hit                                  orl_path_intersect
 *   attenuate    absorption of the medium on the way to it          orl_path_attenuate, _escape
 *   shade        add light, or store a photon: each technique's own
 *   scatter      sample one direction from the material             orl_material_sample
 *   weigh        multiply by the sample's weight, Russian roulette  orl_path_roulette
 *   move on      start the next ray beyond the surface              orl_path_spawn_ray,
 *                                                                   orl_path_skip_surface
 *
 * Callers that split rays (views, suns' images) have one orl_path for each branch.
 *
 * Directions are unit vectors, points are in moved coordinates (scene/geometry/geometry.h). Steps
 * allocate nothing and have no state. Eye paths have their own loop, eye_path.h.
 */
#ifndef ORL_LIGHT_PATH_H
#define ORL_LIGHT_PATH_H

#include "light/lit_scene.h"

/* Panes that a straight ray passes at most; more count as opaque. */
enum { ORL_MOST_PANES = 64 };

struct orl_path {
    struct orl_vec3 origin, direction;
    struct orl_rgb weight; /* photons: flux, W; eye paths: throughput */
    struct orl_rgb
        medium_transmissivity; /* transmissivity of the current medium for a unit of length */
};

static inline struct orl_path orl_path_from(struct orl_vec3 origin, struct orl_vec3 direction)
{
    return (struct orl_path){origin, direction, .weight = {1, 1, 1},
                             .medium_transmissivity = {1, 1, 1}};
}

/* Finds the next hit; returns false if there is none. */
static inline bool orl_path_intersect(const struct orl_lit_scene *lit_scene,
                                      const struct orl_path *path, struct orl_hit *ret_hit)
{
    return orl_geometry_intersect(lit_scene->geometry, path->origin, path->direction, INFINITY,
                                  ret_hit);
}

/* Returns the unit direction from the next hit back to the path's origin. */
static inline struct orl_vec3 orl_path_back(const struct orl_path *path)
{
    return orl_neg(path->direction);
}

/* Multiply the weight by the transmittance to a hit, or to infinity if the ray meets no surface. */
static inline void orl_path_attenuate(struct orl_path *path, const struct orl_material *material,
                                      const struct orl_hit *hit)
{
    path->weight = orl_rgb_mul(path->weight,
                               orl_hit_transmittance(material, hit, path->medium_transmissivity));
}
static inline void orl_path_escape(struct orl_path *path)
{
    path->weight =
        orl_rgb_mul(path->weight, orl_medium_transmittance(path->medium_transmissivity, INFINITY));
}

/* Russian roulette with survival probability `survival`. Returns false if the path ends; otherwise
 * divides its weight by `survival`. */
static inline bool orl_path_roulette(struct orl_path *path, double survival,
                                     struct orl_random *random)
{
    if (!(orl_random_uniform(random) < survival))
        return false;
    path->weight = orl_rgb_scale(path->weight, 1 / survival);
    return true;
}

/* Moves the path to the start of the ray after a scattering event. The weight is the caller's. */
static inline void orl_path_spawn_ray(struct orl_path *path, const struct orl_lit_scene *lit_scene,
                                      const struct orl_hit *hit,
                                      const struct orl_surface_sample *sample)
{
    path->medium_transmissivity = orl_medium_after_sample(orl_lit_scene_material(lit_scene, hit),
                                                          sample, path->medium_transmissivity);
    path->origin = orl_hit_ray_origin(lit_scene->geometry, hit, sample->direction);
    path->direction = sample->direction;
}

/* Moves the path straight through a hit, as if there were no surface. */
static inline void orl_path_skip_surface(struct orl_path *path,
                                         const struct orl_lit_scene *lit_scene,
                                         const struct orl_hit *hit)
{
    path->origin = orl_hit_ray_origin(lit_scene->geometry, hit, path->direction);
}

/* Multiplies the weight by the straight transmittance of a thin pane; returns false if that is
 * zero. */
static inline bool orl_path_transmit_straight(struct orl_path *path,
                                              const struct orl_material *material,
                                              const struct orl_hit *hit)
{
    path->weight =
        orl_rgb_mul(path->weight, orl_material_straight(material, hit, orl_path_back(path)));
    return orl_rgb_max(path->weight) > 0;
}

/*
 * Returns true if the path is outside a sealed scene after a scattering event, given where it was
 * before. Only ports change this. In open scenes nothing is outside.
 */
static inline bool orl_lit_scene_outside_after(const struct orl_lit_scene *lit_scene,
                                               const struct orl_hit *hit, bool transmitted,
                                               bool outside)
{
    const enum orl_port_crossing crossing =
        transmitted ? orl_lit_scene_crossing(lit_scene, hit) : ORL_CROSSING_NONE;
    if (crossing == ORL_CROSSING_NONE)
        return outside;
    return !lit_scene->open && crossing == ORL_CROSSING_OUTWARDS;
}

#endif
