/*
 * Accessors of a glTF file: values of one to four components, whole or of floating point, in a
 * stretch of a buffer, each so far from the last; some of them may be given apart (sparse), and
 * where there is no stretch the rest is 0. Whole numbers that are normalized stand for -1 to 1 or
 * 0 to 1.
 */
#ifndef ORL_SCENE_PARSE_GLTF_ACCESSOR_H
#define ORL_SCENE_PARSE_GLTF_ACCESSOR_H

#include "scene/parse/gltf_file.h"

enum orl_gltf_component {
    ORL_GLTF_I8 = 5120,
    ORL_GLTF_U8,
    ORL_GLTF_I16,
    ORL_GLTF_U16,
    ORL_GLTF_U32 = 5125,
    ORL_GLTF_F32
};

/* Borrows its bytes of the file's buffers. */
struct orl_gltf_accessor {
    struct orl_gltf_item item;
    const unsigned char *data; /* NULL: 0 throughout */
    size_t stride, count;      /* count: 1 at least */
    size_t n_components, component;
    bool normalized;
    const unsigned char *places, *values; /* of those given apart, in the order of their places */
    size_t n_apart, place_component;
};

/* The accessor that at names: all its bytes are there. type is what it must be, as "VEC3". */
int orl_gltf_accessor_open(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                           const char *type, struct orl_gltf_accessor *ret_accessor,
                           struct orl_error *err);

/* The value of that number, below count; ORL_ERR_RANGE where it is not finite. */
int orl_gltf_accessor_value(const struct orl_gltf_accessor *accessor, size_t i, double ret_value[4],
                            struct orl_error *err);

/* The first component, of whole numbers. */
size_t orl_gltf_accessor_whole(const struct orl_gltf_accessor *accessor, size_t i);

/* The largest that a component can be, of whole numbers without a sign; 0: it is none. */
size_t orl_gltf_accessor_most(const struct orl_gltf_accessor *accessor);

#endif
