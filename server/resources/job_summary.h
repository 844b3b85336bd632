/*
 * A job in a line, for lists that are asked for often: no files, maps or links.
 *
 *     {"id", "name", "tags", "kind", "state", "scene", "client", "priority", "stage", "percent",
 *      "eta_s", "error", "created", "started", "finished", "queue_position"}
 *
 * error is the relative error so far of a job with accuracy; null, as name, stage, percent and
 * eta_s, where nothing is known or meant. queue_position is there while it waits. percent has a
 * tenth, eta_s a second: what changes less is the same text, and the same ETag.
 */
#ifndef ORL_SERVER_RESOURCES_JOB_SUMMARY_H
#define ORL_SERVER_RESOURCES_JOB_SUMMARY_H

#include <jansson.h>

#include "jobs/jobs.h"

/* A new reference; NULL when out of memory. */
json_t *orl_job_summary(struct orl_jobs *jobs, const struct orl_jobs_job *job);

#endif
