/*
 * Aging of a data folder: the retention clock, and the removal of old orphans.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_MAINTENANCE_RETENTION_H
#define ORL_SERVER_MAINTENANCE_RETENTION_H

#include <uv.h>

#include "process/log.h"
#include "store/files/folders.h"
#include "store/rows/retention_clock.h"

struct orl_retention {
    struct orl_retention_clock clock;
    const struct orl_folders *folders;
    const struct orl_log *log;
    uint32_t keep_orphans_days;
    int64_t purged_ms; /* retention time of the last purge of orphans; 0: none yet */
};

/* Opens the clock. Call it with a migrated database, before any search for orphans. Borrows its
 * arguments. */
int orl_retention_open(struct orl_retention *retention, struct orl_db *db,
                       struct orl_folders *folders, const struct orl_log *log,
                       uint32_t keep_orphans_days, struct orl_error *err);
/* Logs the orphans of this start. Call it once everything that looks for orphans has started. */
void orl_retention_log_orphans(const struct orl_retention *retention);
/* Saves the clock and purges orphans when due. Called about every second. */
void orl_retention_tick(struct orl_retention *retention, uv_loop_t *loop);
void orl_retention_close(struct orl_retention *retention); /* a zeroed struct is allowed */

#endif
