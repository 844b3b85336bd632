/*
 * On-disk cache of a settled description (description.h): the scene files are parsed once, and
 * later jobs and tasks map the cache file.
 *
 * The file is a sealed file (base/sealed.h). It lists every file that the scene was read from, with
 * the digest of its content, and every name that was looked for in vain. It opens only if the
 * caller's files still match. BSDFs are loaded from their own files. Outlines of surfaces are used
 * in place from the mapping; everything else is copied.
 *
 * The result is identical, to the bit, to what the same program would parse from the scene files.
 * Another build may parse them differently, so callers must key the cache by build (base/build.h).
 */
#ifndef ORL_SCENE_KEEP_SCENE_BYTES_H
#define ORL_SCENE_KEEP_SCENE_BYTES_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/files.h>

#include "base/sealed.h"
#include "scene/description.h"
#include "scene/parse/sources.h"

/* Returns false if there are too many names looked for in vain to be listed. */
bool orl_description_can_be_kept(const struct orl_description *description);

/* Writes the whole file, not synced. content: the key of the file. Returns 0, ORL_ERR_IO, _FULL or
 * _NOMEM. */
int orl_description_keep(const struct orl_description *description,
                         const unsigned char content[ORL_SEALED_CONTENT], const char *path,
                         uint64_t *ret_bytes, struct orl_error *err);

/*
 * Fills *ret_description, which the caller passes to orl_description_done. Returns ORL_ERR_VERSION
 * if scene files have changed or the file has another version; ORL_ERR_CORRUPT, _IO, _NOMEM, or the
 * error of loading a BSDF. The file may be deleted while the description is in use. sources: as for
 * orl_scene_parse_begun; taken over, also on failure.
 */
int orl_description_open(const char *path, const unsigned char content[ORL_SEALED_CONTENT],
                         struct orl_sources *sources, struct orl_description *ret_description,
                         struct orl_error *err);

#endif
