/*
 * How clients see a job (job_status.c): its document, its short form in lists, the cache of ended
 * jobs' documents, and the job in a request's path.
 */
#ifndef ORL_SERVER_HANDLERS_JOBS_JOB_STATUS_H
#define ORL_SERVER_HANDLERS_JOBS_JOB_STATUS_H

#include <jansson.h>
#include <stddef.h>

#include "http/request/request.h"
#include "jobs/jobs.h"

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

/* Returns a new reference; NULL when out of memory. */
json_t *orl_job_status(const struct orl_jobs *jobs, const struct orl_jobs_job *job);

/* Returns the path of a file of the job's results. Slashes in a name are escaped, since they do not
 * separate parts of the path. A new reference; NULL when out of memory. */
json_t *orl_job_file_url(const char *id, const char *name);

/* Returns the warnings so far of a running job. A new reference. */
json_t *orl_job_warnings(const struct orl_job_progress *progress);

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

/* Returns a new reference; NULL when out of memory. */
json_t *orl_job_summary(struct orl_jobs *jobs, const struct orl_jobs_job *job);

/*
 * A cache of ended jobs' documents as text: dashboards poll them, and they seldom change. An entry
 * holds the row that it was made from, and is valid only while the job's row is equal.
 *
 * Memory: ORL_STATUS_CACHE documents, a few kilobytes each.
 * Threads: the loop thread only.
 */

enum { ORL_STATUS_CACHE = 256 };

struct orl_status_cache {
    struct orl_status_entry {
        struct orl_job_row row; /* its pointers are only compared */
        char *text;             /* NULL: empty */
        size_t size;
    } entries[ORL_STATUS_CACHE];
};

struct orl_status_cache *orl_status_cache_new(void); /* NULL when out of memory */
void orl_status_cache_free(struct orl_status_cache *cache);

/* Returns the document of an ended job, borrowed until the next call; NULL when out of memory. */
const char *orl_status_cache_text(struct orl_status_cache *cache, const struct orl_jobs *jobs,
                                  const struct orl_jobs_job *job, size_t *ret_size);

/* The job in a request's path. Threads: the loop thread only. */

/* Returns the job by its id, or by a prefix that no other id has (orl_jobs_find_prefix). NULL after
 * a 404. The log has the whole id. */
const struct orl_jobs_job *orl_job_of_path(struct orl_request *request);

/* Delays the reply about an ended job until its end is on disk, so that no power cut can undo it
 * (orl_reply_when_durable). */
void orl_job_reply_when_ended(struct orl_request *request, const struct orl_jobs_job *job);

#endif
