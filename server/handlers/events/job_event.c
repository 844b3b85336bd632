#include "handlers/events/events.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/json_read.h>

#include "handlers/jobs/job_status.h"
#include "runner/runner.h"
#include "json/encode.h"

/* The contents of an event. Progress is in tenths of a percent, so that a long job does not send a
 * thousand events a second. */
struct event {
    const char *stage; /* NULL: none */
    int permille;      /* -1: unknown */
    double eta_s;
    uint32_t rounds;
    size_t views, skies;
    size_t points, position;
    size_t n_warnings; /* so far, of a running job */
    bool in_parts;
    struct orl_parts_count parts;
};

/* Returns the warnings of an ended job's outcome as a new reference, or NULL if there are none.
 * False: no memory. */
static bool final_warnings(const struct orl_jobs_job *job, json_t **ret_warnings)
{
    json_t *outcome = job->outcome ? orl_json_read_stored(job->outcome) : NULL;
    *ret_warnings = json_incref(json_object_get(outcome, "warnings"));
    json_decref(outcome);
    return outcome || !job->outcome;
}

static struct event read_event(const struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    struct event event = {.permille = -1, .eta_s = NAN};
    struct orl_job_progress progress;
    if (job->row.state == ORL_JOB_QUEUED)
        event.position = orl_jobs_position(jobs, job);
    if (job->row.state == ORL_JOB_SUCCEEDED)
        event.permille = 1000;
    if (job->row.state != ORL_JOB_RUNNING || !orl_jobs_worker(job))
        return event;
    orl_worker_progress(orl_jobs_worker(job), &progress);
    if (job->row.kind != ORL_JOB_KIND_STUDY)
        event.stage = orl_stage_name(progress.stage);
    else if (progress.step.runs > 0)
        event.stage = orl_study_step_name(&progress.step);
    event.permille = (int)(1000 * progress.job_fraction);
    event.eta_s = round(10 * progress.eta_s) / 10;
    event.rounds = progress.outcome.asked ? progress.outcome.rounds : progress.year.rounds;
    event.views = progress.n_views;
    event.skies = progress.skies_done;
    event.points = progress.n_points;
    event.n_warnings = progress.n_warnings;
    event.in_parts = progress.in_parts;
    event.parts = progress.parts;
    return event;
}

void orl_job_event_id(const struct orl_jobs *jobs, const struct orl_jobs_job *job,
                      char ret_id[ORL_JOB_EVENT_ID])
{
    const struct event event = read_event(jobs, job);
    snprintf(ret_id, ORL_JOB_EVENT_ID, "%s-%d-%s-%d-%u-%zu-%zu-%zu-%zu-%zu-%llu.%llu.%llu",
             orl_jobs_state_name(job), job->row.attempts, event.stage ? event.stage : "",
             event.permille, event.rounds, event.views, event.skies, event.points, event.n_warnings,
             event.position, (unsigned long long)event.parts.done,
             (unsigned long long)event.parts.running, (unsigned long long)event.parts.again);
}

/* Returns the warnings of a running or ended job, like final_warnings. */
static bool list_warnings(const struct orl_jobs_job *job, json_t **ret_warnings)
{
    struct orl_job_progress progress;
    if (job->row.state != ORL_JOB_RUNNING || !orl_jobs_worker(job))
        return final_warnings(job, ret_warnings);
    orl_worker_progress(orl_jobs_worker(job), &progress);
    *ret_warnings = orl_job_warnings(&progress);
    return *ret_warnings != NULL;
}

json_t *orl_job_event(const struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    const struct event event = read_event(jobs, job);
    const bool runs = job->row.state == ORL_JOB_RUNNING;
    json_t *doc =
        json_pack("{s:s, s:s, s:s?, s:o, s:o}", "id", job->row.id, "state",
                  orl_jobs_state_name(job), "stage", event.stage, "percent",
                  orl_json_from_real(event.permille < 0 ? (double)NAN : event.permille / 10.0),
                  "eta_s", orl_json_from_real(event.eta_s));
    json_t *warnings = NULL;
    int rc = list_warnings(job, &warnings) ? 0 : -1;
    if (json_array_size(warnings) > 0)
        rc |= json_object_set(doc, "warnings", warnings);
    json_decref(warnings);
    if (event.position > 0)
        rc |= json_object_set_new(doc, "queue_position", json_integer((json_int_t)event.position));
    if (event.rounds > 0)
        rc |= json_object_set_new(doc, "rounds", json_integer(event.rounds));
    if (event.views > 0)
        rc |= json_object_set_new(doc, "views", json_integer((json_int_t)event.views));
    if (event.skies > 0)
        rc |= json_object_set_new(doc, "skies", json_integer((json_int_t)event.skies));
    if (runs && job->row.kind == ORL_JOB_KIND_STUDY)
        rc |= json_object_set_new(doc, "points", json_integer((json_int_t)event.points));
    if (event.in_parts)
        rc |= json_object_set_new(doc, "parts", orl_parts_to_json(&event.parts));
    if (runs)
        rc |= json_object_set_new(doc, "cancelling", json_boolean(job->cancelled));
    return orl_json_checked(doc, rc);
}
