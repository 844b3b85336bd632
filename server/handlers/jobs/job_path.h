/* The job in a request's path. Threads: the loop thread only. */
#ifndef ORL_SERVER_HANDLERS_JOBS_JOB_PATH_H
#define ORL_SERVER_HANDLERS_JOBS_JOB_PATH_H

#include "http/request/request.h"
#include "jobs/jobs.h"

/* Returns the job by its id, or by a prefix that no other id has (orl_jobs_find_prefix). NULL after
 * a 404. The log has the whole id. */
const struct orl_jobs_job *orl_job_of_path(struct orl_request *request);

/* Delays the reply about an ended job until its end is on disk, so that no power cut can undo it
 * (orl_reply_when_durable). */
void orl_job_reply_when_ended(struct orl_request *request, const struct orl_jobs_job *job);

#endif
