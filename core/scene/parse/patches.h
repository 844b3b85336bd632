/*
 * The triangles of a compiled mesh: vertices in patches of at most 256, triangles that index them
 * by patch and place. Reference: as binary.h.
 */
#ifndef ORL_SCENE_PARSE_PATCHES_H
#define ORL_SCENE_PARSE_PATCHES_H

#include <oriel/vec.h>

#include "scene/parse/binary.h"

struct orl_patch_triangle {
    uint32_t corner[3]; /* vertices: patch << 8 | place in it */
    int32_t material;   /* of those in the file, or -1 */
};

struct orl_patches {
    struct orl_vec3 *vertices; /* in the mesh's own coordinates */
    size_t n_vertices, vertices_room;
    double (*places)[2]; /* (u, v) of each vertex; not numbers where it has none */
    size_t places_room;
    size_t *first; /* vertex of each patch, and one behind the last */
    size_t n_patches;
    struct orl_patch_triangle *triangles;
    size_t n_triangles, triangles_room;
    struct orl_vec3 *normals; /* of each vertex: unit, 0 where it has none */
    size_t normals_room;
};

/* What the numbers in patches are shares of: the cube that holds all, and the limits of (u, v). */
struct orl_patch_frame {
    struct orl_vec3 corner;
    double size;
    double low[2], high[2];
};

/* ORL_ERR_SYNTAX, _LIMIT or _NOMEM. Whatever it returns, the caller passes ret to orl_patches_done.
 */
int orl_patches_read(struct orl_binary *binary, const struct orl_patch_frame *frame,
                     struct orl_patches *ret, struct orl_error *err);
/* False where a corner names no vertex. ret_placed: all have places; ret_turned: normals. */
bool orl_patches_corners(const struct orl_patches *patches, const struct orl_patch_triangle *t,
                         struct orl_vec3 ret_corners[3], double ret_places[6], bool *ret_placed,
                         struct orl_vec3 ret_normals[3], bool *ret_turned);
void orl_patches_done(struct orl_patches *patches);

#endif
