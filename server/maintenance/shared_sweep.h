/*
 * Removes folders of jobs in parts (runner/slurm_config.h) whose jobs neither wait nor run, and
 * cancels their Slurm tasks. They are left by a killed daemon, or by cancelling a job that waited
 * to continue with its parts. Folders of jobs that the database does not know at the start stay,
 * and are logged: the database may have been lost.
 *
 * Threads: the loop thread; the work itself is on the pool.
 */
#ifndef ORL_SERVER_MAINTENANCE_SHARED_SWEEP_H
#define ORL_SERVER_MAINTENANCE_SHARED_SWEEP_H

#include <stdbool.h>
#include <uv.h>

#include "jobs/jobs.h"
#include "process/log.h"
#include "runner/slurm_config.h"

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
