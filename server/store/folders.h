/*
 * The data folder on disk:
 *
 *     oriel.db  oriel.lock  blobs/ab/<sha256>  maps/<kind>-<key>.opm  results/<job>/...
 *     partial/<job>/...  oriel.running (blame.h)  tmp/
 *     oriel.id (opening.h)  oriel.key (link_key.h)  oriel.reserve (disk_room.h)  orphans/<time>/...
 * (orphans.h)
 *
 * Files appear in their place by rename, after fsync, so that what is there is complete. tmp/
 * holds what is being written; it is emptied when the folder is opened. One daemon at a time: a
 * lock on oriel.lock.
 * Threads: open and close on one thread; everything else from any (it only reads the struct).
 * Errors: ORL_ERR_IO, ORL_ERR_LIMIT (paths too long), ORL_ERR_INVALID (locked by another).
 */
#ifndef ORL_STORE_FOLDERS_H
#define ORL_STORE_FOLDERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_PATH_MAX = 4096, ORL_ROOT_MAX = 2048, ORL_SHA_HEX = 65 };

struct orl_hold;

struct orl_folders {
    char root[ORL_ROOT_MAX];
    int lock_fd;
    int64_t start_ms;      /* when it was opened: names what this start sets aside (orphans.h) */
    struct orl_hold *hold; /* of what is written to tmp/ on behalf of a request (hold.h), or NULL */
};

int orl_folders_open(struct orl_folders *folders, const char *root, struct orl_error *err);
void orl_folders_close(struct orl_folders *folders);

/* "<root>/<format...>". Truncation cannot happen for names this program makes. */
void orl_folders_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX],
                      const char *format, ...) __attribute__((format(printf, 3, 4)));
/* A fresh path below tmp/, for a file or folder that does not exist yet. */
void orl_folders_temporary(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX]);

/* Removes a file, or a folder with all in it. Missing is fine. */
int orl_remove_tree(const char *path, struct orl_error *err);
/* fsync of a file or a folder by its path. */
int orl_sync_path(const char *path, struct orl_error *err);
/* rename, then fsync of the folder that holds to. */
int orl_rename_synced(const char *from, const char *to, struct orl_error *err);
/* Writes a file and syncs it. Whoever reads it meanwhile, and whatever happens, it is the one that
 * was there before, or all of the new one: a running job's results are asked for at any moment. */
int orl_write_file(const char *path, const void *data, size_t size, struct orl_error *err);

/* ---- Blobs: content-addressed files --------------------------------------------------------- */

void orl_blob_path(const struct orl_folders *folders, const char *sha, char ret_path[ORL_PATH_MAX]);
bool orl_blob_exists(const struct orl_folders *folders, const char *sha);
/* Syncs the temporary file and moves it to its place; removes it when the blob is there already,
 * whose folders are synced all the same: whoever puts it there may not have come to that yet. */
int orl_blob_keep(const struct orl_folders *folders, const char *temporary, const char *sha,
                  struct orl_error *err);
void orl_sha256_hex(const void *data, size_t size, char ret_hex[ORL_SHA_HEX]);
/* 64 lower-case hexadecimal digits? */
bool orl_is_sha256(const char *text);

#endif
