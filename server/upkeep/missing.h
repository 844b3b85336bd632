/* Files that the database names and that are not there: logged at start. */
#ifndef ORL_SERVER_UPKEEP_MISSING_H
#define ORL_SERVER_UPKEEP_MISSING_H

#include "process/log.h"
#include "store/db.h"
#include "store/folders.h"

/* Logs how many uploads and results are missing, and the first few by name; their rows stay, for an
 * upload sent again mends them, and files may be put back. One look at each name, none at bytes:
 * those are the scrub's. */
void orl_missing_log(struct orl_db *db, const struct orl_folders *folders,
                     const struct orl_log *log);

#endif
