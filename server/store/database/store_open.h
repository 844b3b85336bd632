/*
 * Opens the database of a data folder and migrates it, after a check that the two belong together.
 * Refused (ORL_ERR_CORRUPT) are
 *
 *   - files of scenes, jobs or maps without a database, or with an empty one: it was lost;
 *   - a database whose id is not the one in the folder's file oriel.id: it is another folder's.
 *
 * In the first case, ORL_LOST_DATABASE_SET_ASIDE starts with a new database: the files, and the
 * rest of the database, move to orphans/ (orphans.h). In the second case it adopts the database;
 * files that this does not know are then orphans.
 *
 * A folder from before ids were introduced gets the id of its database. Copies of a database have
 * its id, so an older backup of the folder's own database is accepted.
 */
#ifndef ORL_STORE_DATABASE_STORE_OPEN_H
#define ORL_STORE_DATABASE_STORE_OPEN_H

#include "store/database/db.h"
#include "store/files/folders.h"

enum orl_lost_database_policy { ORL_LOST_DATABASE_REFUSE, ORL_LOST_DATABASE_SET_ASIDE };

/* Opens and migrates the database of the data folder, which this process has opened and locked. */
int orl_store_open(const struct orl_folders *folders, enum orl_lost_database_policy opening,
                   struct orl_db *ret_db, struct orl_error *err);

#endif
