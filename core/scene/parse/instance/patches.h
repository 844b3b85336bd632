/*
 * Triangles of a compiled mesh: vertices in patches of at most 256; triangles index them by patch
 * and position. Reference: see binary.h.
 */
#ifndef ORL_SCENE_PARSE_INSTANCE_PATCHES_H
#define ORL_SCENE_PARSE_INSTANCE_PATCHES_H

#include <oriel/base/vec.h>

#include "scene/parse/instance/binary_reader.h"

struct orl_patch_triangle {
    uint32_t corner[3]; /* vertices: patch << 8 | position in it */
    int32_t material;   /* index among the file's materials, or -1 */
};

struct orl_patches {
    struct orl_vec3 *vertices; /* in the mesh's coordinates */
    size_t n_vertices, vertices_room;
    double (*uv)[2]; /* (u, v) of each vertex; NaN if it has none */
    size_t uv_room;
    size_t *first; /* first vertex of each patch; one extra at the end */
    size_t n_patches;
    struct orl_patch_triangle *triangles;
    size_t n_triangles, triangles_room;
    struct orl_vec3 *normals; /* normal of each vertex: unit, or 0 if it has none */
    size_t normals_room;
};

/* Ranges of the numbers in patches: the bounding cube, and the limits of (u, v). */
struct orl_patch_frame {
    struct orl_vec3 corner;
    double size;
    double low[2], high[2];
};

/* Returns 0, ORL_ERR_SYNTAX, _LIMIT or _NOMEM. The caller passes ret to orl_patches_done in every
 * case. */
int orl_patches_read(struct orl_binary_reader *reader, const struct orl_patch_frame *frame,
                     struct orl_patches *ret, struct orl_error *err);
/* Returns false if a corner is not a vertex. *ret_placed: all corners have (u, v); *ret_turned: all
 * have normals. */
bool orl_patches_corners(const struct orl_patches *patches, const struct orl_patch_triangle *t,
                         struct orl_vec3 ret_corners[3], double ret_uv[6], bool *ret_has_uv,
                         struct orl_vec3 ret_normals[3], bool *ret_has_normals);
void orl_patches_done(struct orl_patches *patches);

#endif
