#include "handlers/jobs/status_cache.h"

#include <stdlib.h>
#include <string.h>

#include "handlers/jobs/job_status.h"
#include "http/response/reply.h"

struct orl_status_cache *orl_status_cache_new(void)
{
    return calloc(1, sizeof(struct orl_status_cache));
}

void orl_status_cache_free(struct orl_status_cache *cache)
{
    for (size_t i = 0; cache && i < ORL_STATUS_CACHE; i++)
        free(cache->entries[i].text);
    free(cache);
}

/* Returns the job's entry. Ids are random hexadecimal digits, so the last few serve as the hash. */
static struct orl_status_entry *entry_of(struct orl_status_cache *cache, const char *id)
{
    char tail[5];
    memcpy(tail, id + ORL_JOB_ID - sizeof tail, sizeof tail);
    return &cache->entries[strtoul(tail, NULL, 16) % ORL_STATUS_CACHE];
}

/* Compares two rows bytewise. Padding may differ while all members are equal; the text is then made
 * again. */
static bool is_same(const void *row, const void *other)
{
    return memcmp(row, other, sizeof(struct orl_job_row)) == 0;
}

const char *orl_status_cache_text(struct orl_status_cache *cache, const struct orl_jobs *jobs,
                                  const struct orl_jobs_job *job, size_t *ret_size)
{
    struct orl_status_entry *entry = entry_of(cache, job->row.id);
    if (!entry->text || !is_same(&entry->row, &job->row)) {
        free(entry->text);
        entry->text = orl_reply_text_of(orl_job_status(jobs, job));
        entry->size = entry->text ? strlen(entry->text) : 0;
        memcpy(&entry->row, &job->row, sizeof job->row);
    }
    *ret_size = entry->size;
    return entry->text;
}
