/*
 * Migrates a database to the current schema.
 *
 * Migrations are numbered from 1 without gaps, append-only, each run in one transaction together
 * with the row that records its number and digest. A database with a later number than the
 * program's is refused (ORL_ERR_VERSION). So is one with a different recorded digest
 * (ORL_ERR_CORRUPT): a migration that has been applied somewhere may never be edited.
 *
 * Before the first new migration, a copy of the database is left beside it, as
 * <path>.before-<number>. To go back to an earlier Oriel, put the copy in its place.
 */
#ifndef ORL_STORE_DATABASE_MIGRATE_H
#define ORL_STORE_DATABASE_MIGRATE_H

#include <stddef.h>

#include "store/database/db.h"

struct orl_migration {
    const char *name; /* "0001_initial.sql"; the digits are its number */
    const char *sql;
};

/* Applies the migrations of list (sorted by number) that the database lacks. */
int orl_db_migrate(struct orl_db *db, const struct orl_migration *list, size_t count,
                   struct orl_error *err);

/* Applies the migrations embedded in the daemon. ORL_ERR_CORRUPT: all are applied, but a table or a
 * column that they make is missing. */
int orl_db_migrate_embedded(struct orl_db *db, struct orl_error *err);

#endif
