#include "handlers/jobs/job_summary.h"

#include <math.h>

#include "handlers/jobs/job_status.h"
#include "jobs/job_results.h"
#include "json/encode.h"

/* The state of a running job. */
struct running {
    const char *stage; /* NULL: unknown */
    double percent, eta_s, error;
};

static struct running read_progress(const struct orl_jobs_job *job)
{
    struct running seen = {NULL, (double)NAN, (double)NAN, (double)NAN};
    struct orl_job_progress progress;
    if (job->row.state == ORL_JOB_SUCCEEDED)
        seen.percent = 100;
    if (job->row.state != ORL_JOB_RUNNING || !orl_jobs_worker(job))
        return seen;
    orl_worker_progress(orl_jobs_worker(job), &progress);
    if (job->row.kind != ORL_JOB_KIND_STUDY)
        seen.stage = orl_stage_name(progress.stage);
    else if (progress.step.runs > 0)
        seen.stage = orl_study_step_name(&progress.step);
    seen.percent = floor(1000 * progress.job_fraction) / 10;
    seen.eta_s = round(progress.eta_s);
    if (progress.outcome.asked)
        seen.error = progress.outcome.achieved;
    return seen;
}

json_t *orl_job_summary(struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    const struct orl_job_row *row = &job->row;
    struct running seen = read_progress(job);
    if (row->state > ORL_JOB_RUNNING)
        seen.error = orl_job_results_error(jobs, row->id);
    json_t *doc = json_pack(
        "{s:s, s:s?, s:o, s:s, s:s, s:s, s:s, s:i, s:s?, s:o, s:o, s:o, s:o, s:o, s:o}", "id",
        row->id, "name", row->name, "tags", orl_job_tags(job), "kind",
        orl_job_request_kind_name(row->kind), "state", orl_jobs_state_name(job), "scene",
        row->scene, "client", row->client, "priority", row->priority, "stage", seen.stage,
        "percent", orl_json_from_real(seen.percent), "eta_s", orl_json_from_real(seen.eta_s),
        "error", orl_json_from_real(seen.error), "created", orl_job_time(row->created_ms),
        "started", orl_job_time(row->started_ms), "finished", orl_job_time(row->finished_ms));
    if (doc && row->state == ORL_JOB_QUEUED &&
        json_object_set_new(doc, "queue_position",
                            json_integer((json_int_t)orl_jobs_position(jobs, job)))) {
        json_decref(doc);
        return NULL;
    }
    return doc;
}
