#include "jobs/job_runs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process/limits.h"

/* Ids are random hexadecimal digits, so the first few serve as the hash. */
static size_t bucket_of(const char *id)
{
    char head[5];
    snprintf(head, sizeof head, "%.4s", id);
    return strtoul(head, NULL, 16) % ORL_JOBS_BUCKETS;
}

void orl_job_list_add(struct orl_jobs *jobs, struct orl_jobs_job *job)
{
    const size_t bucket = bucket_of(job->row.id);
    job->jobs = jobs;
    job->older = jobs->newest;
    if (jobs->newest)
        jobs->newest->newer = job;
    else
        jobs->oldest = job;
    jobs->newest = job;
    job->same_bucket = jobs->buckets[bucket];
    jobs->buckets[bucket] = job;
    jobs->counts[job->row.state]++;
    if (job->row.state <= ORL_JOB_RUNNING)
        jobs->expected_bytes += job->row.result_bytes;
}

void orl_job_list_remove(struct orl_jobs *jobs, struct orl_jobs_job *job)
{
    struct orl_jobs_job **at = &jobs->buckets[bucket_of(job->row.id)];
    while (*at != job)
        at = &(*at)->same_bucket;
    *at = job->same_bucket;
    if (job->newer)
        job->newer->older = job->older;
    else
        jobs->newest = job->older;
    if (job->older)
        job->older->newer = job->newer;
    else
        jobs->oldest = job->newer;
    jobs->counts[job->row.state]--;
}

struct orl_jobs_job *orl_jobs_lookup(const struct orl_jobs *jobs, const char *id)
{
    struct orl_jobs_job *job = jobs->buckets[bucket_of(id)];
    while (job && strcmp(job->row.id, id) != 0)
        job = job->same_bucket;
    return job;
}

const struct orl_jobs_job *orl_jobs_find(const struct orl_jobs *jobs, const char *id)
{
    return orl_jobs_lookup(jobs, id);
}

/* Ids with the same first digits share a bucket; a bucket is chosen by ORL_JOB_PREFIX digits. */
const struct orl_jobs_job *orl_jobs_find_prefix(const struct orl_jobs *jobs, const char *prefix,
                                                bool *ret_several)
{
    const size_t length = strlen(prefix);
    const struct orl_jobs_job *found = NULL;
    *ret_several = false;
    if (length < ORL_JOB_PREFIX || length >= ORL_JOB_ID ||
        strspn(prefix, "0123456789abcdef") != length)
        return NULL;
    for (const struct orl_jobs_job *job = jobs->buckets[bucket_of(prefix)]; job;
         job = job->same_bucket) {
        if (strncmp(job->row.id, prefix, length) != 0)
            continue;
        if (found) {
            *ret_several = true;
            return NULL;
        }
        found = job;
    }
    return found;
}

const struct orl_jobs_job *orl_jobs_newest(const struct orl_jobs *jobs)
{
    return jobs->newest;
}

size_t orl_jobs_position(const struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    const struct orl_jobs_job *leader = job->leader ? job->leader : job;
    return orl_queue_position(jobs->queue, &leader->waiting);
}

const char orl_jobs_cancelling[] = "cancelling";

const char *orl_jobs_state_name(const struct orl_jobs_job *job)
{
    return job->cancelled && job->row.state == ORL_JOB_RUNNING ? orl_jobs_cancelling
                                                               : orl_job_state_name(job->row.state);
}

struct orl_worker *orl_jobs_worker(const struct orl_jobs_job *job)
{
    return job->leader ? job->leader->worker : job->worker;
}

void orl_jobs_running(const struct orl_jobs *jobs,
                      void (*visit)(void *ctx, const struct orl_jobs_job *job), void *ctx)
{
    for (const struct orl_jobs_job *leader = jobs->leaders; leader; leader = leader->next_leader) {
        if (leader->row.state == ORL_JOB_RUNNING)
            visit(ctx, leader);
        for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
            if (job->row.state == ORL_JOB_RUNNING)
                visit(ctx, job);
    }
}

const char *orl_jobs_fairness_key(const struct orl_jobs_job *job)
{
    return job->row.owner[0] ? job->row.owner : job->row.client;
}

size_t orl_jobs_of_owner(const struct orl_jobs *jobs, const char *owner)
{
    size_t count = 0;
    for (const struct orl_jobs_job *leader = jobs->leaders; leader; leader = leader->next_leader) {
        count += leader->row.state <= ORL_JOB_RUNNING && strcmp(leader->row.owner, owner) == 0;
        for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
            count += strcmp(job->row.owner, owner) == 0;
    }
    return count;
}

size_t orl_jobs_count(const struct orl_jobs *jobs, enum orl_job_state state)
{
    return jobs->counts[state];
}

bool orl_jobs_full(const struct orl_jobs *jobs)
{
    /* Followers of a running computation are marked running, but count as waiting. */
    const size_t running = jobs->counts[ORL_JOB_RUNNING];
    const size_t sharing = running > jobs->n_workers ? running - jobs->n_workers : 0;
    return jobs->counts[ORL_JOB_QUEUED] + sharing >= ORL_SERVER_QUEUE;
}

int orl_job_set_labels(struct orl_jobs_job *job, const char *name, const char *tags)
{
    job->labels.name = name ? strdup(name) : NULL;
    job->labels.tags = tags ? strdup(tags) : NULL;
    job->row.name = job->labels.name;
    job->row.tags = job->labels.tags;
    return (job->labels.name || !name) && (job->labels.tags || !tags) ? 0 : ORL_ERR_NOMEM;
}

void orl_job_free(struct orl_jobs_job *job)
{
    if (!job)
        return;
    free(job->outcome);
    free(job->problem);
    orl_labels_done(&job->labels);
    free(job);
}
