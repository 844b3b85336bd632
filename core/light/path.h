/*
 * A path of light through the scene, with it (photons) or against it (from eyes and sensors), and
 * the step that all of them take:
 *   meet      what the ray comes to first                              orl_path_meet
 *   dim       by what the medium on the way to it absorbs              orl_path_arrive, _escape
 *   shade     what is met adds light, or takes a photon: each technique's own
 *   choose    one way on, of the material's                            orl_scatter_sample
 *   weigh     by what was chosen; dim paths end by lot                 orl_path_survives
 *   go on     from beyond the surface                                  orl_path_leave,
 * _look_through Who follows rays both ways where they split (views, suns' images) does so by
 * several paths.
 *
 * Directions are unit, places in moved coordinates (scene/geometry/geometry.h). Steps allocate
 * nothing and keep nothing. Eyes' paths have a loop of their own, eye_path.h.
 */
#ifndef ORL_LIGHT_PATH_H
#define ORL_LIGHT_PATH_H

#include "light/world.h"

struct orl_path {
    struct orl_vec3 origin, direction;
    struct orl_rgb weight;  /* a photon's flux, W; of an eye's path, its share in what it is for */
    struct orl_rgb clarity; /* transmissivity of a unit of length of what it goes through */
};

static inline struct orl_path orl_path_from(struct orl_vec3 origin, struct orl_vec3 direction)
{
    return (struct orl_path){origin, direction, .weight = {1, 1, 1}, .clarity = {1, 1, 1}};
}

/* What it comes to first; false: nothing. */
static inline bool orl_path_meet(const struct orl_world *world, const struct orl_path *path,
                                 struct orl_hit *ret_hit)
{
    return orl_geometry_intersect(world->geometry, path->origin, path->direction, INFINITY,
                                  ret_hit);
}

/* Where it came from, as seen from what it meets. */
static inline struct orl_vec3 orl_path_back(const struct orl_path *path)
{
    return orl_neg(path->direction);
}

/* The way to a hit, or beyond all surfaces, takes its share. */
static inline void orl_path_arrive(struct orl_path *path, const struct orl_material *material,
                                   const struct orl_hit *hit)
{
    path->weight = orl_rgb_mul(path->weight, orl_material_dimming(material, hit, path->clarity));
}
static inline void orl_path_escape(struct orl_path *path)
{
    path->weight = orl_rgb_mul(path->weight, orl_clarity_after(path->clarity, INFINITY));
}

/* Russian roulette by one random number: it ends (false), or its weight stands for those that do.
 */
static inline bool orl_path_survives(struct orl_path *path, double chance,
                                     struct orl_random *random)
{
    if (!(orl_random_uniform(random) < chance))
        return false;
    path->weight = orl_rgb_scale(path->weight, 1 / chance);
    return true;
}

/* Sent on by what it has met; its weight has been seen to. */
static inline void orl_path_leave(struct orl_path *path, const struct orl_world *world,
                                  const struct orl_hit *hit, const struct orl_scatter *scatter)
{
    path->clarity = orl_scatter_clarity(orl_world_material(world, hit), scatter, path->clarity);
    path->origin = orl_hit_leave(world->geometry, hit, scatter->direction);
    path->direction = scatter->direction;
}

/* Straight on from a hit, as if nothing were there. */
static inline void orl_path_pass(struct orl_path *path, const struct orl_world *world,
                                 const struct orl_hit *hit)
{
    path->origin = orl_hit_leave(world->geometry, hit, path->direction);
}

/* Weighed by what a thin pane lets straight through; false: nothing. */
static inline bool orl_path_look_through(struct orl_path *path, const struct orl_material *material,
                                         const struct orl_hit *hit)
{
    path->weight =
        orl_rgb_mul(path->weight, orl_material_straight(material, hit, orl_path_back(path)));
    return orl_rgb_max(path->weight) > 0;
}

/*
 * Whether what a surface sends on is outside then, if what came to it was or was not: ports tell,
 * in sealed scenes. In others nothing is outside.
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
