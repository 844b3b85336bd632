/*
 * Copies a computation's results to the jobs that follow its leader. This runs on the pool, as
 * there may be thousands of files. Internal to jobs.h; its rules apply.
 *
 * Meanwhile the leader is `finishing`: it neither ends nor is removed, and no job joins it. A
 * follower that leaves before the end gets no results.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_RESULT_FANOUT_H
#define ORL_SERVER_JOBS_RESULT_FANOUT_H

#include "jobs/jobs.h"

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
