/* The job that a request's path names. Threads: the loop thread only. */
#ifndef ORL_SERVER_RESOURCES_JOB_PATH_H
#define ORL_SERVER_RESOURCES_JOB_PATH_H

#include "http/request.h"
#include "jobs/jobs.h"

/* By its id, or what no other's id begins with (orl_jobs_find_begun). NULL after a 404. The log has
 * the whole id. */
const struct orl_jobs_job *orl_job_of_path(struct orl_request *request);

/* Of a job that has ended: the answer made waits until no power cut can undo that
 * (orl_reply_when_safe). */
void orl_job_reply_when_ended(struct orl_request *request, const struct orl_jobs_job *job);

#endif
