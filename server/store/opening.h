/*
 * Opens the database of a data folder, after a look at whether the two belong together, and brings
 * it to the present schema. Refused (ORL_ERR_CORRUPT) are
 *
 *   - files of scenes, jobs or maps without a database, or with an empty one: it was lost;
 *   - a database whose id is not the one in the folder's file oriel.id: it is another folder's.
 *
 * ORL_OPENING_SET_ASIDE begins anew in the first case: the files move to orphans/ (orphans.h), with
 * what there is of the database. In the second it adopts the database; files that this does not
 * know are then orphans like any.
 *
 * A folder from before ids were introduced gets the id of its database. Copies of a
 * database have its id: an older backup of the same folder's is accepted.
 */
#ifndef ORL_STORE_OPENING_H
#define ORL_STORE_OPENING_H

#include "store/db.h"
#include "store/folders.h"

enum orl_opening { ORL_OPENING_REFUSE, ORL_OPENING_SET_ASIDE };

/* Opens and migrates the database of the data folder, which is open and locked by this process. */
int orl_opening_database(const struct orl_folders *folders, enum orl_opening opening,
                         struct orl_db *ret_db, struct orl_error *err);

#endif
