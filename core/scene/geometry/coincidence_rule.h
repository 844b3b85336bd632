/*
 * The rule for two surfaces in one place: which of them light meets (coincident.h has it in words).
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_RULE_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_RULE_H

#include <stdbool.h>

#include "scene/description.h"

/* 2 for materials that let no light through, 1 for the others. */
int orl_coincidence_class(const struct orl_material *m);

/*
 * Compares two polygons of one description: positive when a wins from both sides, negative when b
 * does, 0 when each is met from its front. Winning is transitive.
 */
int orl_coincidence_compare(const struct orl_description *d, const struct orl_surface *a,
                            const struct orl_surface *b);

/* Both sides of the material are the same to light. */
bool orl_material_is_two_sided(const struct orl_material *m);

/* The materials of both are the same to light. */
bool orl_surfaces_alike(const struct orl_description *d, const struct orl_surface *a,
                        const struct orl_surface *b);

/* A BSDF that stands for geometry. */
bool orl_surface_is_proxy(const struct orl_description *d, const struct orl_surface *s);

/* A border of antimatter, where no surface need be. */
bool orl_surface_is_hole(const struct orl_description *d, const struct orl_surface *s);

#endif
