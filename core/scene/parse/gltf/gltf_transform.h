/* Transforms of glTF nodes. */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_TRANSFORM_H
#define ORL_SCENE_PARSE_GLTF_GLTF_TRANSFORM_H

#include <oriel/base/vec.h>

#include "scene/parse/gltf/gltf_accessor.h"

/* An affine transform: coordinate i becomes row[i][0] x + row[i][1] y + row[i][2] z + row[i][3]. */
struct orl_gltf_transform {
    double row[3][4];
};

/* Converts glTF's y up to Radiance's z up. */
extern const struct orl_gltf_transform orl_gltf_z_up;

struct orl_gltf_transform orl_gltf_transform_compose(const struct orl_gltf_transform *outer,
                                                     const struct orl_gltf_transform *inner);

/* Reads a node's own transform: its matrix; or scale, rotation and translation; or the identity. */
int orl_gltf_transform_read(const struct orl_gltf_item *node,
                            struct orl_gltf_transform *ret_transform, struct orl_error *err);

/* Instances that a node's EXT_mesh_gpu_instancing makes of its mesh. */
struct orl_gltf_instances {
    size_t count;
    bool given[3]; /* which of these are given; they are applied in this order */
    struct orl_gltf_accessor scale, rotation, translation;
};

/* Sets count to 1, with nothing given, if the node has no such extension. */
int orl_gltf_instances_open(struct orl_gltf_file *file, const struct orl_gltf_item *node,
                            struct orl_gltf_instances *ret_instances, struct orl_error *err);
int orl_gltf_instance_transform(const struct orl_gltf_instances *instances, size_t i,
                                struct orl_gltf_transform *ret_transform, struct orl_error *err);

struct orl_vec3 orl_gltf_transform_point(const struct orl_gltf_transform *transform,
                                         struct orl_vec3 at);

/* Returns true if the transform mirrors: the order of corners must be reversed to keep the
 * front. */
bool orl_gltf_transform_mirrors(const struct orl_gltf_transform *transform);

/* Transforms a normal by the cofactor matrix; the result is not unit. */
struct orl_vec3 orl_gltf_transform_normal(const struct orl_gltf_transform *transform,
                                          struct orl_vec3 n);

#endif
