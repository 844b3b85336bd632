/*
 * Instancing of compiled files (instance, mesh), such as trees: each is read once, and stored once
 * if the scene has it in four places or more.
 *
 * This applies to files of at least 64 surfaces, all of them plastic or metal, or trans with
 * diffuse transmission, and none of them anisotropic. Emitters and other transmitting surfaces need
 * surfaces of their own in every place, and so do files that contain any. The surfaces of a file in
 * fewer places are copied to each, in the order of the files.
 *
 * Patterns and textures of such a file are evaluated where it was read first (geometry/placed.h).
 * Patterns from outside the file may only depend on a mesh's coordinates; its own must not depend
 * on the world's position in their frame (Ix, Tx and the like). Files with any are stored once from
 * two places on.
 */
#ifndef ORL_SCENE_PARSE_REPEATS_H
#define ORL_SCENE_PARSE_REPEATS_H

#include <oriel/error.h>

#include "scene/description.h"
#include "scene/parse/symbols.h"

struct orl_parser;
struct orl_scope;

/* Key of a file's surfaces: the file and the modifier over it. */
struct orl_repeat_key {
    const char *data; /* the file's data, which stay while the scene is read */
    bool is_mesh, is_modified;
    enum orl_symbol_kind kind; /* kind of the modifier */
    uint32_t index;
};

struct orl_repeat {
    struct orl_repeat_key key;
    size_t first, end;     /* range of its surfaces */
    size_t main_file;      /* main file in which it was read */
    const char *prefix;    /* prefix of names there, with its full stop; in the arena */
    struct orl_xform back; /* from the first place to the file's own coordinates */
    size_t n_places;       /* number of further places */
    bool varied;           /* has patterns or textures */
};

struct orl_repeats {
    struct orl_repeat *items;
    size_t n, room;
    struct orl_placement *places; /* prototype: index into items */
    size_t n_places, places_room;
    bool plain; /* files with patterns are not instanced */
};

/* Counts before a file is read. */
struct orl_repeat_mark {
    size_t surfaces, distants, skies, refused, places, patterns;
};
struct orl_repeat_mark orl_repeats_mark(const struct orl_parser *parser);

/*
 * Adds an instance of a file that has been read and can be instanced. id: identifier of the
 * primitive. Returns 1 if it did, 0 if the file must be read, or ORL_ERR_LIMIT, _NOMEM.
 */
int orl_repeats_place(struct orl_parser *parser, const struct orl_repeat_key *key,
                      const struct orl_scope *scope, const char *id, struct orl_error *err);

/* Records a file that has been read in a scope, if it can be instanced. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_repeats_note(struct orl_parser *parser, const struct orl_repeat_key *key,
                     const struct orl_repeat_mark *before, const struct orl_scope *scope,
                     struct orl_error *err);

/* Makes prototypes, and expands those with too few places. Everything else in the description must
 * be complete. Returns 0, ORL_ERR_LIMIT or ORL_ERR_NOMEM. */
int orl_repeats_settle(struct orl_repeats *repeats, struct orl_description *description,
                       struct orl_error *err);

void orl_repeats_done(struct orl_repeats *repeats);

#endif
