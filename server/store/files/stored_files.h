/* The files that rows name, and a cache of the result files whose bytes were verified. */
#ifndef ORL_STORE_FILES_STORED_FILES_H
#define ORL_STORE_FILES_STORED_FILES_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include <oriel/base/error.h>
#include <sys/stat.h>

#include "store/database/db.h"
#include "store/files/folders.h"

/*
 * Iterates over all files that rows name: blobs, result files, maps. The daemon, maybe in another
 * process, continues meanwhile. So names are collected first, and no transaction stays open. A file
 * that is missing may have been removed since.
 *
 * Threads: one for each database handle.
 */

enum orl_stored_file_kind { ORL_STORED_FILE_BLOB, ORL_STORED_FILE_RESULT, ORL_STORED_FILE_MAP };

struct orl_stored_file {
    enum orl_stored_file_kind kind;
    char path[ORL_PATH_MAX / 2]; /* relative to the data folder */
    char sha[ORL_SHA_HEX];       /* its digest; "" for maps */
    char job[ORL_SHA_HEX];       /* job of a result file */
    char map_kind[16], map_key[ORL_SHA_HEX];
};

/* Called for each file. The iteration stops at the first visit that does not return 0, and returns
 * that. */
typedef int (*orl_stored_file_visit)(void *ctx, const struct orl_stored_file *file,
                                     struct orl_error *err);
int orl_stored_files_visit(struct orl_db *db, orl_stored_file_visit visit, void *ctx,
                           struct orl_error *err);

/* Returns true in *ret_named if a row still names the file. */
int orl_stored_file_is_referenced(struct orl_db *db, const struct orl_stored_file *file,
                                  bool *ret_named, struct orl_error *err);

/*
 * A cache of result files that are known to hold the bytes that were written. A file's digest is
 * checked when it is first served after a start, and again if it has changed since (st_ctime, which
 * every write changes). The cache holds ORL_VERIFIED_FILES files; others are checked again.
 *
 * Threads: the loop thread, except orl_verify_file, which any thread may call.
 */

enum { ORL_VERIFIED_FILES = 4096 };

struct orl_verified_files {
    struct orl_verified_file {
        dev_t device;
        ino_t inode; /* 0: none */
        off_t size;
        struct timespec changed;
    } files[ORL_VERIFIED_FILES];
};

bool orl_verified_files_has(const struct orl_verified_files *verified, const struct stat *st);
void orl_verified_files_add(struct orl_verified_files *verified, const struct stat *st);

/* Reads the file. ORL_ERR_CORRUPT if its bytes do not have that digest. */
int orl_verify_file(int fd, const char sha[ORL_SHA_HEX], struct orl_error *err);

#endif
