/*
 * Surfaces that a description keeps once and has in several places (orl_prototype): how many they
 * are together, and how each place has its own again, as the files would have said them.
 */
#ifndef ORL_SCENE_PLACEMENTS_H
#define ORL_SCENE_PLACEMENTS_H

#include <oriel/error.h>

#include "scene/description.h"

/* Surfaces of all places, those included that stand in one. */
uint64_t orl_description_count_surfaces(const struct orl_description *description);

/* Whether a prototype's surface, of which it keeps the one name, has the other where it is placed.
 */
bool orl_placement_has_name(const struct orl_description *description,
                            const struct orl_placement *placement, const char *kept,
                            const char *name);

/* A point's or a vector's way back, of a vector's the direction alone: unit stays unit. */
struct orl_xform orl_xform_inverse(const struct orl_xform *xform);
/* A direction or a normal, unit: where it points once placed. */
struct orl_vec3 orl_xform_direction(const struct orl_xform *xform, struct orl_vec3 direction);
/* The normal of a front, which an inverted surface has on its other side. */
struct orl_vec3 orl_xform_normal(const struct orl_xform *xform, struct orl_vec3 normal);
struct orl_curved orl_xform_curved(const struct orl_xform *xform, const struct orl_curved *round);
enum orl_surface_kind orl_xform_kind(const struct orl_xform *xform, enum orl_surface_kind kind);

/* Whether something in the scene has to do with what surfaces lie where: what cuts them, hides
 * them, or is apart from them. Then each place has surfaces of its own. */
bool orl_description_must_part(const struct orl_description *description);

/*
 * Prototypes in fewer places than that, but those that vary, have their surfaces in each of them,
 * among the others in the order of the files; of all of them by ORL_ALL_PLACES. Returns 0,
 * ORL_ERR_LIMIT (more surfaces than are allowed) or ORL_ERR_NOMEM.
 */
#define ORL_ALL_PLACES SIZE_MAX
int orl_placements_expand(struct orl_description *description, size_t fewer_than,
                          struct orl_error *err);

#endif
