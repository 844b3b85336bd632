/*
 * Surfaces that a description stores once and instances in several places (orl_prototype): their
 * count, and their expansion to one surface per place, as the files would have them.
 */
#ifndef ORL_SCENE_PLACEMENTS_H
#define ORL_SCENE_PLACEMENTS_H

#include <oriel/base/error.h>

#include "scene/parsed_scene.h"

/* Returns the number of surfaces with every instance counted. */
uint64_t orl_parsed_scene_count_surfaces(const struct orl_parsed_scene *parsed_scene);

/* Returns true if a prototype's surface, stored under the name `kept`, is called `name` in that
 * placement. */
bool orl_placement_has_name(const struct orl_parsed_scene *parsed_scene,
                            const struct orl_placement *placement, const char *kept,
                            const char *name);

/* Returns the inverse transform. orl_xform_direction by it keeps unit directions unit. */
struct orl_xform orl_xform_inverse(const struct orl_xform *xform);
/* Returns the transformed unit vector of a unit direction or normal. */
struct orl_vec3 orl_xform_direction(const struct orl_xform *xform, struct orl_vec3 direction);
/* Returns the transformed normal of a surface's front; an inverted surface has its front on the
 * other side. */
struct orl_vec3 orl_xform_normal(const struct orl_xform *xform, struct orl_vec3 normal);
struct orl_quadric orl_xform_quadric(const struct orl_xform *xform,
                                     const struct orl_quadric *quadric);
enum orl_surface_kind orl_xform_kind(const struct orl_xform *xform, enum orl_surface_kind kind);

/* Returns true if something in the scene depends on where surfaces lie: it cuts them, hides them,
 * or treats them separately. Then instances must be expanded. */
bool orl_parsed_scene_must_split(const struct orl_parsed_scene *parsed_scene);

/*
 * Expands the prototypes that have fewer placements than fewer_than and do not vary
 * (orl_prototype.varied): each place gets surfaces of its own, in the order of the files.
 * ORL_ALL_PLACEMENTS expands every prototype. Returns 0, ORL_ERR_LIMIT (more surfaces than are
 * allowed) or ORL_ERR_NOMEM.
 */
#define ORL_ALL_PLACEMENTS SIZE_MAX
int orl_placements_expand(struct orl_parsed_scene *parsed_scene, size_t fewer_than,
                          struct orl_error *err);

#endif
