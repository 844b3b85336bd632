/*
 * Writes and reads files for commands and parts. Results appear whole or not at all: written to
 * a temporary name beside the target, synced, then renamed. So no script reads half a
 * result.json. Devices and pipes, such as /dev/stdout, are written in place.
 */
#ifndef ORL_API_DISTRIBUTED_ATOMIC_FILES_H
#define ORL_API_DISTRIBUTED_ATOMIC_FILES_H

#include <dirent.h>
#include <jansson.h>
#include <stdio.h>

#include <oriel/base/error.h>
#include <oriel/base/sha256.h>

struct orl_atomic_file {
    FILE *stream;
    char target[4096], temporary[4096]; /* temporary is "" if written in place */
};

/* After open, call exactly one of commit and abandon. If commit fails, it has abandoned the
 * file. */
int orl_atomic_file_open(struct orl_atomic_file *ret_file, const char *target,
                         struct orl_error *err);
int orl_atomic_file_commit(struct orl_atomic_file *file, struct orl_error *err);
void orl_atomic_file_abandon(struct orl_atomic_file *file);

/* Opens a regular file and returns its size. */
int orl_open_for_reading(const char *path, FILE **ret_stream, long long *ret_size,
                         struct orl_error *err);

int orl_open_folder(const char *path, DIR **ret_entries, struct orl_error *err);

/* Creates the folder and its parents, like `mkdir -p`. */
int orl_make_folder(const char *path, struct orl_error *err);

/* Removes a folder with its contents; of symbolic links only the link. */
void orl_remove_folder(const char *folder);

/* Joins folder/name into ret_path[size]; an absolute name is returned as it is. */
int orl_join_path(const char *folder, const char *name, char *ret_path, size_t size,
                  struct orl_error *err);

/* Writes a text through orl_atomic_file. */
int orl_write_text(const char *path, const char *text, size_t size, struct orl_error *err);

/* Writes a JSON document, indented, through orl_atomic_file. NULL: ORL_ERR_NOMEM. */
int orl_write_json(const char *path, const json_t *json, struct orl_error *err);

/* SHA-256 digests of files, in hexadecimal. */

enum { ORL_DIGEST_TEXT = 65 };

/* Ends hash and returns its digest as text. */
void orl_digest_end(struct orl_sha256 *hash, char ret_digest[ORL_DIGEST_TEXT]);

/* Computes the digest of a file's bytes. */
int orl_digest_file(const char *path, char ret_digest[ORL_DIGEST_TEXT], struct orl_error *err);

#endif
