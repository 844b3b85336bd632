/*
 * Accessors of a glTF file: values of one to four components, integer or float, at a stride in a
 * buffer. Some may be overridden by sparse values; without a buffer view the other values are 0.
 * Normalized integers are mapped to -1..1 or 0..1.
 */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_ACCESSOR_H
#define ORL_SCENE_PARSE_GLTF_GLTF_ACCESSOR_H

#include "scene/parse/gltf/gltf_file.h"

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

#endif
