/*
 * Computations and the list of jobs: leaders and followers, rows, limits in time, and the BSDFs
 * that jobs make. Internal to jobs.h; its rules apply.
 */
#ifndef ORL_SERVER_JOBS_JOB_RUNS_H
#define ORL_SERVER_JOBS_JOB_RUNS_H

#include "jobs/jobs.h"

enum { ORL_JOBS_BUCKETS = 4096 };

struct orl_jobs {
    struct orl_jobs_env env;
    struct orl_jobs_job *newest, *oldest;
    struct orl_queue *queue;
    struct orl_jobs_job *leaders; /* leaders that wait or run */
    uint32_t n_workers;
    bool alone; /* no other job may start beside the running one */
    const struct orl_jobs_job *waiting_for_memory; /* the next job, if it waits for memory */
    struct orl_jobs_job *buckets[ORL_JOBS_BUCKETS];
    size_t counts[ORL_JOB_STATE_COUNT];
    uint64_t result_bytes;   /* size of stored results */
    uint64_t expected_bytes; /* expected size of results of jobs that wait or run */
    size_t n_unsaved;        /* jobs whose rows could not be written, or are about to be */
    bool batch;              /* true while rows are gathered for one transaction */
    struct orl_wal_sync_wait sync_wait; /* wait for ended jobs' rows, if sync_pending is true */
    bool sync_pending;
    bool stopping, paused; /* stopping or paused: no job starts */
};

/* ---- jobs.c --------------------------------------------------------------------------------- */

/* Like orl_jobs_find, for functions that change the job. */
struct orl_jobs_job *orl_jobs_lookup(const struct orl_jobs *jobs, const char *id);
/*
 * Enforces the limits in time: how long a job may run, and how long and how many ended jobs are
 * kept. Called about every second. Logs news of jobs' parts, and stops jobs that run too long.
 * Removes the oldest ended jobs that are too many or too old, a few at a time. Results that were
 * not fetched yet are spared, as from eviction (storage.h).
 */
void orl_jobs_enforce_limits(struct orl_jobs *jobs);

/* ---- job_rows.c ----------------------------------------------------------------------------- */

/* Records if the row in the database equals the one in memory. */
void orl_job_note_saved(struct orl_jobs_job *job, bool saved);

/*
 * Changes the state in memory and writes the row. If the database refuses, the state in memory
 * still changes, since the job has run or not, whatever the disk does. The failure is logged, and
 * orl_jobs_save tries the row again.
 */
void orl_jobs_set_state(struct orl_jobs_job *job, enum orl_job_state state);
void orl_jobs_fail(struct orl_jobs_job *job, const struct orl_error *err);
/* Requests that written rows become safe on disk soon, though no client waits for it. */
void orl_jobs_request_sync(struct orl_jobs *jobs);
/* Between begin and end, in one turn of the loop, rows are gathered and then written in one
 * transaction. */
void orl_jobs_batch_begin(struct orl_jobs *jobs);
void orl_jobs_batch_end(struct orl_jobs *jobs);

/* ---- job_runs.c ----------------------------------------------------------------------------- */

/* Logs news of the job's parts since the last call. */
void orl_runs_log_parts(const struct orl_jobs_job *job);
/* Makes a queued job a leader or a follower; fails it if there is no memory. */
void orl_runs_enqueue(struct orl_jobs_job *job);
/* Removes a leader from the list of those that wait or run. */
void orl_runs_remove_leader(struct orl_jobs_job *job);
/* The job left the queue: clears the record of the memory it waited for. */
void orl_runs_end_memory_wait(const struct orl_jobs_job *job);
/* Starts as many jobs as may run. */
void orl_runs_start_next(struct orl_jobs *jobs);

/* ---- job_list.c ------------------------------------------------------------------------------ */

/*
 * The list of jobs: by age, by id, and counts by state. The file also has the functions of jobs.h
 * that only read jobs.
 */

/* Adds a job as the newest one. */
void orl_job_list_add(struct orl_jobs *jobs, struct orl_jobs_job *job);
void orl_job_list_remove(struct orl_jobs *jobs, struct orl_jobs_job *job);

/* Gives the job copies of name and tags (NULL: none). ORL_ERR_NOMEM. */
int orl_job_set_labels(struct orl_jobs_job *job, const char *name, const char *tags);

/* Frees a job that is not in the list; NULL is allowed. */
void orl_job_free(struct orl_jobs_job *job);

#endif
