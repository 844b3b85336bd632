/*
 * A cache of ended jobs' documents as text: dashboards poll them, and they seldom change. An entry
 * holds the row that it was made from, and is valid only while the job's row is equal.
 *
 * Memory: ORL_STATUS_CACHE documents, a few kilobytes each.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HANDLERS_JOBS_STATUS_CACHE_H
#define ORL_SERVER_HANDLERS_JOBS_STATUS_CACHE_H

#include <stddef.h>

#include "jobs/jobs.h"

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

#endif
