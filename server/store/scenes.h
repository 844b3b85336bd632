/*
 * Rows of scenes and BSDFs. Loop thread only; the files they name are in place already.
 * "Not there" is not an error here: ret_found says so.
 */
#ifndef ORL_STORE_SCENES_H
#define ORL_STORE_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "store/bundle.h"
#include "store/db.h"

struct orl_stored_item {
    int64_t created_ms;
    uint64_t bytes;
    char *summary; /* JSON text, owned; free() */
};

/* One transaction; a scene of that id may exist already, then *ret_created is false. */
int orl_scene_insert(struct orl_db *db, const char *id, const struct orl_bundle *bundle,
                     const char *summary, bool *ret_created, struct orl_error *err);
int orl_scene_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_scene,
                   bool *ret_found, struct orl_error *err);
/* The scene's files, as a bundle over blobs (orl_bundle_done); empty when there is no such scene.
 */
int orl_scene_files(struct orl_db *db, const struct orl_folders *folders, const char *id,
                    struct orl_bundle *ret_bundle, struct orl_error *err);

/*
 * Removes the row and those of its files, whose digests come in ret_blobs (count of them; free()).
 * *ret_removed is false when there is no such scene. A job that waits or runs needs its scene:
 * ORL_ERR_IO.
 */
int orl_scene_drop(struct orl_db *db, const char *id, char (**ret_blobs)[ORL_SHA_HEX],
                   size_t *ret_count, bool *ret_removed, struct orl_error *err);

int orl_bsdf_insert(struct orl_db *db, const char *id, const char *name, uint64_t bytes,
                    const char *summary, bool *ret_created, struct orl_error *err);
int orl_bsdf_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_bsdf,
                  bool *ret_found, struct orl_error *err);
/* Removes the row; one that scenes have as a file is not to be removed: ORL_ERR_IO. */
int orl_bsdf_drop(struct orl_db *db, const char *id, bool *ret_removed, struct orl_error *err);

/* Does a scene, a BSDF or a job name the blob? Is it a file of a scene? */
int orl_blob_is_named(struct orl_db *db, const char *sha, bool *ret_named, struct orl_error *err);
int orl_blob_in_scene(struct orl_db *db, const char *sha, bool *ret_named, struct orl_error *err);

#endif
