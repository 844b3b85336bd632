#include "jobs.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "discard.h"
#include "encode.h"
#include "job_list.h"
#include "job_results.h"
#include "job_runs.h"
#include "job_share.h"
#include "kept_parts.h"
#include "problem.h"
#include "times.h"

/* ---- Transitions ---------------------------------------------------------------------------- */

static void note_saved(struct orl_jobs_job *job, bool saved)
{
    job->jobs->n_unsaved += (size_t)!saved - (size_t)job->unsaved;
    job->unsaved = !saved;
}

/* Writes the row as it is to be after a crash. */
static int write_row(const struct orl_jobs_job *job, struct orl_error *err)
{
    struct orl_job_row row = job->row;
    if (job->cancelled && row.state == ORL_JOB_RUNNING)
        row.state = ORL_JOB_CANCELLED;
    return orl_job_row_update(job->jobs->env.db, &row, err);
}

/* In one transaction, which is one sync of the disk. */
static int save(struct orl_jobs *jobs, struct orl_error *err)
{
    size_t left = jobs->n_unsaved;
    int rc = left > 0 ? orl_db_exec(jobs->env.db, "BEGIN IMMEDIATE", err) : 0;
    if (rc || left == 0)
        return rc;
    for (struct orl_jobs_job *job = jobs->newest; job && left > 0 && rc == 0; job = job->older)
        if (job->unsaved) {
            rc = write_row(job, err);
            left--;
        }
    if (rc == 0)
        rc = orl_db_exec(jobs->env.db, "COMMIT", err);
    if (rc) {
        orl_db_exec(jobs->env.db, "ROLLBACK", NULL);
        return rc;
    }
    for (struct orl_jobs_job *job = jobs->newest; job && jobs->n_unsaved > 0; job = job->older)
        if (job->unsaved)
            note_saved(job, true);
    return 0;
}

void orl_jobs_save(struct orl_jobs *jobs)
{
    save(jobs, NULL); /* the next time, if it is no better yet */
}

void orl_jobs_batch_begin(struct orl_jobs *jobs)
{
    jobs->batch = true;
}

void orl_jobs_batch_end(struct orl_jobs *jobs)
{
    struct orl_error err;
    jobs->batch = false;
    if (save(jobs, &err))
        orl_log_event(jobs->env.log, ORL_LOG_ERROR, "job-row-failed", "s", "why", err.message);
}

void orl_jobs_set_state(struct orl_jobs_job *job, enum orl_job_state state)
{
    struct orl_jobs *jobs = job->jobs;
    struct orl_error err;
    jobs->counts[job->row.state]--;
    jobs->counts[state]++;
    if (state > ORL_JOB_RUNNING)
        orl_job_results_settle(job, state);
    job->row.state = state;
    job->row.outcome = job->outcome;
    job->row.problem = job->problem;
    if (state >= ORL_JOB_SUCCEEDED)
        job->row.finished_ms = orl_time_now_ms();
    const int rc = jobs->batch ? 0 : orl_job_row_update(jobs->env.db, &job->row, &err);
    note_saved(job, rc == 0 && !jobs->batch);
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_ERROR, "job-row-failed", "ss", "job", job->row.id,
                      "why", err.message);
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job", "ssi", "job", job->row.id, "state",
                  orl_job_state_name(state), "attempt", (int64_t)job->row.attempts);
    jobs->env.changed(jobs->env.ctx);
}

void orl_jobs_fail(struct orl_jobs_job *job, const struct orl_error *err)
{
    json_t *problem = orl_problem_from_error(err, NULL);
    char text[2 * ORL_ERROR_TEXT_MAX];
    free(job->problem);
    job->problem = problem ? orl_json_text(problem, JSON_COMPACT) : NULL;
    json_decref(problem);
    orl_jobs_set_state(job, ORL_JOB_FAILED);
    orl_error_format(err, text, sizeof text);
    orl_log_event(job->jobs->env.log, ORL_LOG_WARN, "job-failed", "ss", "job", job->row.id, "why",
                  text);
}

/* ---- Submitting, cancelling, stopping ------------------------------------------------------- */

int orl_jobs_submit(struct orl_jobs *jobs, const struct orl_jobs_order *order,
                    const struct orl_jobs_job **ret_job, struct orl_error *err)
{
    unsigned char bytes[(ORL_JOB_ID - 1) / 2];
    struct orl_jobs_job *job = calloc(1, sizeof *job);
    if (!job)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    randombytes_buf(bytes, sizeof bytes);
    sodium_bin2hex(job->row.id, sizeof job->row.id, bytes, sizeof bytes);
    snprintf(job->row.scene, sizeof job->row.scene, "%s", order->scene);
    snprintf(job->row.document, sizeof job->row.document, "%s", order->document);
    snprintf(job->row.identity, sizeof job->row.identity, "%s", order->identity);
    snprintf(job->row.client, sizeof job->row.client, "%s", order->client);
    job->row.kind = order->kind;
    job->row.priority = order->priority;
    job->row.result_bytes = order->result_bytes;
    job->row.memory_bytes = order->memory_bytes;
    job->row.state = ORL_JOB_QUEUED;
    job->row.created_ms = orl_time_now_ms();
    const int rc =
        orl_job_row_insert(jobs->env.db, &job->row, order->request_key, &job->row.seq, err);
    if (rc) {
        orl_job_free(job);
        return rc;
    }
    orl_job_list_add(jobs, job);
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job", "ssss", "job", job->row.id, "state", "queued",
                  "scene", order->scene, "client", order->client);
    orl_runs_enqueue(job);
    orl_runs_start_next(jobs);
    *ret_job = job;
    return 0;
}

int orl_jobs_by_key(struct orl_jobs *jobs, const char *client, const char *request_key,
                    const struct orl_jobs_job **ret_job, struct orl_error *err)
{
    char id[ORL_JOB_ID];
    const int64_t since_ms = orl_time_now_ms() - 1000 * (int64_t)ORL_SERVER_KEY_S;
    const int rc = orl_job_row_by_key(jobs->env.db, client, request_key, since_ms, id, err);
    if (rc == 0)
        *ret_job = orl_jobs_lookup(jobs, id);
    return rc;
}

/* What an earlier start has left. */
static void forget_partial(const struct orl_jobs_job *job)
{
    char path[ORL_PATH_MAX];
    orl_kept_folder(job->jobs->env.folders, job->row.id, path);
    orl_discard(job->jobs->env.loop, job->jobs->env.folders, path);
}

/* The row says cancelled before anything else does, so that a crash does not bring the job back. */
static int write_cancelled(const struct orl_jobs_job *job, struct orl_error *err)
{
    struct orl_job_row row = job->row;
    row.state = ORL_JOB_CANCELLED;
    row.finished_ms = orl_time_now_ms();
    return orl_job_row_update(job->jobs->env.db, &row, err);
}

/* In memory it runs on until its threads have heard. Should it succeed first, its row is written
 * once more. */
static void cancel_running(struct orl_jobs_job *job)
{
    job->cancelled = true;
    if (job->worker) /* else it has come to its end, and is about to say so */
        orl_worker_cancel(job->worker);
}

/* One that waits: who follows it goes on, and the first of them leads. */
static void cancel_queued(struct orl_jobs_job *job)
{
    struct orl_jobs_job *followers = job->followers;
    if (job->leader) {
        orl_share_leave(job);
    } else {
        orl_queue_remove(job->jobs->queue, &job->waiting);
        orl_runs_lead_no_more(job);
        job->followers = NULL;
    }
    orl_jobs_set_state(job, ORL_JOB_CANCELLED);
    forget_partial(job);
    while (followers) {
        struct orl_jobs_job *next = followers->next_follower;
        followers->leader = NULL;
        followers->next_follower = NULL;
        orl_runs_enqueue(followers);
        followers = next;
    }
}

/* One that shares its computation, which goes on while anybody wants it. */
static void cancel_sharing(struct orl_jobs_job *job)
{
    struct orl_jobs_job *leader = job->leader ? job->leader : job;
    if (job->leader)
        orl_share_leave(job);
    orl_jobs_set_state(job, ORL_JOB_CANCELLED);
    if (!leader->followers && leader->row.state == ORL_JOB_CANCELLED && leader->worker)
        orl_worker_cancel(leader->worker);
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
        cancel_sharing(job);
    return 0;
}

bool orl_jobs_ended(const struct orl_jobs_job *job)
{
    return job->row.state > ORL_JOB_RUNNING && !job->worker && !job->leader && !job->followers;
}

bool orl_jobs_need_scene(const struct orl_jobs *jobs, const char *scene)
{
    const struct orl_jobs_job *job = jobs->newest;
    while (job && (orl_jobs_ended(job) || strcmp(job->row.scene, scene) != 0))
        job = job->older;
    return job != NULL;
}

/* Its row is gone. */
static void forget(struct orl_jobs_job *job)
{
    struct orl_jobs *jobs = job->jobs;
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job-removed", "s", "job", job->row.id);
    jobs->env.leaving(jobs->env.ctx, job);
    note_saved(job, true); /* there is nothing left to save */
    orl_job_results_discard(job);
    orl_blobs_forget(jobs->env.blobs, job->row.document);
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
        forget(job);
    return rc;
}

void orl_jobs_remove_ended(struct orl_jobs *jobs, struct orl_jobs_job *const *ended, size_t count)
{
    struct orl_error err;
    int rc = orl_db_exec(jobs->env.db, "BEGIN IMMEDIATE", &err);
    const bool begun = rc == 0;
    for (size_t i = 0; i < count && rc == 0; i++)
        rc = orl_job_row_drop(jobs->env.db, ended[i]->row.seq, &err);
    if (rc == 0)
        rc = orl_db_exec(jobs->env.db, "COMMIT", &err);
    if (begun && rc)
        orl_db_exec(jobs->env.db, "ROLLBACK", NULL);
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_WARN, "job-row-failed", "s", "why", err.message);
    for (size_t i = 0; i < count && rc == 0; i++)
        forget(ended[i]);
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
