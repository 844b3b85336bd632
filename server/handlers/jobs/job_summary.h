/*
 * A short form of a job for lists that are polled: no files, maps or links.
 *
 *     {"id", "name", "tags", "kind", "state", "scene", "client", "priority", "stage", "percent",
 *      "eta_s", "error", "created", "started", "finished", "queue_position"}
 *
 * error is the relative error so far of a job with accuracy. error, name, stage, percent and eta_s
 * are null if unknown or not applicable. queue_position is present while it waits. percent is
 * rounded to a tenth, eta_s to a second. Smaller changes give an equal text and an equal ETag.
 */
#ifndef ORL_SERVER_HANDLERS_JOBS_JOB_SUMMARY_H
#define ORL_SERVER_HANDLERS_JOBS_JOB_SUMMARY_H

#include <jansson.h>

#include "jobs/jobs.h"

/* Returns a new reference; NULL when out of memory. */
json_t *orl_job_summary(struct orl_jobs *jobs, const struct orl_jobs_job *job);

#endif
