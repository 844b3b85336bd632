#include "jobs/result_fanout.h"

#include <stdlib.h>
#include <string.h>

#include "jobs/job_dedup.h"
#include "jobs/job_results.h"
#include "jobs/job_runs.h"

struct copy {
    char id[ORL_JOB_ID];
    int code;
    struct orl_error err;
};

struct orl_result_fanout {
    uv_work_t work;
    struct orl_jobs_job *leader;
    struct orl_worker_outcome outcome;
    orl_result_fanout_done *done;
    size_t count;
    struct copy copies[];
};

static void link_results(uv_work_t *work)
{
    struct orl_result_fanout *fanout = work->data;
    const struct orl_folders *folders = fanout->leader->jobs->env.folders;
    for (size_t i = 0; i < fanout->count; i++) {
        struct copy *copy = &fanout->copies[i];
        copy->code = orl_dedup_link_results(folders, fanout->leader->row.id, copy->id, &copy->err);
    }
}

static void end_fanout(uv_work_t *work, int status)
{
    struct orl_result_fanout *fanout = work->data;
    const struct orl_jobs *jobs = fanout->leader->jobs;
    (void)status;
    fanout->leader->finishing = false;
    for (size_t i = 0; i < fanout->count; i++) {
        const struct orl_jobs_job *job = orl_jobs_lookup(jobs, fanout->copies[i].id);
        if (!job || job->leader != fanout->leader) /* it was cancelled meanwhile */
            orl_job_results_remove_files(jobs, fanout->copies[i].id);
    }
    fanout->done(fanout->leader, &fanout->outcome, fanout);
    free(fanout);
}

bool orl_result_fanout_start(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                             orl_result_fanout_done *done)
{
    size_t count = 0;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        count++;
    struct orl_result_fanout *fanout =
        count > 0 ? calloc(1, sizeof *fanout + count * sizeof *fanout->copies) : NULL;
    if (!fanout)
        return false;
    fanout->work.data = fanout;
    fanout->leader = leader;
    fanout->outcome = *outcome;
    fanout->done = done;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        memcpy(fanout->copies[fanout->count++].id, job->row.id, sizeof job->row.id);
    leader->finishing = true;
    uv_queue_work(leader->jobs->env.loop, &fanout->work, link_results, end_fanout);
    return true;
}

int orl_result_fanout_find(const struct orl_result_fanout *fanout,
                           const struct orl_jobs_job *leader, const struct orl_jobs_job *job,
                           struct orl_error *ret_err)
{
    for (size_t i = 0; fanout && i < fanout->count; i++)
        if (strcmp(fanout->copies[i].id, job->row.id) == 0) {
            *ret_err = fanout->copies[i].err;
            return fanout->copies[i].code;
        }
    return orl_dedup_link_results(job->jobs->env.folders, leader->row.id, job->row.id, ret_err);
}
