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

struct orl_gltf_file;

/*
 * Objects of a glTF file's JSON, with checked access to their members. Messages name an object by
 * its position, such as "nodes[3]".
 *
 * The first error stays in the file's code and err; later ones are ignored. After an error the
 * functions still return, but with arbitrary values: test the code before relying on one, for
 * example as an index.
 */
struct orl_gltf_item {
    struct orl_gltf_file *file; /* borrowed, as is object */
    const json_t *object;       /* NULL or another type: without members */
    char name[96];              /* "" for the root */
};

/* Reports what is wrong with the item, unless there was an error already. */
void orl_gltf_refuse(const struct orl_gltf_item *at, int code, const char *hint, const char *format,
                     ...) __attribute__((format(printf, 4, 5)));

/* Reports a fault of the file's exporter. */
#define orl_gltf_fail(at, code, ...)                                                               \
    orl_gltf_refuse(at, code, "the file is damaged, or its exporter is faulty: export it again",   \
                    __VA_ARGS__)

/* Returns an element of one of the root's lists, which the item `at` refers to. */
struct orl_gltf_item orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index);

/* Returns an element of one of the item's own lists. */
struct orl_gltf_item orl_gltf_element(const struct orl_gltf_item *at, const char *list,
                                      size_t index);

/* Returns a member object; its object is NULL if it is absent. */
struct orl_gltf_item orl_gltf_member(const struct orl_gltf_item *at, const char *key);

/* Returns the length of a member list; 0 if absent. */
size_t orl_gltf_length(const struct orl_gltf_item *at, const char *list);

/* Read an integer from 0 to 2^53: a member, or `absent` if there is none; one in a list. */
size_t orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t absent);
size_t orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i);

/* Reads an array of n numbers. Returns false, and leaves the values unchanged, if it is absent. */
bool orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values);

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
    const char *name;
    int code; /* of the first error, or 0 */
    struct orl_error *err;
    struct orl_gltf_item root;
    json_t *document;            /* owned */
    struct orl_gltf_bytes chunk; /* data NULL: no chunk */
    const struct orl_gltf_buffers *external;
    struct orl_gltf_buffer *buffers;
    size_t n_buffers;
    uint64_t steps; /* work counted so far */
};

/* Borrows its arguments. The code becomes 0, ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT or _NOMEM.
 * Requires orl_gltf_file_done in every case. */
void orl_gltf_file_open(struct orl_gltf_file *file, const char *name, const char *data, size_t size,
                        const struct orl_gltf_buffers *external, struct orl_error *err);
void orl_gltf_file_done(struct orl_gltf_file *file);

/* Sets ORL_ERR_NOMEM. */
void orl_gltf_no_memory(struct orl_gltf_file *file);

/* Returns the buffer that `at` names, of the length that the JSON gives. */
struct orl_gltf_bytes orl_gltf_buffer(const struct orl_gltf_item *at, size_t index);

/* Counts work for the object `at`: triangles, placed meshes, sparse vertices. Sets ORL_ERR_LIMIT if
 * the total is too large: small files can ask for any amount. */
void orl_gltf_step(const struct orl_gltf_item *at, uint64_t steps);

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
struct orl_gltf_accessor orl_gltf_accessor_open(const struct orl_gltf_item *at, size_t index,
                                                const char *type);

/* Reads the value of index i, which is below count; sets ORL_ERR_RANGE if it is not finite. */
void orl_gltf_accessor_value(const struct orl_gltf_accessor *accessor, size_t i,
                             double ret_value[4]);

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
struct orl_gltf_transform orl_gltf_transform_read(const struct orl_gltf_item *node);

/* Instances that a node's EXT_mesh_gpu_instancing makes of its mesh. */
struct orl_gltf_instances {
    size_t count;
    /* scale, rotation and translation, applied in this order; which of them are given */
    struct orl_gltf_accessor parts[3];
    bool given[3];
};

/* Sets count to 1, with nothing given, if the node has no such extension. */
void orl_gltf_instances_open(const struct orl_gltf_item *node,
                             struct orl_gltf_instances *ret_instances);
struct orl_gltf_transform orl_gltf_instance_transform(const struct orl_gltf_instances *instances,
                                                      size_t i);

struct orl_vec3 orl_gltf_transform_point(const struct orl_gltf_transform *transform,
                                         struct orl_vec3 at);

/* Returns true if the transform mirrors: the order of corners must be reversed to keep the
 * front. */
bool orl_gltf_transform_mirrors(const struct orl_gltf_transform *transform);

/* Transforms a normal by the cofactor matrix; the result is not unit. */
struct orl_vec3 orl_gltf_transform_normal(const struct orl_gltf_transform *transform,
                                          struct orl_vec3 n);

#endif
