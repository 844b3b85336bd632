/*
 * Removes files without blocking the loop: a rename into tmp/ takes them away at once, and the pool
 * deletes them. Files left there by a crash are removed when tmp/ is emptied.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_STORE_FILES_ASYNC_REMOVE_H
#define ORL_SERVER_STORE_FILES_ASYNC_REMOVE_H

#include <uv.h>

#include "store/durability/wal_sync.h"
#include "store/files/folders.h"

/* Removes a file or a folder, if it exists. Borrows folders until the loop has ended. */
void orl_remove_async(uv_loop_t *loop, const struct orl_folders *folders, const char *path);
/* Removes it later, once all commits so far are safe on disk. So no power cut can bring back a row
 * that names it. If that fails, the file stays for the next start. */
void orl_remove_when_durable(struct orl_wal_sync *wal_sync, uv_loop_t *loop,
                             const struct orl_folders *folders, const char *path);

#endif
