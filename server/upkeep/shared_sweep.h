/*
 * Folders of jobs in parts (runner/shared_place.h) whose jobs wait or run no more: what Slurm has
 * of them is ended, and they go. They are left where a daemon was killed, or a job cancelled that
 * waited to go on with its parts. Folders of jobs that the database does not know when the daemon
 * starts stay, and are logged: they may be those of a database that was lost.
 *
 * Threads: the loop thread; the work itself is on the pool.
 */
#ifndef ORL_SERVER_UPKEEP_SHARED_SWEEP_H
#define ORL_SERVER_UPKEEP_SHARED_SWEEP_H

#include <stdbool.h>
#include <uv.h>

#include "jobs/jobs.h"
#include "process/log.h"
#include "runner/shared_place.h"

struct orl_shared_sweep {
    uv_work_t work;
    const struct orl_shared_place *place; /* NULL: there are none */
    const struct orl_jobs *jobs;
    const struct orl_log *log;
    bool wanted; /* a job has ended since the last that was found */
    bool busy;
    char folder[ORL_PATH_MAX]; /* that is being swept */
    int rc;
    struct orl_error err;
    bool looked;                 /* for folders of unknown jobs */
    char (*unknown)[ORL_JOB_ID]; /* jobs of those, owned */
    size_t n_unknown;
};

/* To be called now and then: sweeps one, if there is any. */
void orl_shared_sweep_look(struct orl_shared_sweep *sweep, uv_loop_t *loop);
void orl_shared_sweep_done(struct orl_shared_sweep *sweep);

#endif
