#include "jobs/job_giving.h"

#include <stdlib.h>
#include <string.h>

#include "jobs/job_results.h"
#include "jobs/job_runs.h"
#include "jobs/job_share.h"

struct share {
    char id[ORL_JOB_ID];
    int code;
    struct orl_error err;
};

struct orl_giving {
    uv_work_t work;
    struct orl_jobs_job *leader;
    struct orl_worker_outcome outcome;
    orl_giving_done *done;
    size_t count;
    struct share each[];
};

static void link_results(uv_work_t *work)
{
    struct orl_giving *giving = work->data;
    const struct orl_folders *folders = giving->leader->jobs->env.folders;
    for (size_t i = 0; i < giving->count; i++) {
        struct share *share = &giving->each[i];
        share->code = orl_share_results(folders, giving->leader->row.id, share->id, &share->err);
    }
}

static void end_giving(uv_work_t *work, int status)
{
    struct orl_giving *giving = work->data;
    const struct orl_jobs *jobs = giving->leader->jobs;
    (void)status;
    giving->leader->settling = false;
    for (size_t i = 0; i < giving->count; i++) {
        const struct orl_jobs_job *job = orl_jobs_lookup(jobs, giving->each[i].id);
        if (!job || job->leader != giving->leader) /* it was cancelled meanwhile */
            orl_job_results_remove_files(jobs, giving->each[i].id);
    }
    giving->done(giving->leader, &giving->outcome, giving);
    free(giving);
}

bool orl_giving_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                      orl_giving_done *done)
{
    size_t count = 0;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        count++;
    struct orl_giving *giving =
        count > 0 ? calloc(1, sizeof *giving + count * sizeof *giving->each) : NULL;
    if (!giving)
        return false;
    giving->work.data = giving;
    giving->leader = leader;
    giving->outcome = *outcome;
    giving->done = done;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        memcpy(giving->each[giving->count++].id, job->row.id, sizeof job->row.id);
    leader->settling = true;
    uv_queue_work(leader->jobs->env.loop, &giving->work, link_results, end_giving);
    return true;
}

int orl_giving_find(const struct orl_giving *giving, const struct orl_jobs_job *leader,
                    const struct orl_jobs_job *job, struct orl_error *ret_err)
{
    for (size_t i = 0; giving && i < giving->count; i++)
        if (strcmp(giving->each[i].id, job->row.id) == 0) {
            *ret_err = giving->each[i].err;
            return giving->each[i].code;
        }
    return orl_share_results(job->jobs->env.folders, leader->row.id, job->row.id, ret_err);
}
