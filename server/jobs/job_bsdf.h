/*
 * What a job has made becomes a BSDF of the daemon's, which scenes may name by its id: before the
 * job has succeeded, so that whoever sees that finds it there. Inside of jobs.h, whose rules hold.
 *
 * Meanwhile the job is `settling`, as in job_giving.h. A job whose BSDF cannot be kept fails.
 *
 * Threads: the loop thread only; the file's blob is made on the pool.
 */
#ifndef ORL_SERVER_JOBS_JOB_BSDF_H
#define ORL_SERVER_JOBS_JOB_BSDF_H

#include "jobs/jobs.h"

typedef void orl_job_bsdf_done(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome);

/* done comes in a later turn of the loop, with a copy of outcome, whose code and err say what went
 * wrong, and without its bsdf. False: it has none; done does not come then. */
bool orl_job_bsdf_start(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                        orl_job_bsdf_done *done);

#endif
