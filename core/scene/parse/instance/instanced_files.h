/*
 * Instancing of compiled files (instance, mesh), such as trees: each is read once, and stored once
 * if the scene has it in four places or more.
 *
 * This applies to files of at least 64 surfaces, all of them plastic or metal, or trans with
 * diffuse transmission, and none of them anisotropic. Emitters and other transmitting surfaces need
 * surfaces of their own in every place, and so do files that contain any. The surfaces of a file in
 * fewer places are copied to each, in the order of the files.
 *
 * Patterns and textures of such a file are evaluated where it was read first
 * (geometry/instances.h). Patterns from outside the file may only depend on a mesh's coordinates;
 * its own must not depend on the scene's position in their frame (Ix, Tx and the like). Files with
 * any are stored once from two places on.
 */
#ifndef ORL_SCENE_PARSE_INSTANCE_INSTANCED_FILES_H
#define ORL_SCENE_PARSE_INSTANCE_INSTANCED_FILES_H

#include <oriel/base/error.h>

#include "scene/parse/symbols.h"
#include "scene/parsed_scene.h"

struct orl_parser;
struct orl_scope;

/* Key of a file's surfaces: the file and the modifier over it. */
struct orl_instanced_file_key {
    const char *data; /* the file's data, which stay while the scene is read */
    bool is_mesh, is_modified;
    enum orl_symbol_kind kind; /* kind of the modifier */
    uint32_t index;
};

struct orl_instanced_file {
    struct orl_instanced_file_key key;
    size_t first, end;        /* range of its surfaces */
    size_t main_file;         /* main file in which it was read */
    const char *prefix;       /* prefix of names there, with its full stop; in the arena */
    struct orl_xform to_file; /* from the first place to the file's own coordinates */
    size_t n_places;          /* number of further places */
    bool has_patterns;        /* has patterns or textures */
};

struct orl_instanced_files {
    struct orl_instanced_file *items;
    size_t n, room;
    struct orl_placement *places; /* prototype: index into items */
    size_t n_places, places_room;
    bool plain; /* files with patterns are not instanced */
};

/* Counts before a file is read. */
struct orl_parser_counts {
    size_t surfaces, distant_sources, skies, refused, places, patterns;
};
struct orl_parser_counts orl_parser_counts_now(const struct orl_parser *parser);

/*
 * Adds an instance of a file that has been read and can be instanced. id: identifier of the
 * primitive. Returns 1 if it did, 0 if the file must be read, or ORL_ERR_LIMIT, _NOMEM.
 */
int orl_instanced_files_place(struct orl_parser *parser, const struct orl_instanced_file_key *key,
                              const struct orl_scope *scope, const char *id, struct orl_error *err);

/* Records a file that has been read in a scope, if it can be instanced. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_instanced_files_add(struct orl_parser *parser, const struct orl_instanced_file_key *key,
                            const struct orl_parser_counts *before, const struct orl_scope *scope,
                            struct orl_error *err);

/* Makes prototypes, and expands those with too few places. Everything else in the parsed scene must
 * be complete. Returns 0, ORL_ERR_LIMIT or ORL_ERR_NOMEM. */
int orl_instanced_files_finish(struct orl_instanced_files *instanced_files,
                               struct orl_parsed_scene *parsed_scene, struct orl_error *err);

void orl_instanced_files_done(struct orl_instanced_files *instanced_files);

#endif
