/*
 * A job's document, as GET /v1/jobs/{id} shows it, made from memory alone:
 *
 *     {"id", "name", "tags", "kind", "state", "stage", "percent", "eta_s", "attempts", "scene",
 *      "priority", "client", "created", "started", "finished", "queue_position", "maps": [...],
 *      "timings_s": {...}, "error": {...}, "links": {"self", "result", "cancel", "files": [...]}}
 *
 * "warnings" are present while it runs, as they arrive, and after it has ended with results: those
 * of a successful job, or of the finished skies of a cancelled job.
 *
 * "evicted" is the time when the results were removed to free space; there are then no links to
 * them.
 *
 * stage, percent and eta_s are always present, and null if unknown or not applicable.
 * queue_position is present while it waits. Other unknown members are absent. maps appear as they
 * become ready, with "cached" for a hit. A job of several skies has "skies" with their number, the
 * number of finished ones, and the current one, to which stage and maps refer. A running study has
 * "study" in place of stage and maps: the current run, and the points so far.
 */
#ifndef ORL_SERVER_HANDLERS_JOBS_JOB_STATUS_H
#define ORL_SERVER_HANDLERS_JOBS_JOB_STATUS_H

#include <jansson.h>

#include "jobs/jobs.h"

/* A new reference; NULL when out of memory. */
json_t *orl_job_status(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

/* A new reference; NULL when out of memory. */
json_t *orl_job_tags(const struct orl_jobs_job *job);

/* Returns the path of a file of the job's results. Slashes in a name are escaped, since they do not
 * separate parts of the path. A new reference; NULL when out of memory. */
json_t *orl_job_file_url(const char *id, const char *name);

/* Returns a time in milliseconds since 1970 as text, or null for 0. A new reference. */
json_t *orl_job_time(int64_t ms);

/* Returns the warnings so far of a running job. A new reference. */
json_t *orl_job_warnings(const struct orl_job_progress *progress);

/* Returns the seconds that a running job has left, to a tenth, or null. A new reference. */
json_t *orl_job_eta(const struct orl_job_progress *progress);

#endif
