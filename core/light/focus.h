/*
 * Surfaces outdoors that focus or spread the light of a sun: curved or textured mirrors, and bodies
 * that refract. Paths outdoors do not find suns by way of them (exterior.h), so that ports, whose
 * light comes of such paths, would send in none. Photons from the sun do.
 */
#ifndef ORL_LIGHT_FOCUS_H
#define ORL_LIGHT_FOCUS_H

#include "light/scene.h"

/* Returns true if a scene has any such surface. */
bool orl_focus_exists(const struct orl_scene *scene);

/* Rays from the outer side of a window or an opening, and what they have met that focuses. */
struct orl_focus {
    const struct orl_scene *scene;
    bool parallel_too; /* flat surfaces that refract count whichever way they face */
    size_t rays;
    double met; /* rays that have met something that focuses; those to convex mirrors count less */
    struct orl_vec3 flat[2]; /* normals of flat surfaces that refract, the first two; 0: none yet */
};

/* Follows a ray to what it meets first. Flat surfaces that refract count from the third way on
 * that they face: water, and panes in one or two facades, only move the light. */
void orl_focus_look(struct orl_focus *focus, struct orl_vec3 from, struct orl_vec3 direction);

/* Returns true if at least 1 ray in 500 has met such a surface, or 1 in 50 a convex mirror. */
bool orl_focus_matters(const struct orl_focus *focus);

#endif
