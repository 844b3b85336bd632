#include "jobs/job_limits.h"

#include "jobs/job_results.h"
#include "jobs/job_runs.h"
#include "process/limits.h"
#include "process/times.h"

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
        orl_jobs_remove_ended(jobs, going, count);
}

void orl_jobs_enforce_limits(struct orl_jobs *jobs)
{
    for (const struct orl_jobs_job *job = jobs->leaders; job; job = job->next_leader)
        orl_runs_log_parts(job);
    stop_timed_out(jobs);
    remove_old(jobs);
}
