/*
 * Reader for files of oconv and obj2mesh: a text header, then integers (big-endian, signed),
 * numbers (four bytes of mantissa, one of exponent) and NUL-terminated strings, read from front to
 * back.
 * Reference: "Radiance File Formats" (Ward, 2019), octrees and compiled meshes.
 *
 * A read beyond the end returns zeros and sets `ended`; callers must test it before they use
 * values. Nothing is copied: strings point into the data.
 */
#ifndef ORL_SCENE_PARSE_INSTANCE_BINARY_READER_H
#define ORL_SCENE_PARSE_INSTANCE_BINARY_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

struct orl_binary_reader {
    const unsigned char *data;
    size_t size, at;
    bool ended; /* a read went beyond the end */
};

/* Skips the header; ORL_ERR_SYNTAX unless its FORMAT is the given one. */
int orl_binary_open(const char *data, size_t size, const char *format,
                    struct orl_binary_reader *ret, struct orl_error *err);

/* Reads an integer of 1 to 8 bytes. */
int64_t orl_binary_int(struct orl_binary_reader *reader, unsigned bytes);
double orl_binary_number(struct orl_binary_reader *reader);
/* Returns "" beyond the end, or if the string is longer than Radiance allows. */
const char *orl_binary_string(struct orl_binary_reader *reader);

/* Skips an octree whose leaves are sets of integers of that size in bytes. */
int orl_binary_skip_octree(struct orl_binary_reader *reader, unsigned bytes, struct orl_error *err);

/* Sets the error: "it ends too early" if data ended, else `what`. Returns ORL_ERR_SYNTAX. */
int orl_binary_fail(const struct orl_binary_reader *reader, const char *what,
                    struct orl_error *err);

/* Names of primitives in order, pointing into the data. The caller frees the array. */
struct orl_binary_names {
    const char **at;
    size_t count, room;
};

/*
 * Converts primitives to scene text: calls take with successive texts, each of whole primitives. In
 * the file primitives refer to each other by number, in the text by name, which is equivalent
 * unless a name is defined twice. Fills names meanwhile. Returns 0, ORL_ERR_SYNTAX, _NOMEM, or
 * take's error.
 */
int orl_binary_primitives(struct orl_binary_reader *reader, unsigned bytes,
                          struct orl_binary_names *names,
                          int (*take)(void *ctx, const char *text, size_t size,
                                      struct orl_error *err),
                          void *ctx, struct orl_error *err);

/*
 * Triangles of a compiled mesh: vertices in patches of at most 256; triangles index them by patch
 * and position. Reference: see above.
 */

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
/* Returns false if a corner is not a vertex. *ret_has_uv: all corners have (u, v);
 * *ret_has_normals: all have normals. */
bool orl_patches_corners(const struct orl_patches *patches, const struct orl_patch_triangle *t,
                         struct orl_vec3 ret_corners[3], double ret_uv[6], bool *ret_has_uv,
                         struct orl_vec3 ret_normals[3], bool *ret_has_normals);
void orl_patches_done(struct orl_patches *patches);

#endif
