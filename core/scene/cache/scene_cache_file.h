/*
 * On-disk cache of a parsed scene whose coincident surfaces have been resolved (parsed_scene.h):
 * the scene files are parsed once, and later jobs and tasks map the cache file.
 *
 * The file is a checked file (base/io/checked_file.h). It lists every file that the scene was read
 * from, with the digest of its content, and every name that was not found. It opens only if the
 * caller's files still match. BSDFs are loaded from their own files. Outlines of surfaces are used
 * in place from the mapping; everything else is copied.
 *
 * The result is identical, to the bit, to what the same program would parse from the scene files.
 * Another build may parse them differently, so callers must key the cache by build
 * (orl_program_id_add).
 */
#ifndef ORL_SCENE_CACHE_SCENE_CACHE_FILE_H
#define ORL_SCENE_CACHE_SCENE_CACHE_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/files.h>
#include <oriel/base/sha256.h>

#include "base/io/checked_file.h"
#include "scene/parse/parse.h"
#include "scene/parsed_scene.h"

/* Returns false if there are too many names of missing files to be listed. */
bool orl_parsed_scene_is_cacheable(const struct orl_parsed_scene *parsed_scene);

/* Writes the whole file, not synced. content: the key of the file. Returns 0, ORL_ERR_IO, _FULL or
 * _NOMEM. */
int orl_parsed_scene_save(const struct orl_parsed_scene *parsed_scene,
                          const unsigned char content[ORL_CHECKED_FILE_CONTENT], const char *path,
                          uint64_t *ret_bytes, struct orl_error *err);

/*
 * Fills *ret_parsed_scene, which the caller passes to orl_parsed_scene_done. Returns
 * ORL_ERR_VERSION if scene files have changed or the file has another version; ORL_ERR_CORRUPT,
 * _IO, _NOMEM, or the error of loading a BSDF. The file may be deleted while the parsed scene is in
 * use. sources: as for orl_scene_parse_opened; taken over, also on failure.
 */
int orl_parsed_scene_load(const char *path, const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                          struct orl_sources *sources, struct orl_parsed_scene *ret_parsed_scene,
                          struct orl_error *err);

/*
 * Identity of this build of the program. Cache keys include it if the cached data may depend on all
 * of the program's code.
 */

/* Adds the linker's digest of the program (its note NT_GNU_BUILD_ID). Returns false if there is
 * none. */
bool orl_program_id_add(struct orl_sha256 *hash);

/*
 * Internal to this folder: one traversal of a parsed scene that either writes or reads it.
 */

struct orl_scene_cache_stream {
    struct orl_serializer serializer;
    struct orl_parsed_scene *d; /* not modified when writing */
    /* Only when reading: */
    struct orl_sources sources; /* the scene's files, in the order of the parsed scene */
    struct orl_error *err;      /* errors with more detail than the stream's code */
};

/* cache_surfaces.c: surfaces, and pairs of coincident ones that face opposite ways. */
void orl_cache_surfaces(struct orl_scene_cache_stream *k, struct orl_surface **surfaces, size_t *n);
void orl_cache_opposed(struct orl_scene_cache_stream *k, struct orl_opposed_pair **opposed,
                       size_t *n);

/* cache_patterns.c: all patterns with their functions; call it after orl_cache_grids. */
void orl_cache_patterns(struct orl_scene_cache_stream *k);
/* The pattern that a material or another pattern refers to. */
void orl_cache_pattern(struct orl_scene_cache_stream *k, struct orl_pattern **slot);

/* cache_surfaces.c: all materials; call it after orl_cache_patterns. */
void orl_cache_materials(struct orl_scene_cache_stream *k);

/* cache_patterns.c: all grids that patterns interpolate. */
void orl_cache_grids(struct orl_scene_cache_stream *k);

#endif
