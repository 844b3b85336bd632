/*
 * A glTF file opened: its JSON, be it text or a .glb's first chunk, what that asks of a reader, and
 * the bytes of its buffers, which are opened when they are first asked for: a .glb's second chunk,
 * text in base64, or a file beside. They are not copied but for base64.
 */
#ifndef ORL_SCENE_PARSE_GLTF_FILE_H
#define ORL_SCENE_PARSE_GLTF_FILE_H

#include <stdint.h>

#include "scene/parse/gltf.h"
#include "scene/parse/gltf_json.h"

struct orl_gltf_bytes {
    const unsigned char *data;
    size_t size;
};

struct orl_gltf_buffer {
    struct orl_gltf_bytes bytes; /* data NULL: not opened */
    unsigned char *decoded;      /* owned, or NULL */
};

struct orl_gltf_file {
    struct orl_gltf_item root;
    json_t *document;            /* owned */
    struct orl_gltf_bytes chunk; /* data NULL: there is none */
    const struct orl_gltf_buffers *beside;
    struct orl_gltf_buffer *buffers;
    size_t n_buffers;
    uint64_t steps; /* taken so far */
};

/* Borrows name, data and beside. ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT, _NOMEM. _done is wanted
 * whatever happens. */
int orl_gltf_file_open(struct orl_gltf_file *file, const char *name, const char *data, size_t size,
                       const struct orl_gltf_buffers *beside, struct orl_error *err);
void orl_gltf_file_done(struct orl_gltf_file *file);

/* The buffer that the item at names, as long as it says. */
int orl_gltf_file_buffer(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                         struct orl_gltf_bytes *ret_bytes, struct orl_error *err);

/* So much more work is done for what at says: a triangle, a mesh in its place, a vertex given
 * apart. ORL_ERR_LIMIT where that is too much together: small files can ask for any amount. */
int orl_gltf_file_step(struct orl_gltf_file *file, const struct orl_gltf_item *at, uint64_t steps,
                       struct orl_error *err);

#endif
