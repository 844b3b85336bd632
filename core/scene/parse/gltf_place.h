/* Where nodes of a glTF file place what they hold. */
#ifndef ORL_SCENE_PARSE_GLTF_PLACE_H
#define ORL_SCENE_PARSE_GLTF_PLACE_H

#include <oriel/vec.h>

#include "scene/parse/gltf_accessor.h"

/* Rows of a placement: x' = m[0] x + m[1] y + m[2] z + m[3]. */
struct orl_gltf_place {
    double row[3][4];
};

/* Radiance's z is up, glTF's y. */
extern const struct orl_gltf_place orl_gltf_upright;

struct orl_gltf_place orl_gltf_place_within(const struct orl_gltf_place *outer,
                                            const struct orl_gltf_place *inner);

/* A node's own: its matrix, or scale, rotation and translation; or none. */
int orl_gltf_place_read(const struct orl_gltf_item *node, struct orl_gltf_place *ret_place,
                        struct orl_error *err);

/* Of the copies that a node's EXT_mesh_gpu_instancing makes of its mesh. */
struct orl_gltf_copies {
    size_t count;
    bool given[3]; /* by these, in the order in which they are applied: */
    struct orl_gltf_accessor scale, rotation, translation;
};

/* count is 1 and none are given where it has none. */
int orl_gltf_copies_open(struct orl_gltf_file *file, const struct orl_gltf_item *node,
                         struct orl_gltf_copies *ret_copies, struct orl_error *err);
int orl_gltf_copies_place(const struct orl_gltf_copies *copies, size_t i,
                          struct orl_gltf_place *ret_place, struct orl_error *err);

struct orl_vec3 orl_gltf_place_point(const struct orl_gltf_place *place, struct orl_vec3 at);

/* A mirror turns the order of corners, and not the side that is the front. */
bool orl_gltf_place_mirrors(const struct orl_gltf_place *place);

/* By the cofactors, which keep it at right angles; of any length. */
struct orl_vec3 orl_gltf_place_normal(const struct orl_gltf_place *place, struct orl_vec3 n);

#endif
