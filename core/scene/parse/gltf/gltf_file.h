/*
 * An open glTF file: its JSON (text, or a .glb's first chunk), its requirements on a reader, and
 * the bytes of its buffers, which are opened at first use: a .glb's second chunk, base64 text, or a
 * separate file. Only base64 is copied.
 */
#ifndef ORL_SCENE_PARSE_GLTF_GLTF_FILE_H
#define ORL_SCENE_PARSE_GLTF_GLTF_FILE_H

#include <stdint.h>

#include "scene/parse/gltf/gltf.h"
#include "scene/parse/gltf/gltf_json.h"

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

#endif
