/*
 * Surfaces outdoors that focus or spread the light of a sun: curved or textured mirrors, and bodies
 * that refract. Paths outdoors do not find suns by way of them (exterior.h), so ports, which emit
 * the light of such paths, would omit it. Photons from the sun find it.
 */
#ifndef ORL_LIGHT_FOCUS_H
#define ORL_LIGHT_FOCUS_H

#include "light/scene.h"

/* Returns true if a scene has any such surface. */
bool orl_focus_exists(const struct orl_scene *scene);

/* Rays traced from the outer side of a window or an opening, and how many of them met a focusing
 * surface. */
struct orl_focus {
    const struct orl_scene *scene;
    bool parallel_too; /* flat refracting surfaces count whatever their orientation */
    size_t rays;
    /* rays that met a focusing surface; those to convex mirrors have a smaller weight */
    double met;
    /* the first two orientations (normals) of flat refracting surfaces; 0: none yet */
    struct orl_vec3 flat[2];
};

/* Traces a ray to its first hit. Flat refracting surfaces count from the third orientation on:
 * water, and panes in one or two facades, only move the light. */
void orl_focus_look(struct orl_focus *focus, struct orl_vec3 from, struct orl_vec3 direction);

/* Returns true if at least 1 ray in 500 has met such a surface, or 1 in 50 a convex mirror. */
bool orl_focus_matters(const struct orl_focus *focus);

#endif
