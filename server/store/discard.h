/*
 * Takes files away without keeping the loop waiting: they go from their place at once, by a rename
 * into tmp/, and are removed on the pool. What a crash leaves of them goes when tmp/ is emptied.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_STORE_DISCARD_H
#define ORL_SERVER_STORE_DISCARD_H

#include <uv.h>

#include "store/folders.h"
#include "store/settling.h"

/* A file or a folder; one that is missing is fine. Borrows folders until the loop has run dry. */
void orl_discard(uv_loop_t *loop, const struct orl_folders *folders, const char *path);
/* The same, later: once what has been committed is safe, so that no power cut brings a row back
 * that names it. Where that fails it stays, for the next start. */
void orl_discard_when_safe(struct orl_settling *settling, uv_loop_t *loop,
                           const struct orl_folders *folders, const char *path);

#endif
