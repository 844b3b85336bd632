/*
 * All files that rows name: blobs, files of results, maps. For whoever goes through them while the
 * daemon, maybe another process, goes on: names are gathered first, so that no transaction stays
 * open, and a file that is not there any more may have been removed since.
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
    char path[ORL_PATH_MAX / 2]; /* below the data folder */
    char sha[ORL_SHA_HEX];       /* its digest; of maps "" */
    char job[ORL_SHA_HEX];       /* whose result it is */
    char map_kind[16], map_key[ORL_SHA_HEX];
};

/* Stops at the first visit that does not return 0, and returns that. */
typedef int (*orl_kept_visit)(void *ctx, const struct orl_kept_file *file, struct orl_error *err);
int orl_kept_files(struct orl_db *db, orl_kept_visit visit, void *ctx, struct orl_error *err);

/* Does a row still name it? */
int orl_kept_is_named(struct orl_db *db, const struct orl_kept_file *file, bool *ret_named,
                      struct orl_error *err);

#endif
