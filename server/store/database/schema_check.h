/*
 * Checks that a database has all tables and columns that the migrations make. A database that
 * another program has changed may list every migration and lack some of them.
 */
#ifndef ORL_STORE_DATABASE_SCHEMA_CHECK_H
#define ORL_STORE_DATABASE_SCHEMA_CHECK_H

#include "store/database/db.h"

/* Compares db with wanted, a database that the migrations have just made. ORL_ERR_CORRUPT: db lacks
 * a table or column of it. */
int orl_schema_check(struct orl_db *db, struct orl_db *wanted, struct orl_error *err);

#endif
