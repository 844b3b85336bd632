/*
 * The results of jobs: stored and evicted (job_results.c), and shared by identical jobs
 * (job_dedup.c).
 */
#ifndef ORL_SERVER_JOBS_JOB_RESULTS_H
#define ORL_SERVER_JOBS_JOB_RESULTS_H

#include "jobs/jobs.h"

/*
 * The stored results of jobs: their size, their last use, and their removal.
 *
 * Results may be evicted to free disk space (storage.h). The job's row records the time before the
 * files are deleted. Identical jobs have links to the same files, which are counted for each job.
 *
 * Threads: the loop thread.
 */

/* Returns true if the job has results. */
bool orl_job_results_exist(const struct orl_jobs_job *job);
/* Returns the bytes of all jobs' results. */
uint64_t orl_job_results_bytes(const struct orl_jobs *jobs);

/* Returns the expected bytes of the results of jobs that wait or run. */
uint64_t orl_job_results_expected(const struct orl_jobs *jobs);

/* Returns the bytes of the files that an outcome (JSON text) lists. False: no memory. */
bool orl_job_results_count(const char *text, uint64_t *ret_bytes);

/* Replaces a job's expected bytes by the bytes it leaves. Call it when the job is about to end in
 * that state. */
void orl_job_results_set_final(struct orl_jobs_job *job, enum orl_job_state state);

/* Returns the relative error that an ended job's goal reached (Accuracy's "achieved"); NaN: no
 * goal. The value is remembered. */
double orl_job_results_error(struct orl_jobs *jobs, const char *id);

/* fetched: records that a client read the results. flush: writes these times to the rows. */
void orl_job_results_fetched(struct orl_jobs *jobs, const char *id);
void orl_job_results_flush(struct orl_jobs *jobs);
/* Returns when the results were last used, milliseconds since 1970. */
int64_t orl_job_results_used_ms(const struct orl_jobs_job *job);

/* mark_evicted: writes to the row that the results are evicted. delete_files: removes them, once
 * that row is safe on disk. */
int orl_job_results_mark_evicted(struct orl_jobs *jobs, const char *id, struct orl_error *err);
void orl_job_results_delete_files(struct orl_jobs *jobs, const char *id);
/* Removes only the files, of a job whose row is deleted. */
void orl_job_results_discard(struct orl_jobs_job *job);

/* Removes the files that exist for that id: results that belong to no job. */
void orl_job_results_remove_files(const struct orl_jobs *jobs, const char *id);

/* Runs at the start: counts stored results, and removes those that belong to no successful job. */
void orl_job_results_sweep(struct orl_jobs *jobs);

/*
 * Identical jobs share one computation: the first leads, the others follow it. Each has an id, a
 * state and results of its own.
 *
 * Jobs are identical if their documents have the same identity (runner/job_document.h). They share
 * from the arrival of the second until the computation ends; a job that arrives later is computed
 * anew. The leader owns the place in the queue and the worker. A leader that is cancelled while
 * others follow still leads, as cancelled, until the computation ends. Partial results go to the
 * last job that is cancelled; jobs cancelled before it get none.
 *
 * Threads: the loop thread only.
 */

/* follow: makes job a follower of leader. leave: takes it out again. */
void orl_dedup_follow(struct orl_jobs_job *leader, struct orl_jobs_job *job);
void orl_dedup_leave(struct orl_jobs_job *job);

/*
 * Copies a computation's results to the jobs that follow its leader. This runs on the pool, as
 * there may be thousands of files. Internal to jobs.h; its rules apply.
 *
 * Meanwhile the leader is `finishing`: it neither ends nor is removed, and no job joins it. A
 * follower that leaves before the end gets no results.
 *
 * Threads: the loop thread only.
 */

struct orl_result_fanout;

/* Called when the copies are made. fanout is valid during the call. */
typedef void orl_result_fanout_done(struct orl_jobs_job *leader,
                                    const struct orl_worker_outcome *outcome,
                                    const struct orl_result_fanout *fanout);

/* Starts the copies. done is called in a later turn of the loop, with a copy of outcome. Returns
 * false if there are no followers or no memory; done is not called then. */
bool orl_result_fanout_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                             orl_result_fanout_done *done);

/* Returns the error of a job's copy, or 0. If fanout (may be NULL) does not have the job, makes its
 * copy now. */
int orl_result_fanout_find(const struct orl_result_fanout *fanout,
                           const struct orl_jobs_job *leader, const struct orl_jobs_job *job,
                           struct orl_error *ret_err);

#endif
