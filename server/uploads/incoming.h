/*
 * A file being received: written to tmp/ and hashed as data arrives, bounded by
 * ORL_LIMIT_FILE_BYTES, entered into a bundle as a temporary file.
 * Threads: one at a time. Errors: ORL_ERR_IO, ORL_ERR_LIMIT, and those of orl_bundle_add.
 */
#ifndef ORL_SERVER_UPLOADS_INCOMING_H
#define ORL_SERVER_UPLOADS_INCOMING_H

#include <oriel/base/sha256.h>

#include "http/quota/quota.h"
#include "store/files/scene_bundle.h"

/* Callbacks that receive the files in place of tmp/. */
struct orl_incoming_sink {
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
};

struct orl_incoming {
    struct orl_bundle *bundle;            /* borrowed; its last file is the current one */
    const struct orl_incoming_sink *sink; /* borrowed; NULL: tmp/ */
    struct orl_reservation *reservation;  /* borrowed; bounds the bytes on disk; NULL: no bound */
    int fd;                               /* -1: no file is open */
    struct orl_sha256 hash;
};

void orl_incoming_init(struct orl_incoming *incoming, struct orl_bundle *bundle);

/* Enters a file; the previous one must have ended. A file that goes to a sink has neither path nor
 * digest in the bundle; folders may then be NULL. */
int orl_incoming_begin(struct orl_incoming *incoming, const struct orl_folders *folders,
                       const char *name, bool resource, struct orl_error *err);
int orl_incoming_append(struct orl_incoming *incoming, const char *data, size_t size,
                        struct orl_error *err);
/* Closes the current file, if any, and records its digest. Call it after an error too. */
void orl_incoming_end(struct orl_incoming *incoming);

#endif
