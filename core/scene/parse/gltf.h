/*
 * glTF 2.0 (.glb; .gltf with its buffers within or beside): the triangles of its scene, placed by
 * its nodes. Metres stay; its axes, of which y points up, are turned to Radiance's: x, y, z become
 * x, -z, y. Faces are wavefront.h's: of the material's name, the node's name or else the mesh's,
 * normals where the mesh has them; blanks in names become underscores, "line" is the triangle's
 * number. Vertices may be quantized (KHR_mesh_quantization) or given apart (sparse), meshes copied
 * (EXT_mesh_gpu_instancing). Colours, textures, cameras, lamps and movement are passed over.
 * What would change the shape unseen is refused: other extensions that a file requires, numbers of
 * what is not there, nodes in two places. Reference: Khronos Group, "glTF 2.0 Specification"
 * (2021).
 */
#ifndef ORL_SCENE_PARSE_GLTF_H
#define ORL_SCENE_PARSE_GLTF_H

#include <oriel/files.h>

#include "scene/parse/wavefront.h"

/* The files that hold a .gltf's buffers, by the names that it calls them. */
struct orl_gltf_buffers {
    int (*open)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    void *ctx;
};

/* What was passed over. */
struct orl_gltf_rest {
    uint64_t lines;   /* of meshes in their places: parts that are points or lines */
    uint64_t skinned; /* meshes that a skeleton moves, which stand as they are */
    uint64_t blended; /* meshes whose shape is blended of several: the first stands */
    bool empty;       /* there was no triangle */
};

/* By how it begins: a .glb, or the JSON of a .gltf. */
bool orl_gltf_is(const char *data, size_t size);

/* ORL_ERR_SYNTAX, _UNSUPPORTED, _RANGE, _LIMIT, _NOMEM, with the file and what of it ("nodes[3]");
 * or what opening a buffer or the sink says. */
int orl_gltf_read(const char *file, const char *data, size_t size,
                  const struct orl_gltf_buffers *buffers, const struct orl_wavefront_sink *sink,
                  struct orl_gltf_rest *ret_rest, struct orl_error *err);

#endif
