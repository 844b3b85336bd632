/*
 * Removal of what is old or unused: orphans by the retention clock, and shared folders of jobs in
 * parts.
 */
#ifndef ORL_SERVER_MAINTENANCE_RETENTION_H
#define ORL_SERVER_MAINTENANCE_RETENTION_H

#include <stdbool.h>
#include <uv.h>

#include "jobs/jobs.h"
#include "process/log.h"
#include "runner/runner.h"
#include "store/files/folders.h"
#include "store/files/removal.h"

/*
 * Retention in a data folder: the retention clock, and the removal of old orphans.
 *
 * Threads: the loop thread.
 */

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

/*
 * Removes folders of jobs in parts (runner/runner.h) whose jobs neither wait nor run, and cancels
 * their Slurm tasks. They are left by a killed daemon, or by cancelling a job that waited to
 * continue with its parts. Folders of jobs that the database does not know at the start stay, and
 * are logged: the database may have been lost.
 *
 * Threads: the loop thread; the work itself is on the pool.
 */

struct orl_shared_sweep {
    uv_work_t work;
    const struct orl_slurm_config *slurm; /* NULL: no shared folder */
    const struct orl_jobs *jobs;
    const struct orl_log *log;
    bool wanted; /* a job has ended since the last search */
    bool busy;
    char folder[ORL_PATH_MAX]; /* folder being swept */
    int rc;
    struct orl_error err;
    bool searched_unknown;       /* true once folders of unknown jobs were searched */
    char (*unknown)[ORL_JOB_ID]; /* ids of these jobs, owned */
    size_t n_unknown;
};

/* Sweeps one folder, if there is any. Called periodically. */
void orl_shared_sweep_step(struct orl_shared_sweep *sweep, uv_loop_t *loop);
void orl_shared_sweep_done(struct orl_shared_sweep *sweep);

#endif
