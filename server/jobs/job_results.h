/*
 * What jobs keep of their results: how much it is, when it was last asked for, and how it goes.
 *
 * A job whose results have gone to make room (storage.h) knows when; its row says so before the
 * files go. Links that identical jobs have to the same files are counted for each of them.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_JOBS_JOB_RESULTS_H
#define ORL_SERVER_JOBS_JOB_RESULTS_H

#include "jobs/jobs.h"

/* Are there results to give? */
bool orl_job_results_kept(const struct orl_jobs_job *job);
/* Of all jobs, bytes. */
uint64_t orl_job_results_bytes(const struct orl_jobs *jobs);

/* Of jobs that wait or run, bytes: what they are expected to leave. */
uint64_t orl_job_results_expected(const struct orl_jobs *jobs);

/* The files that an outcome (JSON text) lists, bytes. False: no memory. */
bool orl_job_results_count(const char *text, uint64_t *ret_bytes);

/* Of a job that is about to end in that state: what it leaves takes the place of what was expected.
 */
void orl_job_results_settle(struct orl_jobs_job *job, enum orl_job_state state);

/* The relative error that an ended job's goal came to (Accuracy's "achieved"); NaN: it had none.
 * What its outcome says is remembered. */
double orl_job_results_error(struct orl_jobs *jobs, const char *id);

/* Somebody asked for them. flush writes that down, for all jobs at once. */
void orl_job_results_fetched(struct orl_jobs *jobs, const char *id);
void orl_job_results_flush(struct orl_jobs *jobs);
/* When they were of use last, milliseconds since 1970. */
int64_t orl_job_results_used_ms(const struct orl_jobs_job *job);

/* Writes to the row that they are gone; once that is safe, gone removes them. */
int orl_job_results_leave(struct orl_jobs *jobs, const char *id, struct orl_error *err);
void orl_job_results_gone(struct orl_jobs *jobs, const char *id);
/* The files alone, of a job whose row is gone. */
void orl_job_results_discard(struct orl_jobs_job *job);

/* Nothing but the files there are for that id: of results that are no job's. */
void orl_job_results_remove_files(const struct orl_jobs *jobs, const char *id);

/* At start: counts what is kept, and removes what belongs to no job that has succeeded. */
void orl_job_results_sweep(struct orl_jobs *jobs);

#endif
