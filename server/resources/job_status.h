/*
 * A job's document, as GET /v1/jobs/{id} shows it, made from memory alone:
 *
 *     {"id", "name", "tags", "kind", "state", "stage", "percent", "eta_s", "attempts", "scene",
 * "priority", "client", "created", "started", "finished", "queue_position", "maps": [...],
 * "timings_s": {...}, "error": {...}, "links": {"self", "result", "cancel", "files": [...]}}
 *
 * "warnings" are there while it runs, as they come, and when it has ended with results: those of a
 * job that has succeeded, and of a cancelled one the skies that were done.
 *
 * "evicted" says when the results went to make room; there are no links to them then.
 *
 * stage, percent and eta_s are always there, null where nothing is known or meant; queue_position
 * while it waits; anything else that is not known is absent. maps appear as they are settled, with
 * "cached" for a hit. A job of several skies has, in "skies", how many there are and are done, and
 * the one under way, which stage and maps are about. A study that runs has, in place of stage and
 * maps, "study": what is being run, and the points so far.
 */
#ifndef ORL_SERVER_RESOURCES_JOB_STATUS_H
#define ORL_SERVER_RESOURCES_JOB_STATUS_H

#include <jansson.h>

#include "jobs/jobs.h"

/* A new reference; NULL when out of memory. */
json_t *orl_job_status(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

/* A new reference; NULL when out of memory. */
json_t *orl_job_tags(const struct orl_jobs_job *job);

/* The path of a file of the job's results. Names in folders have slashes, which are no part of a
 * path's shape. A new reference; NULL when out of memory. */
json_t *orl_job_file_url(const char *id, const char *name);

/* A time of the job's, milliseconds since 1970: text, or null for 0. A new reference. */
json_t *orl_job_time(int64_t ms);

/* The warnings so far of one that runs. A new reference. */
json_t *orl_job_warnings(const struct orl_job_progress *progress);

/* Seconds that a running job has left, to a tenth, or null. A new reference. */
json_t *orl_job_eta(const struct orl_job_progress *progress);

#endif
