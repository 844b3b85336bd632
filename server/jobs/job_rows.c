/* The states of jobs, in memory and in their rows. Failed writes are tried again. */
#include <stddef.h>
#include <stdlib.h>

#include "jobs/job_results.h"
#include "jobs/job_runs.h"
#include "process/times.h"
#include "json/encode.h"
#include "json/problem.h"

void orl_job_note_saved(struct orl_jobs_job *job, bool saved)
{
    job->jobs->n_unsaved += (size_t)!saved - (size_t)job->unsaved;
    job->unsaved = !saved;
    if (saved)
        job->commit = orl_wal_sync_last_commit(job->jobs->env.wal_sync);
}

/* Writes the row that is right after a crash. */
static int write_row(const struct orl_jobs_job *job, struct orl_error *err)
{
    struct orl_job_row row = job->row;
    if (job->cancelled && row.state == ORL_JOB_RUNNING)
        row.state = ORL_JOB_CANCELLED;
    return orl_job_row_update(job->jobs->env.db, &row, err);
}

/* Writes all unsaved rows in one transaction. */
static int save_rows(struct orl_jobs *jobs, struct orl_error *err)
{
    size_t left = jobs->n_unsaved;
    int rc = left > 0 ? orl_db_begin(jobs->env.db, err) : 0;
    if (rc || left == 0)
        return rc;
    for (struct orl_jobs_job *job = jobs->newest; job && left > 0 && rc == 0; job = job->older)
        if (job->unsaved) {
            rc = write_row(job, err);
            left--;
        }
    rc = orl_db_end(jobs->env.db, rc, err);
    if (rc)
        return rc;
    for (struct orl_jobs_job *job = jobs->newest; job && jobs->n_unsaved > 0; job = job->older)
        if (job->unsaved)
            orl_job_note_saved(job, true);
    return 0;
}

void orl_jobs_save(struct orl_jobs *jobs)
{
    save_rows(jobs, NULL); /* after a failure the next call tries again */
}

void orl_jobs_batch_begin(struct orl_jobs *jobs)
{
    jobs->batch = true;
}

void orl_jobs_batch_end(struct orl_jobs *jobs)
{
    struct orl_error err;
    jobs->batch = false;
    if (save_rows(jobs, &err))
        orl_log_event(jobs->env.log, ORL_LOG_ERROR, "job-row-failed", "s", "why", err.message);
}

void orl_jobs_set_state(struct orl_jobs_job *job, enum orl_job_state state)
{
    struct orl_jobs *jobs = job->jobs;
    struct orl_error err;
    jobs->counts[job->row.state]--;
    jobs->counts[state]++;
    if (state > ORL_JOB_RUNNING)
        orl_job_results_set_final(job, state);
    job->row.state = state;
    job->row.outcome = job->outcome;
    job->row.problem = job->problem;
    if (state >= ORL_JOB_SUCCEEDED) {
        job->row.finished_ms = orl_time_now_ms();
        job->row.retained_ms = orl_retention_clock_ms(jobs->env.clock);
    }
    const int rc = jobs->batch ? 0 : orl_job_row_update(jobs->env.db, &job->row, &err);
    orl_job_note_saved(job, rc == 0 && !jobs->batch);
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_ERROR, "job-row-failed", "ss", "job", job->row.id,
                      "why", err.message);
    orl_log_event(jobs->env.log, ORL_LOG_INFO, "job", "ssi", "job", job->row.id, "state",
                  orl_job_state_name(state), "attempt", (int64_t)job->row.attempts);
    jobs->env.changed(jobs->env.ctx, job);
}

static void on_synced(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err)
{
    struct orl_jobs *jobs =
        (struct orl_jobs *)((char *)wait - offsetof(struct orl_jobs, sync_wait));
    jobs->sync_pending = false;
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_ERROR, "settling-failed", "s", "why", err->message);
}

void orl_jobs_request_sync(struct orl_jobs *jobs)
{
    if (jobs->sync_pending)
        return;
    jobs->sync_pending = true;
    jobs->sync_wait.synced = on_synced;
    orl_wal_sync_request(jobs->env.wal_sync, &jobs->sync_wait);
}

void orl_jobs_fail(struct orl_jobs_job *job, const struct orl_error *err)
{
    json_t *problem = orl_problem_from_error(err, NULL);
    char text[2 * ORL_ERROR_TEXT_MAX];
    free(job->problem);
    job->problem = orl_json_text(problem, JSON_COMPACT);
    json_decref(problem);
    orl_jobs_set_state(job, ORL_JOB_FAILED);
    orl_error_format(err, text, sizeof text);
    orl_log_event(job->jobs->env.log, ORL_LOG_WARN, "job-failed", "ss", "job", job->row.id, "why",
                  text);
}

bool orl_jobs_ended(const struct orl_jobs_job *job)
{
    return job->row.state > ORL_JOB_RUNNING && !job->worker && !job->leader && !job->followers;
}
