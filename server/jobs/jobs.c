#include "jobs/jobs.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "jobs/job_results.h"
#include "jobs/job_runs.h"
#include "process/limits.h"
#include "process/times.h"
#include "runner/checkpoints.h"
#include "store/files/removal.h"

/* ---- Submitting, cancelling, stopping ------------------------------------------------------- */

int orl_jobs_submit(struct orl_jobs *jobs, const struct orl_job_submission *submission,
                    const struct orl_jobs_job **ret_job, struct orl_error *err)
{
    unsigned char bytes[(ORL_JOB_ID - 1) / 2];
    struct orl_jobs_job *job = calloc(1, sizeof *job);
    if (!job)
        return orl_error_no_memory(err);
    if (orl_job_set_labels(job, submission->labels.name, submission->labels.tags)) {
        orl_job_free(job);
        return orl_error_no_memory(err);
    }
    randombytes_buf(bytes, sizeof bytes);
    sodium_bin2hex(job->row.id, sizeof job->row.id, bytes, sizeof bytes);
    snprintf(job->row.scene, sizeof job->row.scene, "%s", submission->scene);
    snprintf(job->row.document, sizeof job->row.document, "%s", submission->document);
    snprintf(job->row.identity, sizeof job->row.identity, "%s", submission->identity);
    snprintf(job->row.client, sizeof job->row.client, "%s", submission->client);
    snprintf(job->row.owner, sizeof job->row.owner, "%s", submission->owner);
    job->row.kind = submission->kind;
    job->row.priority = submission->priority;
    job->row.result_bytes = submission->result_bytes;
    job->row.memory_bytes = submission->memory_bytes;
    job->row.state = ORL_JOB_QUEUED;
    job->row.created_ms = orl_time_now_ms();
    const int rc =
        orl_job_row_insert(jobs->env.db, &job->row, submission->request_key, &job->row.seq, err);
    if (rc) {
        orl_job_free(job);
        return rc;
    }
    orl_job_list_add(jobs, job);
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job", "ssss", "job", job->row.id, "state", "queued",
                  "scene", submission->scene, "client", submission->client);
    orl_runs_enqueue(job);
    jobs->env.changed(jobs->env.ctx, job);
    orl_runs_start_next(jobs);
    *ret_job = job;
    return 0;
}

int orl_jobs_by_key(struct orl_jobs *jobs, const char *client, const char *owner,
                    const char *request_key, const struct orl_jobs_job **ret_job,
                    struct orl_error *err)
{
    char id[ORL_JOB_ID];
    const int64_t since_ms = orl_time_now_ms() - 1000 * (int64_t)ORL_SERVER_KEY_S;
    const int rc = orl_job_row_by_key(jobs->env.db, client, owner, request_key, since_ms, id, err);
    if (rc == 0)
        *ret_job = orl_jobs_lookup(jobs, id);
    return rc;
}

/* Hands partial results of an earlier start to the job that leads in this one's place, or removes
 * them. */
static void hand_over_checkpoint(const struct orl_jobs_job *job,
                                 const struct orl_jobs_job *successor)
{
    const struct orl_folders *folders = job->jobs->env.folders;
    char path[ORL_PATH_MAX];
    const bool leads = successor && successor->row.state == ORL_JOB_QUEUED && !successor->leader;
    if (leads && orl_checkpoint_transfer(folders, job->row.id, successor->row.id))
        return;
    orl_checkpoint_folder(folders, job->row.id, path);
    orl_remove_async(job->jobs->env.loop, folders, path);
}

/* Writes the row as cancelled before anything else changes, so that a crash does not restart the
 * job. */
static int write_cancelled(const struct orl_jobs_job *job, struct orl_error *err)
{
    struct orl_job_row row = job->row;
    row.state = ORL_JOB_CANCELLED;
    row.finished_ms = orl_time_now_ms();
    row.retained_ms = orl_retention_clock_ms(job->jobs->env.clock);
    return orl_job_row_update(job->jobs->env.db, &row, err);
}

/* Cancels a running job. In memory it runs until its threads have noticed. If it succeeds first,
 * its row is written once more. */
static void cancel_running(struct orl_jobs_job *job)
{
    job->cancelled = true;
    if (job->worker) /* otherwise it is ending already */
        orl_worker_cancel(job->worker);
}

/* Cancels a waiting job. Its followers stay queued, and the first of them leads. A job that waited
 * only because this one was first can start. */
static void cancel_queued(struct orl_jobs_job *job)
{
    struct orl_jobs_job *followers = job->followers, *const first = followers;
    orl_runs_end_memory_wait(job);
    if (job->leader) {
        orl_dedup_leave(job);
    } else {
        orl_queue_remove(job->jobs->queue, &job->waiting);
        orl_runs_remove_leader(job);
        job->followers = NULL;
    }
    orl_jobs_set_state(job, ORL_JOB_CANCELLED);
    while (followers) {
        struct orl_jobs_job *next = followers->next_follower;
        followers->leader = NULL;
        followers->next_follower = NULL;
        orl_runs_enqueue(followers);
        followers = next;
    }
    hand_over_checkpoint(job, first);
    orl_runs_start_next(job->jobs);
}

static bool is_last_active(const struct orl_jobs_job *leader, const struct orl_jobs_job *job)
{
    const bool leader_wants = leader != job && leader->row.state != ORL_JOB_CANCELLED;
    return !leader_wants && leader->followers == job && !job->next_follower;
}

/* Cancels a job that shares its computation, which continues while another job needs it. The last
 * job to be cancelled gets the partial results, like a job alone. */
static void cancel_deduplicated(struct orl_jobs_job *job)
{
    struct orl_jobs_job *leader = job->leader ? job->leader : job;
    if (is_last_active(leader, job)) {
        job->cancelled = true;
        if (leader->worker)
            orl_worker_cancel(leader->worker);
        return;
    }
    if (job->leader)
        orl_dedup_leave(job);
    orl_jobs_set_state(job, ORL_JOB_CANCELLED);
}

int orl_jobs_cancel(struct orl_jobs *jobs, const char *id, struct orl_error *err)
{
    struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    if (!job)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no such job");
    if (job->row.state == ORL_JOB_CANCELLED)
        return 0;
    if (job->row.state > ORL_JOB_RUNNING)
        return orl_error_set(err, ORL_ERR_INVALID, "the job has %s already",
                             orl_job_state_name(job->row.state));
    const int rc = write_cancelled(job, err);
    if (rc)
        return rc;
    if (job->row.state == ORL_JOB_QUEUED)
        cancel_queued(job);
    else if (!job->leader && !job->followers)
        cancel_running(job);
    else
        cancel_deduplicated(job);
    if (job->row.state == ORL_JOB_RUNNING) /* otherwise the change was reported already */
        jobs->env.changed(jobs->env.ctx, job);
    return 0;
}

bool orl_jobs_need_scene(const struct orl_jobs *jobs, const char *scene)
{
    const struct orl_jobs_job *job = jobs->newest;
    while (job && (orl_jobs_ended(job) || strcmp(job->row.scene, scene) != 0))
        job = job->older;
    return job != NULL;
}

/* Removes a job whose row is deleted. */
static void drop_job(struct orl_jobs_job *job)
{
    struct orl_jobs *jobs = job->jobs;
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job-removed", "s", "job", job->row.id);
    jobs->env.removing(jobs->env.ctx, job);
    orl_job_note_saved(job, true); /* there is nothing left to save */
    orl_job_results_discard(job);
    orl_blobs_remove_unused(jobs->env.blobs, job->row.document);
    orl_job_list_remove(jobs, job);
    orl_job_free(job);
}

int orl_jobs_remove(struct orl_jobs *jobs, const char *id, struct orl_error *err)
{
    struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    if (!job)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no such job");
    if (!orl_jobs_ended(job))
        return orl_error_set(err, ORL_ERR_INVALID, "%s",
                             job->row.state <= ORL_JOB_RUNNING
                                 ? "the job has not ended; cancel it first"
                                 : "other jobs share its computation, which has not ended");
    const int rc = orl_job_row_drop(jobs->env.db, job->row.seq, err);
    if (rc == 0)
        drop_job(job);
    return rc;
}

/* Removes ended jobs, with their rows in one transaction. */
static void remove_ended(struct orl_jobs *jobs, struct orl_jobs_job *const *ended, size_t count)
{
    struct orl_error err;
    int rc = orl_db_begin(jobs->env.db, &err);
    const bool begun = rc == 0;
    for (size_t i = 0; i < count && rc == 0; i++)
        rc = orl_job_row_drop(jobs->env.db, ended[i]->row.seq, &err);
    if (begun)
        rc = orl_db_end(jobs->env.db, rc, &err);
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_WARN, "job-row-failed", "s", "why", err.message);
    for (size_t i = 0; i < count && rc == 0; i++)
        drop_job(ended[i]);
}

void orl_jobs_pause(struct orl_jobs *jobs, bool paused)
{
    jobs->paused = paused;
    orl_runs_start_next(jobs);
}

void orl_jobs_drain(struct orl_jobs *jobs)
{
    jobs->stopping = true;
    if (jobs->n_workers == 0)
        jobs->env.idle(jobs->env.ctx);
}

void orl_jobs_stop(struct orl_jobs *jobs)
{
    jobs->stopping = true;
    for (struct orl_jobs_job *job = jobs->leaders; job; job = job->next_leader)
        if (job->worker) {
            job->requeue = true;
            orl_worker_stop(job->worker);
        }
    if (jobs->n_workers == 0)
        jobs->env.idle(jobs->env.ctx);
}

/* ---- Limits in time -------------------------------------------------------------------------- */

static void stop_timed_out(struct orl_jobs *jobs)
{
    const double now_s = orl_time_steady_s();
    for (struct orl_jobs_job *job = jobs->leaders; job; job = job->next_leader) {
        if (!job->worker || job->timed_out || job->requeue ||
            now_s - job->started_s <= jobs->env.job_timeout_s)
            continue;
        job->timed_out = true;
        orl_worker_cancel(job->worker);
    }
}

static bool is_evictable(const struct orl_jobs_job *job, int64_t now_ms)
{
    return orl_jobs_ended(job) && !job->unsaved &&
           (!orl_job_results_exist(job) || job->row.fetched_ms > 0 ||
            now_ms - job->row.retained_ms >= 1000 * (int64_t)ORL_SERVER_UNFETCHED_S);
}

static void remove_old(struct orl_jobs *jobs)
{
    enum { AT_ONCE = 64, LOOK_AT = 4096 };
    const size_t ended = jobs->counts[ORL_JOB_SUCCEEDED] + jobs->counts[ORL_JOB_FAILED] +
                         jobs->counts[ORL_JOB_CANCELLED];
    size_t too_many = ended > jobs->env.keep_jobs ? ended - jobs->env.keep_jobs : 0;
    const int64_t now_ms = orl_retention_clock_ms(jobs->env.clock), day_ms = 86400000;
    const int64_t since_ms =
        jobs->env.keep_days > 0 ? now_ms - day_ms * jobs->env.keep_days : INT64_MIN;
    struct orl_jobs_job *going[AT_ONCE];
    size_t count = 0, looked_at = 0;
    for (struct orl_jobs_job *job = jobs->oldest; job && count < AT_ONCE && looked_at < LOOK_AT;
         job = job->newer, looked_at++) {
        if (!is_evictable(job, now_ms) || (too_many == 0 && job->row.retained_ms >= since_ms))
            continue;
        going[count++] = job;
        too_many -= too_many > 0;
    }
    if (count > 0)
        remove_ended(jobs, going, count);
}

void orl_jobs_enforce_limits(struct orl_jobs *jobs)
{
    for (const struct orl_jobs_job *job = jobs->leaders; job; job = job->next_leader)
        orl_runs_log_parts(job);
    stop_timed_out(jobs);
    remove_old(jobs);
}
