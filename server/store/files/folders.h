/*
 * The data folder on disk, its blobs, and memory maps of its files:
 *
 *     oriel.db  oriel.lock  blobs/ab/<sha256>  maps/<kind>-<key>.opm  results/<job>/...
 *     partial/<job>/...  oriel.running (crash.h)  tmp/
 *     oriel.id (db.h)  oriel.key (access.h)  oriel.reserve (storage.h)
 *     orphans/<time>/... (removal.h)
 *
 * Files appear in their place by rename, after fsync, so that existing files are complete. tmp/
 * holds files being written; it is emptied when the folder is opened. A lock on oriel.lock allows
 * one daemon at a time.
 * Threads: open and close on one thread; everything else from any (it only reads the struct).
 * Errors: ORL_ERR_IO, ORL_ERR_LIMIT (paths too long), ORL_ERR_INVALID (locked by another).
 */
#ifndef ORL_STORE_FILES_FOLDERS_H
#define ORL_STORE_FILES_FOLDERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

enum { ORL_PATH_MAX = 4096, ORL_ROOT_MAX = 2048, ORL_SHA_HEX = 65 };

struct orl_reservation;

struct orl_folders {
    char root[ORL_ROOT_MAX];
    int lock_fd;
    int64_t start_ms; /* time of opening, ms since 1970: names the orphans' folder */
    struct orl_reservation
        *reservation; /* reservation for a request's files in tmp/ (quota.h), or NULL */
};

int orl_folders_open(struct orl_folders *folders, const char *root, struct orl_error *err);
void orl_folders_close(struct orl_folders *folders);

/* Writes the path "<root>/<format...>". Names made by this program are never truncated. */
void orl_folders_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX],
                      const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Writes a new path below tmp/, for a file or folder that does not exist yet. */
void orl_folders_temporary(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX]);

/* Removes a file, or a folder with its contents. A missing one is no error. */
int orl_remove_tree(const char *path, struct orl_error *err);
/* Syncs a file or a folder by its path. */
int orl_sync_path(const char *path, struct orl_error *err);
/* Renames, then syncs the folder that contains `to`. */
int orl_rename_synced(const char *from, const char *to, struct orl_error *err);
/* Writes all bytes to an open file. Returns false, with errno set, if that fails. */
bool orl_write_all(int fd, const void *data, size_t size);
/* Writes a file and syncs it. Readers, even after a crash, see either the previous file or the
 * whole new one. A running job's results can be read at any moment. */
int orl_write_file(const char *path, const void *data, size_t size, struct orl_error *err);

/* ---- Blobs: content-addressed files --------------------------------------------------------- */

void orl_blob_path(const struct orl_folders *folders, const char *sha, char ret_path[ORL_PATH_MAX]);
bool orl_blob_exists(const struct orl_folders *folders, const char *sha);
/* Syncs the temporary file and moves it to its place, or removes it if the blob exists already. The
 * folders of an existing blob are synced too: the thread that put it there may not have done so
 * yet. */
int orl_blob_store(const struct orl_folders *folders, const char *temporary, const char *sha,
                   struct orl_error *err);
void orl_sha256_hex(const void *data, size_t size, char ret_hex[ORL_SHA_HEX]);
/* Returns true for 64 lower-case hexadecimal digits. */
bool orl_is_sha256(const char *text);

/* Memory maps of stored files. */

/* Maps a whole file read-only; an empty one gives "". Undo it with orl_unmap_file. */
int orl_map_file(const char *path, struct orl_file *ret_file, struct orl_error *err);
void orl_unmap_file(struct orl_file *file);

#endif
