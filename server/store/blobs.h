/*
 * Which blobs are needed, and what they take.
 *
 * A blob stays while a row names it (a file of a scene, a BSDF, a job's document) or a request that
 * is about to write such a row claims it. When the last claim goes, or a row, a blob that is left
 * without either goes too: so nothing stays of an upload that fails at its last step, and nothing
 * goes that another one, of the same bytes, counts on. One whose row has gone stays until that is
 * safe (settling.h). A start sets blobs without a row aside (orphans.h).
 *
 * Threads: the loop thread. A request claims before the pool may keep the file, and lets go after
 * the row is written, or never will be.
 */
#ifndef ORL_SERVER_STORE_BLOBS_H
#define ORL_SERVER_STORE_BLOBS_H

#include <uv.h>

#include "store/bundle.h"
#include "store/db.h"
#include "store/folders.h"
#include "store/settling.h"

struct orl_blobs;

/* Counts those there are, and sets those aside that no row names. Borrows its arguments. */
int orl_blobs_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                   struct orl_settling *settling, struct orl_blobs **ret_blobs,
                   struct orl_error *err);
void orl_blobs_close(struct orl_blobs *blobs); /* NULL is allowed */

int orl_blobs_claim(struct orl_blobs *blobs, const char *sha, struct orl_error *err);
void orl_blobs_release(struct orl_blobs *blobs, const char *sha);
/* Claims on the files of a scene, for as long as somebody reads them: it may be removed, and sent
 * again, meanwhile. All of them or none; a zeroed struct has none. */
struct orl_blob_claims {
    struct orl_blobs *blobs;
    char (*shas)[ORL_SHA_HEX];
    size_t count;
};
int orl_blobs_claim_files(struct orl_blobs *blobs, const struct orl_bundle *files,
                          struct orl_blob_claims *claims, struct orl_error *err);
void orl_blobs_release_files(struct orl_blob_claims *claims);
/* A row that named the blob is gone. */
void orl_blobs_forget(struct orl_blobs *blobs, const char *sha);

/* Of all that are kept. */
uint64_t orl_blobs_bytes(const struct orl_blobs *blobs);

#endif
