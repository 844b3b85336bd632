/*
 * Computations: which job leads one, who follows it, when it starts, and what becomes of all of
 * them when it ends. Inside of jobs.h, whose rules hold.
 */
#ifndef ORL_SERVER_JOBS_JOB_RUNS_H
#define ORL_SERVER_JOBS_JOB_RUNS_H

#include "jobs/jobs.h"

enum { ORL_JOBS_BUCKETS = 4096 };

struct orl_jobs {
    struct orl_jobs_env env;
    struct orl_jobs_job *newest, *oldest;
    struct orl_queue *queue;
    struct orl_jobs_job *leaders; /* that wait or run */
    uint32_t n_workers;
    bool alone;                                 /* what runs is to have nothing beside it */
    const struct orl_jobs_job *short_of_memory; /* the next, when that is what it waits for */
    struct orl_jobs_job *buckets[ORL_JOBS_BUCKETS];
    size_t counts[ORL_JOB_STATE_COUNT];
    uint64_t result_bytes;   /* of the results that are kept */
    uint64_t expected_bytes; /* of the results of jobs that wait or run */
    size_t n_unsaved;        /* jobs whose rows could not be written, or are about to be */
    bool batch;              /* rows wait for the end of what goes on */
    struct orl_settling_wait settling; /* of rows of jobs that have ended; used while: */
    bool settles;
    bool stopping, held; /* none starts */
};

/* ---- jobs.c --------------------------------------------------------------------------------- */

/* orl_jobs_find, for those who may change it. */
struct orl_jobs_job *orl_jobs_lookup(const struct orl_jobs *jobs, const char *id);
/* Removes jobs that have ended, their rows in one transaction. */
void orl_jobs_remove_ended(struct orl_jobs *jobs, struct orl_jobs_job *const *ended, size_t count);

/* ---- job_rows.c ----------------------------------------------------------------------------- */

/* Whether the row says what is known in memory. */
void orl_job_note_saved(struct orl_jobs_job *job, bool saved);

/*
 * Writes the row, then changes the state in memory. When the database refuses, the change in memory
 * is made all the same: the job has run or not, whatever the disk says; the log tells, and the row
 * is tried again by orl_jobs_save.
 */
void orl_jobs_set_state(struct orl_jobs_job *job, enum orl_job_state state);
void orl_jobs_fail(struct orl_jobs_job *job, const struct orl_error *err);
/* Has what is written made safe soon, though nobody asks. */
void orl_jobs_settle(struct orl_jobs *jobs);
/* Between the two, in one turn of the loop, rows are gathered, and written in one transaction. */
void orl_jobs_batch_begin(struct orl_jobs *jobs);
void orl_jobs_batch_end(struct orl_jobs *jobs);

/* ---- job_runs.c ----------------------------------------------------------------------------- */

/* What became of its parts since it was called last, into the log. */
void orl_runs_log_parts(const struct orl_jobs_job *job);
/* A queued job leads or follows; one for which there is no memory fails. */
void orl_runs_enqueue(struct orl_jobs_job *job);
/* Takes a leader off the list of those that wait or run. */
void orl_runs_lead_no_more(struct orl_jobs_job *job);
/* It waits no more: what it wanted memory for is nobody's. */
void orl_runs_want_no_memory(const struct orl_jobs_job *job);
/* Starts as many as may run. */
void orl_runs_start_next(struct orl_jobs *jobs);

#endif
