/*
 * STL: triangles, in text or binary, little-endian. Normals follow from the order of corners, and
 * the written ones are ignored; units and axes are the file's. Reference: 3D Systems,
 * "StereoLithography Interface Specification" (1988).
 */
#ifndef ORL_SCENE_PARSE_MESH_STL_H
#define ORL_SCENE_PARSE_MESH_STL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

#include <oriel/base/error.h>

struct orl_stl_sink {
    /* line: 1-based in text; the triangle's number in a binary file */
    int (*add)(void *ctx, const struct orl_vec3 corners[3], int line, struct orl_error *err);
    void *ctx;
};

bool orl_stl_detect(const char *data, size_t size);
/* Returns 0, ORL_ERR_SYNTAX with file and line, or the sink's error, which stops reading. file: for
 * messages. */
int orl_stl_read(const char *file, const char *data, size_t size, const struct orl_stl_sink *sink,
                 struct orl_error *err);

#endif
