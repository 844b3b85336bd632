/*
 * A file of an upload on its way in: written to tmp/ and hashed as it comes, bounded by
 * ORL_LIMIT_FILE_BYTES, entered into a bundle as a temporary file.
 * Threads: one at a time. Errors: ORL_ERR_IO, ORL_ERR_LIMIT, and those of orl_bundle_add.
 */
#ifndef ORL_SERVER_UPLOADS_INCOMING_H
#define ORL_SERVER_UPLOADS_INCOMING_H

#include <oriel/sha256.h>

#include "http/hold.h"
#include "store/bundle.h"

/* Where files go instead of tmp/: to whoever keeps them. */
struct orl_incoming_sink {
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
};

struct orl_incoming {
    struct orl_bundle *bundle;            /* borrowed; its last file is the one under way */
    const struct orl_incoming_sink *sink; /* borrowed; NULL: tmp/ */
    struct orl_hold *hold;                /* borrowed: of what is written; NULL: no bound */
    int fd;                               /* -1: none is */
    struct orl_sha256 hash;
};

void orl_incoming_init(struct orl_incoming *incoming, struct orl_bundle *bundle);

/* Enters the file; the one before must have ended. Of one that goes to a sink the bundle knows
 * neither path nor digest; folders may be NULL then. */
int orl_incoming_begin(struct orl_incoming *incoming, const struct orl_folders *folders,
                       const char *name, bool resource, struct orl_error *err);
int orl_incoming_append(struct orl_incoming *incoming, const char *data, size_t size,
                        struct orl_error *err);
/* Closes the file under way, if any, and notes its digest. Also after an error. */
void orl_incoming_end(struct orl_incoming *incoming);

#endif
