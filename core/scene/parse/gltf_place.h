/* Transforms of glTF nodes. */
#ifndef ORL_SCENE_PARSE_GLTF_PLACE_H
#define ORL_SCENE_PARSE_GLTF_PLACE_H

#include <oriel/vec.h>

#include "scene/parse/gltf_accessor.h"

/* An affine transform: coordinate i becomes row[i][0] x + row[i][1] y + row[i][2] z + row[i][3]. */
struct orl_gltf_place {
    double row[3][4];
};

/* Converts glTF's y up to Radiance's z up. */
extern const struct orl_gltf_place orl_gltf_upright;

struct orl_gltf_place orl_gltf_place_within(const struct orl_gltf_place *outer,
                                            const struct orl_gltf_place *inner);

/* Reads a node's own transform: its matrix; or scale, rotation and translation; or the identity. */
int orl_gltf_place_read(const struct orl_gltf_item *node, struct orl_gltf_place *ret_place,
                        struct orl_error *err);

/* Instances that a node's EXT_mesh_gpu_instancing makes of its mesh. */
struct orl_gltf_copies {
    size_t count;
    bool given[3]; /* which of these are given; they are applied in this order */
    struct orl_gltf_accessor scale, rotation, translation;
};

/* Sets count to 1, with nothing given, if the node has no such extension. */
int orl_gltf_copies_open(struct orl_gltf_file *file, const struct orl_gltf_item *node,
                         struct orl_gltf_copies *ret_copies, struct orl_error *err);
int orl_gltf_copies_place(const struct orl_gltf_copies *copies, size_t i,
                          struct orl_gltf_place *ret_place, struct orl_error *err);

struct orl_vec3 orl_gltf_place_point(const struct orl_gltf_place *place, struct orl_vec3 at);

/* Returns true if the transform mirrors: the order of corners must be reversed to keep the
 * front. */
bool orl_gltf_place_mirrors(const struct orl_gltf_place *place);

/* Transforms a normal by the cofactor matrix; the result is not unit. */
struct orl_vec3 orl_gltf_place_normal(const struct orl_gltf_place *place, struct orl_vec3 n);

#endif
