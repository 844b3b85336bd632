/*
 * Reference counts of blobs, and their total size.
 *
 * A blob stays while a row names it: a file of a scene, a BSDF, a job's document. It also stays
 * while a request that is about to write such a row claims it. When the last claim or row goes, a
 * blob without either is removed. So a failed upload leaves no blobs, and no blob is removed that
 * another upload of identical bytes needs. If its row was deleted, the blob stays until that is
 * safe on disk (wal.h). A start sets blobs without a row aside (removal.h).
 *
 * Threads: the loop thread. A request claims before the pool may store the file, and releases after
 * the row is written, or has failed for good.
 */
#ifndef ORL_SERVER_STORE_FILES_BLOBS_H
#define ORL_SERVER_STORE_FILES_BLOBS_H

#include <uv.h>

#include "store/database/db.h"
#include "store/durability/wal.h"
#include "store/files/folders.h"
#include "store/files/scene_bundle.h"

struct orl_blobs;

/* Counts the blobs, and sets aside those that no row names. Borrows its arguments. */
int orl_blobs_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                   struct orl_wal_sync *wal_sync, struct orl_blobs **ret_blobs,
                   struct orl_error *err);
void orl_blobs_close(struct orl_blobs *blobs); /* NULL is allowed */

int orl_blobs_claim(struct orl_blobs *blobs, const char *sha, struct orl_error *err);
void orl_blobs_release(struct orl_blobs *blobs, const char *sha);
/* Claims on the files of a scene while they are read, since the scene may be removed and uploaded
 * again meanwhile. Either all files are claimed or none; a zeroed struct has no claims. */
struct orl_blob_claims {
    struct orl_blobs *blobs;
    char (*shas)[ORL_SHA_HEX];
    size_t count;
};
int orl_blobs_claim_files(struct orl_blobs *blobs, const struct orl_bundle *files,
                          struct orl_blob_claims *claims, struct orl_error *err);
void orl_blobs_release_files(struct orl_blob_claims *claims);
/* Removes the blob if nothing else needs it. Call it after a row that named the blob is deleted. */
void orl_blobs_remove_unused(struct orl_blobs *blobs, const char *sha);

/* Returns the total bytes of the stored blobs. */
uint64_t orl_blobs_bytes(const struct orl_blobs *blobs);

#endif
