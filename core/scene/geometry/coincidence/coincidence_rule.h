/*
 * The rule for two coincident surfaces: which of them rays hit (described in coincident.h).
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENCE_RULE_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COINCIDENCE_RULE_H

#include <stdbool.h>

#include "scene/parsed_scene.h"

/* Returns 1 for materials that transmit light, else 2. A BSDF counts as 2 unless it is an aBSDF. */
int orl_coincidence_class(const struct orl_material *m);

/*
 * Compares two coincident polygons of one description. Positive: rays hit a from both sides;
 * negative: b; 0: each is hit from its front. The order is transitive.
 */
int orl_coincidence_compare(const struct orl_parsed_scene *d, const struct orl_surface *a,
                            const struct orl_surface *b);

/* Returns true if light scatters alike from both sides of the material. */
bool orl_material_is_two_sided(const struct orl_material *m);

/* Returns true if light scatters alike from both surfaces' materials. */
bool orl_surfaces_alike(const struct orl_parsed_scene *d, const struct orl_surface *a,
                        const struct orl_surface *b);

/* Returns true if the surface is a BSDF that stands for geometry (with a thickness). */
bool orl_surface_is_proxy(const struct orl_parsed_scene *d, const struct orl_surface *s);

/* Returns true if the surface bounds antimatter, where it need not be present. */
bool orl_surface_is_hole(const struct orl_parsed_scene *d, const struct orl_surface *s);

#endif
