/*
 * Surfaces outdoors that focus or spread the light of a sun: curved or textured mirrors, and bodies
 * that refract. Paths outdoors do not find suns by way of them (exterior.h), so ports, which emit
 * the light of such paths, would omit it. Photons from the sun find it.
 */
#ifndef ORL_SCENE_BUILT_FOCUSING_H
#define ORL_SCENE_BUILT_FOCUSING_H

#include "scene/built/scene.h"

/* Returns true if a scene has any such surface. */
bool orl_focusing_exists(const struct orl_scene *scene);

/* Rays traced from the outer side of a window or an opening, and how many of them met a focusing
 * surface. */
struct orl_focusing_probe {
    const struct orl_scene *scene;
    bool any_orientation; /* flat refracting surfaces count whatever their orientation */
    size_t rays;
    /* rays that met a focusing surface; those to convex mirrors have a smaller weight */
    double focusing_rays;
    /* the first two orientations (normals) of flat refracting surfaces; 0: none yet */
    struct orl_vec3 flat_normals[2];
};

/* Traces a ray to its first hit. Flat refracting surfaces count from the third orientation on:
 * water, and panes in one or two facades, only move the light. */
void orl_focusing_trace(struct orl_focusing_probe *probe, struct orl_vec3 from,
                        struct orl_vec3 direction);

/* Returns true if at least 1 ray in 500 has met such a surface, or 1 in 50 a convex mirror. */
bool orl_focusing_is_significant(const struct orl_focusing_probe *probe);

#endif
