/*
 * Access to a glTF file for gltf.c: objects of its JSON, buffers, accessors, transforms.
 */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_FILE_H
#define ORL_SCENE_PARSE_GLTF_GLTF_FILE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "scene/parse/gltf/gltf.h"

/* All pointers are borrowed. */
/*
 * Objects of a glTF file's JSON, with checked access to their members. Messages name an object by
 * its position, such as "nodes[3]".
 *
 * Functions return 0 or ORL_ERR_SYNTAX with err filled. If a member is absent they return 0 and
 * leave the output unchanged.
 */

struct orl_gltf_item {
    const char *file;
    const json_t *root, *object;
    char name[96]; /* "" for the root */
};

/* Reports what is wrong with the item, and that the file must be exported again. Returns code. */
int orl_gltf_fail(const struct orl_gltf_item *at, int code, struct orl_error *err,
                  const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Returns an element of one of the root's lists, which the item `at` refers to. */
int orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_item, struct orl_error *err);

/* Returns an element of one of the item's own lists. */
int orl_gltf_element(const struct orl_gltf_item *at, const char *list, size_t index,
                     struct orl_gltf_item *ret_part, struct orl_error *err);

/* Returns a member object; ret_inner->object is NULL if it is absent. */
int orl_gltf_member(const struct orl_gltf_item *at, const char *key,
                    struct orl_gltf_item *ret_inner, struct orl_error *err);

/* Returns the length of a member list; 0 if absent. */
int orl_gltf_length(const struct orl_gltf_item *at, const char *list, size_t *ret_length,
                    struct orl_error *err);

/* Reads an integer from 0 to 2^53. */
int orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t *value,
                     struct orl_error *err);
/* Reads an integer from 0 to 2^53 in a list. */
int orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i,
                             size_t *ret_value, struct orl_error *err);

/* Reads an array of n numbers; *ret_given: it is present. */
int orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values,
                     bool *ret_given, struct orl_error *err);

/* Returns NULL if the member is absent or not a string. */
const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key);

/*
 * An open glTF file: its JSON (text, or a .glb's first chunk), its requirements on a reader, and
 * the bytes of its buffers, which are opened at first use: a .glb's second chunk, base64 text, or a
 * separate file. Only base64 is copied.
 */

struct orl_gltf_bytes {
    const unsigned char *data;
    size_t size;
};

struct orl_gltf_buffer {
    struct orl_gltf_bytes bytes; /* data NULL: not open yet */
    unsigned char *decoded;      /* owned, or NULL */
};

struct orl_gltf_file {
    struct orl_gltf_item root;
    json_t *document;            /* owned */
    struct orl_gltf_bytes chunk; /* data NULL: no chunk */
    const struct orl_gltf_buffers *external;
    struct orl_gltf_buffer *buffers;
    size_t n_buffers;
    uint64_t steps; /* work counted so far */
};

/* Borrows name, data and beside. Returns 0, ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT or _NOMEM.
 * Requires orl_gltf_file_done in every case. */
int orl_gltf_file_open(struct orl_gltf_file *file, const char *name, const char *data, size_t size,
                       const struct orl_gltf_buffers *external, struct orl_error *err);
void orl_gltf_file_done(struct orl_gltf_file *file);

/* Returns the buffer that `at` names, of the length that the JSON gives. */
int orl_gltf_file_buffer(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                         struct orl_gltf_bytes *ret_bytes, struct orl_error *err);

/* Counts work for the object `at`: triangles, placed meshes, sparse vertices. Returns ORL_ERR_LIMIT
 * if the total is too large: small files can ask for any amount. */
int orl_gltf_file_step(struct orl_gltf_file *file, const struct orl_gltf_item *at, uint64_t steps,
                       struct orl_error *err);

/*
 * Accessors of a glTF file: values of one to four components, integer or float, at a stride in a
 * buffer. Some may be overridden by sparse values; without a buffer view the other values are 0.
 * Normalized integers are mapped to -1..1 or 0..1.
 */

enum orl_gltf_component {
    ORL_GLTF_I8 = 5120,
    ORL_GLTF_U8,
    ORL_GLTF_I16,
    ORL_GLTF_U16,
    ORL_GLTF_U32 = 5125,
    ORL_GLTF_F32
};

/* Borrows its bytes from the file's buffers. */
struct orl_gltf_accessor {
    struct orl_gltf_item item;
    const unsigned char *data; /* NULL: all 0 */
    size_t stride, count;      /* count: at least 1 */
    size_t n_components, component;
    bool normalized;
    /* indices and values of the sparse values, in rising order of index */
    const unsigned char *sparse_indices, *values;
    size_t n_sparse, sparse_component;
};

/* Opens the accessor that `at` names, and checks that all its bytes exist. type: the required type,
 * such as "VEC3". */
int orl_gltf_accessor_open(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                           const char *type, struct orl_gltf_accessor *ret_accessor,
                           struct orl_error *err);

/* Reads the value of index i, which is below count; ORL_ERR_RANGE if it is not finite. */
int orl_gltf_accessor_value(const struct orl_gltf_accessor *accessor, size_t i, double ret_value[4],
                            struct orl_error *err);

/* Returns the first component of an integer value. */
size_t orl_gltf_accessor_integer(const struct orl_gltf_accessor *accessor, size_t i);

/* Returns the largest value of an unsigned component type; 0 for other types. */
size_t orl_gltf_accessor_max(const struct orl_gltf_accessor *accessor);

/* Transforms of glTF nodes. */

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
