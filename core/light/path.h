/*
 * A path of light through the scene, with the light (photons) or against it (from eyes and
 * sensors), and the steps that all paths have:
 *   intersect    find the next hit                                  orl_path_meet
 *   attenuate    absorption of the medium on the way to it          orl_path_arrive, _escape
 *   shade        add light, or store a photon: each technique's own
 *   scatter      sample one direction from the material             orl_scatter_sample
 *   weigh        multiply by the sample's weight, Russian roulette  orl_path_survives
 *   move on      start the next ray beyond the surface              orl_path_leave, _look_through
 *
 * Callers that split rays (views, suns' images) keep one orl_path for each branch.
 *
 * Directions are unit vectors, points are in moved coordinates (scene/geometry/geometry.h). Steps
 * allocate nothing and keep no state. Eye paths have their own loop, eye_path.h.
 */
#ifndef ORL_LIGHT_PATH_H
#define ORL_LIGHT_PATH_H

#include "light/world.h"

struct orl_path {
    struct orl_vec3 origin, direction;
    struct orl_rgb weight;  /* photons: flux, W; eye paths: throughput */
    struct orl_rgb clarity; /* transmissivity of the current medium for a unit of length */
};

static inline struct orl_path orl_path_from(struct orl_vec3 origin, struct orl_vec3 direction)
{
    return (struct orl_path){origin, direction, .weight = {1, 1, 1}, .clarity = {1, 1, 1}};
}

/* Finds the next hit; returns false if there is none. */
static inline bool orl_path_meet(const struct orl_world *world, const struct orl_path *path,
                                 struct orl_hit *ret_hit)
{
    return orl_geometry_intersect(world->geometry, path->origin, path->direction, INFINITY,
                                  ret_hit);
}

/* Returns the unit direction from the next hit back to the path's origin. */
static inline struct orl_vec3 orl_path_back(const struct orl_path *path)
{
    return orl_neg(path->direction);
}

/* Multiply the weight by the transmittance to a hit, or to infinity if the ray meets no surface. */
static inline void orl_path_arrive(struct orl_path *path, const struct orl_material *material,
                                   const struct orl_hit *hit)
{
    path->weight = orl_rgb_mul(path->weight, orl_material_dimming(material, hit, path->clarity));
}
static inline void orl_path_escape(struct orl_path *path)
{
    path->weight = orl_rgb_mul(path->weight, orl_clarity_after(path->clarity, INFINITY));
}

/* Russian roulette with survival probability `chance`. Returns false if the path ends; otherwise
 * divides its weight by `chance`. */
static inline bool orl_path_survives(struct orl_path *path, double chance,
                                     struct orl_random *random)
{
    if (!(orl_random_uniform(random) < chance))
        return false;
    path->weight = orl_rgb_scale(path->weight, 1 / chance);
    return true;
}

/* Moves the path to the start of the ray after a scattering event. The weight is the caller's. */
static inline void orl_path_leave(struct orl_path *path, const struct orl_world *world,
                                  const struct orl_hit *hit, const struct orl_scatter *scatter)
{
    path->clarity = orl_scatter_clarity(orl_world_material(world, hit), scatter, path->clarity);
    path->origin = orl_hit_leave(world->geometry, hit, scatter->direction);
    path->direction = scatter->direction;
}

/* Moves the path straight through a hit, as if there were no surface. */
static inline void orl_path_pass(struct orl_path *path, const struct orl_world *world,
                                 const struct orl_hit *hit)
{
    path->origin = orl_hit_leave(world->geometry, hit, path->direction);
}

/* Multiplies the weight by the straight transmittance of a thin pane; returns false if that is
 * zero. */
static inline bool orl_path_look_through(struct orl_path *path, const struct orl_material *material,
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
static inline bool orl_world_outside_after(const struct orl_world *world, const struct orl_hit *hit,
                                           bool transmitted, bool outside)
{
    const enum orl_crossing crossing =
        transmitted ? orl_world_crossing(world, hit) : ORL_CROSSING_NONE;
    if (crossing == ORL_CROSSING_NONE)
        return outside;
    return !world->open && crossing == ORL_CROSSING_OUTWARDS;
}

#endif
