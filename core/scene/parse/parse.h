/*
 * Parses Radiance scene files into a struct orl_parsed_scene. The commands that they call are
 * executed natively (command/piped_commands.c). Any other command, and any primitive that Oriel
 * does not support, is an error with file, line and primitive. No shell is ever started.
 *
 * The files of a scene are opened once (struct orl_sources).
 */
#ifndef ORL_SCENE_PARSE_PARSE_H
#define ORL_SCENE_PARSE_PARSE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/files.h>
#include <oriel/base/sha256.h>
#include <oriel/bsdf/bsdf.h>

#include "base/memory/memory.h"
#include "scene/parsed_scene.h"

/*
 * The files of a scene: found, opened once, hashed in order of first use, and closed at the end.
 * Names are resolved lexically ("a/../b" is "b"): first in the folder of the file that mentions
 * them, then as written.
 *
 * Ownership: orl_sources_done closes all files; names are stored in the parsed scene's arena.
 */

struct orl_source {
    char *name;   /* resolved name, for the provider */
    char *folder; /* "a" for "a/b.rad", "" for "b.rad" */
    struct orl_file file;
    bool open, library; /* library: from the user's library, not the scene's own files */
    unsigned char content[ORL_SHA256_BYTES];
    struct orl_bsdf *bsdf; /* a reference, once it was loaded as a BSDF */
};

/* Loader of BSDFs instead of orl_bsdf_load, perhaps from a cache; NULL: none. And a cancel flag. */
struct orl_bsdf_loader {
    void *ctx;
    int (*load)(void *ctx, const struct orl_bsdf_xml *xml,
                const unsigned char content[ORL_SHA256_BYTES], struct orl_bsdf **ret_bsdf,
                struct orl_error *err);
    const atomic_bool *cancel; /* polled while scene text is read; may be NULL */
};

enum { ORL_MISSING_FILES_MAX = 1024 };

struct orl_sources {
    const struct orl_files *files;
    const struct orl_bsdf_loader *loader; /* may be NULL */
    struct orl_arena *arena;
    struct orl_source *items;
    size_t count, room;
    struct orl_missing_file *missing; /* names that were not found, each once */
    size_t n_missing, missing_room;   /* ORL_MISSING_FILES_MAX + 1: the list is incomplete */
    struct orl_sha256 digest;         /* over length and SHA-256 of the content of each file used */
};

void orl_sources_init(struct orl_sources *sources, const struct orl_files *files,
                      const struct orl_bsdf_loader *loader, struct orl_arena *arena);
void orl_sources_done(struct orl_sources *sources);

/* Returns true if a main file is not scene text: a BSDF (.xml). */
bool orl_sources_is_resource(const char *name);

/* Sets the hint for ORL_ERR_NOT_FOUND, for callers that reword the error of the functions below. */
void orl_sources_hint(struct orl_error *err);

/*
 * Finds a file mentioned as name in a file of that folder ("" for none), or else in the user's
 * library. Names that start with '.' or '/' are not searched in the library. ret_index stays valid;
 * pointers to items only until the next call. Returns 0, ORL_ERR_NOT_FOUND, _IO, _LIMIT or _NOMEM.
 */
int orl_sources_find(struct orl_sources *sources, const char *folder, const char *name,
                     size_t *ret_index, struct orl_error *err);

/* orl_sources_find without the library. */
int orl_sources_find_own(struct orl_sources *sources, const char *folder, const char *name,
                         size_t *ret_index, struct orl_error *err);

/* Opens a file by its resolved name: the scene's own, or the library's. */
int orl_sources_open(struct orl_sources *sources, const char *name, bool library, size_t *ret_index,
                     struct orl_error *err);

/* Adds a file to the digest once more, because the caller named it twice. */
void orl_sources_count_again(struct orl_sources *sources, size_t index);

/* Loads the file as a BSDF, each distinct content once. *ret_bsdf is borrowed. */
int orl_sources_bsdf(struct orl_sources *sources, size_t index, struct orl_bsdf **ret_bsdf,
                     struct orl_error *err);

/*
 * Parses the named main files in order (names ending in .xml are resources, not scene text), and
 * all files they refer to. Fills *ret_parsed_scene, which the caller passes to
 * orl_parsed_scene_done, or fails with the place in err.
 */
int orl_scene_parse(const char *const *names, size_t count, const struct orl_files *files,
                    struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err);
/* orl_scene_parse with a loader of BSDFs; NULL: none. */
int orl_scene_parse_with(const char *const *names, size_t count, const struct orl_files *files,
                         const struct orl_bsdf_loader *loader,
                         struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err);
/* orl_scene_parse_with on sources in which some of the main files are open, in their order, and
 * nothing else. Takes over sources and their arena, also on failure. apart: instances with patterns
 * get surfaces of their own, because some will get other materials (orl_material_overrides). */
int orl_scene_parse_opened(const char *const *names, size_t count, struct orl_sources *sources,
                           bool apart, struct orl_parsed_scene *ret_parsed_scene,
                           struct orl_error *err);

#endif
