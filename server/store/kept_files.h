/*
 * Iterates over all files that rows name: blobs, result files, maps. The daemon, maybe in another
 * process, continues meanwhile. So names are collected first, and no transaction stays open. A file
 * that is missing may have been removed since.
 *
 * Threads: one for each database handle.
 */
#ifndef ORL_STORE_KEPT_FILES_H
#define ORL_STORE_KEPT_FILES_H

#include <stdbool.h>

#include "store/db.h"
#include "store/folders.h"

enum orl_kept_kind { ORL_KEPT_BLOB, ORL_KEPT_RESULT, ORL_KEPT_MAP };

struct orl_kept_file {
    enum orl_kept_kind kind;
    char path[ORL_PATH_MAX / 2]; /* relative to the data folder */
    char sha[ORL_SHA_HEX];       /* its digest; "" for maps */
    char job[ORL_SHA_HEX];       /* job of a result file */
    char map_kind[16], map_key[ORL_SHA_HEX];
};

/* Called for each file. The iteration stops at the first visit that does not return 0, and returns
 * that. */
typedef int (*orl_kept_visit)(void *ctx, const struct orl_kept_file *file, struct orl_error *err);
int orl_kept_files(struct orl_db *db, orl_kept_visit visit, void *ctx, struct orl_error *err);

/* Returns true in *ret_named if a row still names the file. */
int orl_kept_is_named(struct orl_db *db, const struct orl_kept_file *file, bool *ret_named,
                      struct orl_error *err);

#endif
