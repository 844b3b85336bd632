/* The start of the jobs with the daemon, including those of the previous daemon, and their end. */
#include <stdlib.h>
#include <string.h>

#include "jobs/job_results.h"
#include "jobs/job_runs.h"
#include "process/limits.h"
#include "runner/checkpoints.h"

static int load_row(void *ctx, const struct orl_job_row *row)
{
    struct orl_jobs_job *job = calloc(1, sizeof *job);
    if (!job)
        return ORL_ERR_NOMEM;
    job->row = *row;
    job->outcome = row->outcome ? strdup(row->outcome) : NULL;
    job->problem = row->problem ? strdup(row->problem) : NULL;
    if (orl_job_set_labels(job, row->name, row->tags) || (row->outcome && !job->outcome) ||
        (row->problem && !job->problem)) {
        orl_job_free(job);
        return ORL_ERR_NOMEM;
    }
    job->row.outcome = job->outcome;
    job->row.problem = job->problem;
    orl_job_list_add(ctx, job);
    return 0;
}

/* Returns true if the two jobs shared a computation. */
static bool is_same(const struct orl_jobs_job *a, const struct orl_jobs_job *b)
{
    return a == b || (*a->row.identity && strcmp(a->row.identity, b->row.identity) == 0);
}

/* Returns true if no other computation ran. */
static bool ran_alone(const struct orl_jobs_job *job)
{
    for (const struct orl_jobs_job *at = job->jobs->oldest; at; at = at->newer)
        if (at->row.state == ORL_JOB_RUNNING && !is_same(at, job))
            return false;
    return true;
}

/* Counts a crash for the running jobs that are to blame for the daemon's abrupt end. */
static void count_crashes(struct orl_jobs *jobs)
{
    const struct orl_previous_exit *previous_exit = jobs->env.previous_exit;
    const struct orl_jobs_job *named = orl_jobs_lookup(jobs, previous_exit->job);
    for (struct orl_jobs_job *job = jobs->oldest; job; job = job->newer) {
        if (job->row.state != ORL_JOB_RUNNING)
            continue;
        const bool guilty = orl_previous_exit_caused_by(previous_exit, named && is_same(job, named),
                                                        ran_alone(job));
        job->row.crashes += guilty;
        orl_log_event(jobs->env.log, ORL_LOG_WARN, "job-was-running", "ssi", "job", job->row.id,
                      "blamed", guilty ? "yes" : "no", "strikes", (int64_t)job->row.crashes);
    }
}

static void fail_after_crashes(struct orl_jobs_job *job)
{
    struct orl_error err;
    orl_error_set(&err, ORL_ERR_INTERNAL,
                  "the daemon ended abruptly %d times while it ran this job; it is not tried again",
                  job->row.crashes);
    orl_error_hint(&err, "Too little memory is the usual cause: ask for fewer photons, "
                         "sensors or pixels");
    orl_jobs_fail(job, &err);
}

/* Queues waiting jobs, and jobs that were running when the previous daemon ended abruptly. */
static void recover_jobs(struct orl_jobs *jobs)
{
    count_crashes(jobs);
    for (struct orl_jobs_job *job = jobs->oldest; job; job = job->newer) {
        if (job->row.state == ORL_JOB_QUEUED)
            orl_runs_enqueue(job);
        if (job->row.state != ORL_JOB_RUNNING)
            continue;
        if (job->row.crashes >= ORL_SERVER_ATTEMPTS) {
            fail_after_crashes(job);
            continue;
        }
        job->row.started_ms = 0;
        orl_jobs_set_state(job, ORL_JOB_QUEUED);
        orl_runs_enqueue(job);
    }
}

/* Returns the job that continues a job's work: the job itself if it waits, or else the leader of
 * identical jobs. The latter occurs after a leader with followers was cancelled. */
static const char *successor_of(void *ctx, const char *id, bool *ret_known)
{
    const struct orl_jobs *jobs = ctx;
    const struct orl_jobs_job *job = orl_jobs_lookup(jobs, id), *leader = jobs->leaders;
    *ret_known = job != NULL;
    if (!job || job->row.state == ORL_JOB_QUEUED)
        return job ? job->row.id : NULL;
    while (leader && !is_same(leader, job))
        leader = leader->next_leader;
    return leader ? leader->row.id : NULL;
}

int orl_jobs_open(const struct orl_jobs_env *env, struct orl_jobs **ret_jobs, struct orl_error *err)
{
    struct orl_jobs *jobs = calloc(1, sizeof *jobs);
    if (!jobs)
        return orl_error_no_memory(err);
    jobs->env = *env;
    jobs->paused = env->paused;
    jobs->queue = orl_queue_new();
    const int rc =
        jobs->queue ? orl_job_rows(env->db, load_row, jobs, err) : orl_error_no_memory(err);
    if (rc) {
        orl_jobs_close(jobs);
        return rc;
    }
    recover_jobs(jobs);
    orl_checkpoint_sweep(env->folders, successor_of, jobs);
    orl_job_results_sweep(jobs);
    *ret_jobs = jobs;
    orl_runs_start_next(jobs);
    return 0;
}

void orl_jobs_close(struct orl_jobs *jobs)
{
    if (!jobs)
        return;
    orl_jobs_save(jobs);
    while (jobs->newest) {
        struct orl_jobs_job *job = jobs->newest;
        jobs->newest = job->older;
        orl_job_free(job);
    }
    orl_queue_free(jobs->queue);
    free(jobs);
}
