/*
 * A description that is settled (description.h), in a file: what takes long to read is read once,
 * and from there by every job and part after that.
 *
 * A sealed file (base/sealed.h). It names every file that the scene was read from, with the digest
 * of its content, and every name under which a file was looked for in vain: it is opened only while
 * the caller's files are these. BSDFs are loaded from their own. Outlines of surfaces stay where
 * they are in the file; all else is copied.
 *
 * What comes of it is the same, to the bit, as what the files would give to the program that wrote
 * it. Another build may read them otherwise: whoever keeps such files tells builds apart
 * (base/build.h).
 */
#ifndef ORL_SCENE_KEEP_KEEP_H
#define ORL_SCENE_KEEP_KEEP_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/files.h>

#include "base/sealed.h"
#include "scene/description.h"
#include "scene/parse/sources.h"

/* False: names that were looked for in vain are too many to be listed. */
bool orl_description_can_be_kept(const struct orl_description *description);

/* Writes the whole file, not synced. content: what it is to go by. ORL_ERR_IO, _FULL, _NOMEM. */
int orl_description_keep(const struct orl_description *description,
                         const unsigned char content[ORL_SEALED_CONTENT], const char *path,
                         uint64_t *ret_bytes, struct orl_error *err);

/*
 * Fills *ret_description, which the caller passes to orl_description_done. ORL_ERR_VERSION: files
 * are not as they were then, or it is of another version; ORL_ERR_CORRUPT, _IO, _NOMEM, and what
 * loading a BSDF gives. The file may go while the description is in use. sources: as
 * orl_scene_parse_begun has them; they are taken over, also on failure.
 */
int orl_description_open(const char *path, const unsigned char content[ORL_SEALED_CONTENT],
                         struct orl_sources *sources, struct orl_description *ret_description,
                         struct orl_error *err);

#endif
