/*
 * Copies a computation's results to the jobs that follow its leader. This runs on the pool, as
 * there may be thousands of files. Internal to jobs.h; its rules apply.
 *
 * Meanwhile the leader is `settling`: it neither ends nor is removed, and no job joins it. A
 * follower that leaves before the end gets no results.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOB_GIVING_H
#define ORL_SERVER_JOBS_JOB_GIVING_H

#include "jobs/jobs.h"

struct orl_giving;

/* Called when the copies are made. giving is valid during the call. */
typedef void orl_giving_done(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                             const struct orl_giving *giving);

/* Starts the copies. done is called in a later turn of the loop, with a copy of outcome. Returns
 * false if there are no followers or no memory; done is not called then. */
bool orl_giving_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                      orl_giving_done *done);

/* Returns the error of a job's copy, or 0. If giving (may be NULL) does not have the job, makes its
 * copy now. */
int orl_giving_find(const struct orl_giving *giving, const struct orl_jobs_job *leader,
                    const struct orl_jobs_job *job, struct orl_error *ret_err);

#endif
