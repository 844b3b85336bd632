/*
 * Brings a database to the present schema.
 *
 * Migrations are numbered from 1 without gaps, append-only, each run in one transaction together
 * with the row that records its number and digest. A database with a later number than we know is
 * refused (ORL_ERR_VERSION), as is one whose recorded digest differs from ours (ORL_ERR_CORRUPT):
 * a migration that has been applied somewhere may never be edited.
 *
 * Before the first one that is new to a database, a copy of that is left beside it, as
 * <path>.before-<number>: to go back to an earlier Oriel, put it in its place.
 */
#ifndef ORL_STORE_MIGRATE_H
#define ORL_STORE_MIGRATE_H

#include <stddef.h>

#include "store/db.h"

struct orl_migration {
    const char *name; /* "0001_initial.sql"; the digits are its number */
    const char *sql;
};

/* Applies those of list (sorted by number) that the database lacks. */
int orl_db_migrate(struct orl_db *db, const struct orl_migration *list, size_t count,
                   struct orl_error *err);

/* Applies the migrations the daemon carries. ORL_ERR_CORRUPT: all are applied, but a table or a
 * column that they make is missing. */
int orl_db_migrate_embedded(struct orl_db *db, struct orl_error *err);

#endif
