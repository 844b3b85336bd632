/* A check at the start for files that the database names but that do not exist. */
#ifndef ORL_SERVER_MAINTENANCE_MISSING_FILES_H
#define ORL_SERVER_MAINTENANCE_MISSING_FILES_H

#include "process/log.h"
#include "store/database/db.h"
#include "store/files/folders.h"

/* Logs how many uploads and results are missing, and the first few names. Their rows stay: sending
 * an upload again repairs it, and files may be restored. It checks only that files exist; the scrub
 * checks their bytes. */
void orl_missing_files_log(struct orl_db *db, const struct orl_folders *folders,
                           const struct orl_log *log);

#endif
