/*
 * Rows of scenes and BSDFs. Loop thread only; the files they name must be in place already. A
 * missing row is no error: *ret_found is then false.
 */
#ifndef ORL_STORE_ROWS_SCENES_H
#define ORL_STORE_ROWS_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "store/database/db.h"
#include "store/files/scene_bundle.h"

struct orl_stored_item {
    int64_t created_ms;
    uint64_t bytes;
    char *summary; /* JSON text, owned; free() */
};

/* Inserts a scene in one transaction. *ret_created is false if a scene of that id exists. */
int orl_scene_insert(struct orl_db *db, const char *id, const struct orl_bundle *bundle,
                     const char *summary, bool *ret_created, struct orl_error *err);
int orl_scene_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_scene,
                   bool *ret_found, struct orl_error *err);
/* Returns the scene's files as a bundle over blobs (orl_bundle_done); empty if there is no such
 * scene. */
int orl_scene_files(struct orl_db *db, const struct orl_folders *folders, const char *id,
                    struct orl_bundle *ret_bundle, struct orl_error *err);

/*
 * Removes the row and those of its files. Their digests are returned in ret_blobs (*ret_count of
 * them; free()). *ret_removed is false if there is no such scene. ORL_ERR_IO if a job that waits or
 * runs needs the scene.
 */
int orl_scene_drop(struct orl_db *db, const char *id, char (**ret_blobs)[ORL_SHA_HEX],
                   size_t *ret_count, bool *ret_removed, struct orl_error *err);

int orl_bsdf_insert(struct orl_db *db, const char *id, const char *name, uint64_t bytes,
                    const char *summary, bool *ret_created, struct orl_error *err);
int orl_bsdf_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_bsdf,
                  bool *ret_found, struct orl_error *err);
/* Removes the row. ORL_ERR_IO if scenes have the BSDF as a file. */
int orl_bsdf_drop(struct orl_db *db, const char *id, bool *ret_removed, struct orl_error *err);

/* is_named: true if a scene, a BSDF or a job names the blob. in_scene: true if it is a file of a
 * scene. */
int orl_blob_is_referenced(struct orl_db *db, const char *sha, bool *ret_named,
                           struct orl_error *err);
int orl_blob_in_scene(struct orl_db *db, const char *sha, bool *ret_named, struct orl_error *err);

#endif
