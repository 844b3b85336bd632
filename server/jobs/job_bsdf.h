/*
 * Stores the BSDF that a job has made, so that scenes can name it by its id. It is stored before
 * the job becomes succeeded, so clients that see that state find it. Internal to jobs.h; its rules
 * apply.
 *
 * Meanwhile the job is `finishing`, as in result_fanout.h. A job whose BSDF cannot be stored fails.
 *
 * Threads: the loop thread only; the file's blob is made on the pool.
 */
#ifndef ORL_SERVER_JOBS_JOB_BSDF_H
#define ORL_SERVER_JOBS_JOB_BSDF_H

#include "jobs/jobs.h"

typedef void orl_job_bsdf_done(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome);

/* Starts to store the BSDF. done is called in a later turn of the loop, with a copy of outcome. The
 * copy has no bsdf, and its code and err report a failure. Returns false if the outcome has no
 * BSDF; done is not called then. */
bool orl_job_bsdf_start(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                        orl_job_bsdf_done *done);

#endif
