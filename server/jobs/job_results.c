#include "jobs/job_results.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>

#include <oriel/base/json_read.h>

#include "jobs/job_runs.h"
#include "process/times.h"
#include "store/files/removal.h"

static void results_path(const struct orl_jobs *jobs, const char *id, char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(jobs->env.folders, ret_path, "results/%s", id);
}

bool orl_job_results_exist(const struct orl_jobs_job *job)
{
    const bool has_some = job->row.state == ORL_JOB_SUCCEEDED ||
                          (job->row.state == ORL_JOB_CANCELLED && job->outcome);
    return has_some && job->row.evicted_ms == 0;
}

uint64_t orl_job_results_bytes(const struct orl_jobs *jobs)
{
    return jobs->result_bytes;
}

uint64_t orl_job_results_expected(const struct orl_jobs *jobs)
{
    return jobs->expected_bytes;
}

bool orl_job_results_count(const char *text, uint64_t *ret_bytes)
{
    json_t *outcome = orl_json_read_stored(text);
    const json_t *entry;
    size_t i;
    *ret_bytes = 0;
    json_array_foreach(json_object_get(outcome, "files"), i, entry)
    {
        *ret_bytes += (uint64_t)json_integer_value(json_object_get(entry, "bytes"));
    }
    json_decref(outcome);
    return outcome != NULL;
}

void orl_job_results_set_final(struct orl_jobs_job *job, enum orl_job_state state)
{
    struct orl_jobs *jobs = job->jobs;
    if (job->row.state <= ORL_JOB_RUNNING)
        jobs->expected_bytes -= job->row.result_bytes;
    const bool has_some = state == ORL_JOB_SUCCEEDED || state == ORL_JOB_CANCELLED;
    job->row.result_bytes = has_some ? job->outcome_bytes : 0;
    jobs->result_bytes += job->row.result_bytes;
}

double orl_job_results_error(struct orl_jobs *jobs, const char *id)
{
    struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    if (!job || job->row.state <= ORL_JOB_RUNNING)
        return (double)NAN;
    if (!job->measured) {
        json_t *outcome = orl_json_read_stored(job->outcome);
        const json_t *achieved = json_object_get(json_object_get(outcome, "accuracy"), "achieved");
        job->achieved = json_is_number(achieved) ? json_number_value(achieved) : (double)NAN;
        job->measured = true;
        json_decref(outcome);
    }
    return job->achieved;
}

/* ---- Last use ------------------------------------------------------------------------------- */

void orl_job_results_fetched(struct orl_jobs *jobs, const char *id)
{
    struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    if (!job)
        return;
    job->row.fetched_ms = orl_time_now_ms();
    job->fetched = true;
}

/* Writes all times in one transaction. If it fails, only these uses are forgotten. */
void orl_job_results_flush(struct orl_jobs *jobs)
{
    struct orl_error err;
    bool begun = false;
    int rc = 0;
    for (struct orl_jobs_job *job = jobs->newest; job && rc == 0; job = job->older) {
        if (!job->fetched)
            continue;
        if (!begun)
            rc = orl_db_begin(jobs->env.db, &err);
        begun = rc == 0;
        if (begun)
            rc = orl_job_row_update(jobs->env.db, &job->row, &err);
        job->fetched = rc != 0;
    }
    if (begun)
        rc = orl_db_end(jobs->env.db, rc, &err);
    if (rc)
        orl_log_event(jobs->env.log, ORL_LOG_WARN, "job-row-failed", "s", "why", err.message);
}

int64_t orl_job_results_used_ms(const struct orl_jobs_job *job)
{
    const struct orl_job_row *row = &job->row;
    return row->fetched_ms > row->finished_ms ? row->fetched_ms : row->finished_ms;
}

/* ---- Removal -------------------------------------------------------------------------------- */

void orl_job_results_remove_files(const struct orl_jobs *jobs, const char *id)
{
    char path[ORL_PATH_MAX];
    results_path(jobs, id, path);
    orl_remove_async(jobs->env.loop, jobs->env.folders, path);
}

void orl_job_results_discard(struct orl_jobs_job *job)
{
    if (!orl_job_results_exist(job))
        return;
    const struct orl_jobs_env *env = &job->jobs->env;
    char path[ORL_PATH_MAX];
    job->jobs->result_bytes -= job->row.result_bytes;
    results_path(job->jobs, job->row.id, path);
    orl_remove_when_durable(env->wal_sync, env->loop, env->folders, path);
}

int orl_job_results_mark_evicted(struct orl_jobs *jobs, const char *id, struct orl_error *err)
{
    const struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    if (!job || !orl_job_results_exist(job))
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the job has no results");
    struct orl_job_row row = job->row;
    row.evicted_ms = orl_time_now_ms();
    return orl_job_row_update(jobs->env.db, &row, err);
}

void orl_job_results_delete_files(struct orl_jobs *jobs, const char *id)
{
    struct orl_jobs_job *job = orl_jobs_lookup(jobs, id);
    orl_job_results_discard(job);
    job->row.evicted_ms = orl_time_now_ms();
}

/* ---- Start ---------------------------------------------------------------------------------- */

/* Removes the results of an ended job that should have none. Results of a job that the database
 * does not know, or whose row has not ended, are set aside: the database may be an older copy. */
static void sweep_results(struct orl_jobs *jobs, const struct orl_jobs_job *job, const char *id)
{
    char path[ORL_PATH_MAX];
    struct orl_error err;
    if (job && job->row.state > ORL_JOB_RUNNING) {
        results_path(jobs, id, path);
        orl_remove_tree(path, NULL);
        return;
    }
    snprintf(path, sizeof path, "results/%.255s", id);
    if (orl_orphan_set_aside(jobs->env.folders, path, &err))
        orl_log_event(jobs->env.log, ORL_LOG_WARN, "orphan-left", "ss", "what", path, "why",
                      err.message);
}

void orl_job_results_sweep(struct orl_jobs *jobs)
{
    char path[ORL_PATH_MAX];
    for (const struct orl_jobs_job *job = jobs->newest; job; job = job->older)
        jobs->result_bytes += orl_job_results_exist(job) ? job->row.result_bytes : 0;
    orl_folders_path(jobs->env.folders, path, "results");
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        const struct orl_jobs_job *job = orl_jobs_lookup(jobs, entry->d_name);
        if (entry->d_name[0] == '.' || (job && orl_job_results_exist(job)))
            continue;
        sweep_results(jobs, job, entry->d_name);
    }
    if (folder)
        closedir(folder);
}
