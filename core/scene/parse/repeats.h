/*
 * Compiled files that a scene has in several places (instance, mesh), such as trees: read once, and
 * kept once where the scene has them in four places or more.
 *
 * That is for files of at least 64 surfaces, all of them plastic or metal, or trans that spreads
 * evenly what it lets through, none of them brushed. What shines or lets light through otherwise
 * needs surfaces of its own in every place, and so do files that have any of that in them. Of a
 * file that is in fewer places the surfaces stand in each, in the order of the files.
 *
 * Patterns and textures of such a file are its own, and asked where it was read first
 * (geometry/placed.h): those that come from outside it may depend on a mesh's coordinates alone,
 * others not on where the world is in their frame (Ix, Tx and the like). Files that have any are
 * kept once in two places already.
 */
#ifndef ORL_SCENE_PARSE_REPEATS_H
#define ORL_SCENE_PARSE_REPEATS_H

#include <oriel/error.h>

#include "scene/description.h"
#include "scene/parse/symbols.h"

struct orl_parser;
struct orl_scope;

/* What is read, and with which modifier over it: by equal ones equal surfaces come. */
struct orl_repeat_key {
    const char *data; /* of the file, as it is kept while the scene is read */
    bool is_mesh, is_modified;
    enum orl_symbol_kind kind; /* of the modifier */
    uint32_t index;
};

struct orl_repeat {
    struct orl_repeat_key key;
    size_t first, end;     /* its surfaces */
    size_t main_file;      /* where it was read */
    const char *prefix;    /* of names there, with its full stop; in the arena */
    struct orl_xform back; /* from there to the file's own coordinates */
    size_t n_places;       /* besides */
    bool varied;           /* it has patterns or textures */
};

struct orl_repeats {
    struct orl_repeat *items;
    size_t n, room;
    struct orl_placement *places; /* prototype: of items */
    size_t n_places, places_room;
    bool plain; /* what has patterns is not kept once */
};

/* What there was before a file was read. */
struct orl_repeat_mark {
    size_t surfaces, distants, skies, refused, places, patterns;
};
struct orl_repeat_mark orl_repeats_mark(const struct orl_parser *parser);

/*
 * Puts what the key stands for into a scope, once it has been read and is fit to be kept once. id:
 * of the primitive that names it. Returns 1 when it did, 0 when it is to be read, or ORL_ERR_LIMIT,
 * _NOMEM.
 */
int orl_repeats_place(struct orl_parser *parser, const struct orl_repeat_key *key,
                      const struct orl_scope *scope, const char *id, struct orl_error *err);

/* It has been read in a scope; whether it is fit is found here. Returns 0 or ORL_ERR_NOMEM. */
int orl_repeats_note(struct orl_parser *parser, const struct orl_repeat_key *key,
                     const struct orl_repeat_mark *before, const struct orl_scope *scope,
                     struct orl_error *err);

/* Makes prototypes, and expands what is in too few places. The description is complete but for
 * that. Returns 0, ORL_ERR_LIMIT or ORL_ERR_NOMEM. */
int orl_repeats_settle(struct orl_repeats *repeats, struct orl_description *description,
                       struct orl_error *err);

void orl_repeats_done(struct orl_repeats *repeats);

#endif
