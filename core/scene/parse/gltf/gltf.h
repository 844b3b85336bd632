/*
 * glTF 2.0 (.glb; .gltf with embedded or separate buffers): the triangles of its scene, placed by
 * its nodes. Units are metres; the axes (y up) are converted to Radiance's: x, y, z become x, -z,
 * y. Faces are those of mesh_formats.h: the material's name; the node's name or else the mesh's;
 * normals if the mesh has them. Blanks in names become underscores; "line" is the triangle's
 * number.
 *
 * Vertices may be quantized (KHR_mesh_quantization) or sparse, meshes instanced
 * (EXT_mesh_gpu_instancing). Colours, textures, cameras, lights and animation are ignored. Content
 * that would change the shape unnoticed is refused: other required extensions, indices out of
 * range, nodes with two parents.
 * Reference: Khronos Group, "glTF 2.0 Specification" (2021).
 */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_H
#define ORL_SCENE_PARSE_GLTF_GLTF_H

#include <oriel/base/files.h>

#include "scene/parse/mesh/mesh_formats.h"

/* Opens the files of a .gltf's buffers, by their names in the file. */
struct orl_gltf_buffers {
    int (*open)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    void *ctx;
};

/* Content that was ignored. */
struct orl_gltf_ignored {
    uint64_t lines;   /* mesh primitives that are points or lines, per instance */
    uint64_t skinned; /* meshes with a skeleton, read in their rest pose */
    uint64_t blended; /* meshes with morph targets, read in their base shape */
    bool empty;       /* there were no triangles */
};

/* Returns true if the data begin like a .glb, or like the JSON of a .gltf. */
bool orl_gltf_detect(const char *data, size_t size);

/* Returns 0, ORL_ERR_SYNTAX, _UNSUPPORTED, _RANGE, _LIMIT or _NOMEM, with the file and the object
 * ("nodes[3]"); or the error of opening a buffer or of the sink. */
int orl_gltf_read(const char *file, const char *data, size_t size,
                  const struct orl_gltf_buffers *buffers, const struct orl_wavefront_sink *sink,
                  struct orl_gltf_ignored *ret_ignored, struct orl_error *err);

#endif
