/*
 * The stored results of jobs: their size, their last use, and their removal.
 *
 * Results may be evicted to free disk space (storage.h). The job's row records the time before the
 * files are deleted. Identical jobs have links to the same files, which are counted for each job.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_JOBS_JOB_RESULTS_H
#define ORL_SERVER_JOBS_JOB_RESULTS_H

#include "jobs/jobs.h"

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

/* leave: writes to the row that the results are evicted. gone: removes them, once that row is safe
 * on disk. */
int orl_job_results_mark_evicted(struct orl_jobs *jobs, const char *id, struct orl_error *err);
void orl_job_results_delete_files(struct orl_jobs *jobs, const char *id);
/* Removes only the files, of a job whose row is deleted. */
void orl_job_results_discard(struct orl_jobs_job *job);

/* Removes the files that exist for that id: results that belong to no job. */
void orl_job_results_remove_files(const struct orl_jobs *jobs, const char *id);

/* Runs at the start: counts stored results, and removes those that belong to no successful job. */
void orl_job_results_sweep(struct orl_jobs *jobs);

#endif
