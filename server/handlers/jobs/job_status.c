#include "handlers/jobs/job_status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>

#include "annual_job/annual_json.h"
#include "http/context.h"
#include "http/response/reply.h"
#include "job/study_json.h"
#include "jobs/job_results.h"
#include "process/times.h"
#include "result/result_json.h"
#include "runner/runner.h"
#include "server.h"
#include "json/encode.h"

/* Returns a time in milliseconds since 1970 as text, or null for 0. A new reference. */
static json_t *time_to_json(int64_t ms)
{
    char text[ORL_TIME_TEXT];
    if (ms == 0)
        return json_null();
    orl_time_format(ms, text);
    return json_string(text);
}

/* Returns the seconds that a running job has left, to a tenth, or null. A new reference. */
static json_t *eta_to_json(const struct orl_job_progress *progress)
{
    return orl_json_from_real(round(10 * progress->eta_s) / 10);
}

/* Returns the job's tags: a new reference; NULL when out of memory. */
static json_t *tags_to_json(const struct orl_jobs_job *job)
{
    return job->row.tags ? orl_json_read_stored(job->row.tags) : json_array();
}

json_t *orl_job_warnings(const struct orl_job_progress *progress)
{
    json_t *warnings = json_array();
    for (size_t i = 0; i < progress->n_warnings; i++)
        warnings = orl_json_append(warnings, orl_json_from_text(progress->warnings[i]));
    return warnings;
}

/* Adds the number of skies, the number of finished ones, and the current one. */
static int add_skies(json_t *doc, const struct orl_job_progress *progress)
{
    const char *sky = *progress->sky ? progress->sky : NULL;
    return json_object_set_new(doc, "skies",
                               json_pack("{s:I, s:I, s:s*}", "count", (json_int_t)progress->n_skies,
                                         "done", (json_int_t)progress->skies_done, "running", sky));
}

static int add_stage(json_t *doc, const struct orl_job_progress *progress)
{
    int rc = json_object_set_new(doc, "stage", json_string(orl_stage_name(progress->stage)));
    rc |= json_object_set_new(doc, "stage_percent", json_real(100 * progress->stage_fraction));
    return rc | json_object_set_new(doc, "warnings", orl_job_warnings(progress));
}

static int add_render(json_t *doc, const struct orl_job_progress *progress)
{
    json_t *maps = json_array();
    int rc = maps ? 0 : -1;
    for (size_t i = 0; i < progress->n_maps && rc == 0; i++)
        rc = json_array_append_new(maps, orl_map_info_to_json(&progress->maps[i]));
    rc |= add_stage(doc, progress);
    if (progress->technique != ORL_TECHNIQUE_AUTO)
        rc |= json_object_set_new(doc, "technique",
                                  json_string(orl_technique_name(progress->technique)));
    rc |= json_object_set_new(doc, "maps", maps);
    if (progress->n_skies > 0)
        rc |= add_skies(doc, progress);
    if (progress->outcome.asked)
        rc |= json_object_set_new(doc, "accuracy", orl_outcome_to_json(&progress->outcome));
    return rc;
}

json_t *orl_job_file_url(const char *id, const char *name)
{
    char url[640];
    size_t at = (size_t)snprintf(url, sizeof url, "/v1/jobs/%s/files/", id);
    for (; *name && at + 4 < sizeof url; name++) {
        if (*name <= ' ' || *name > '~' || strchr("/%?#\"<>\\^`{|}", *name))
            at += (size_t)snprintf(url + at, sizeof url - at, "%%%02X", (unsigned char)*name);
        else
            url[at++] = *name;
    }
    url[at] = '\0';
    return json_string(url);
}

/* Adds links to the results that a summary lists. */
static int add_links(json_t *links, const char *id, const json_t *summary)
{
    json_t *files = json_array();
    const json_t *entry;
    size_t i;
    char url[320];
    bool has_result = false;
    int rc = 0;
    json_array_foreach(json_object_get(summary, "files"), i, entry)
    {
        const char *name = json_string_value(json_object_get(entry, "name"));
        has_result = has_result || strcmp(name, "result.json") == 0;
        rc |= json_array_append_new(files, orl_job_file_url(id, name));
    }
    rc |= json_object_set_new(links, "files", files);
    const char *bsdf = json_string_value(json_object_get(json_object_get(summary, "bsdf"), "id"));
    if (bsdf) {
        snprintf(url, sizeof url, "/v1/bsdfs/%.64s", bsdf);
        rc |= json_object_set_new(links, "bsdf", json_string(url));
    }
    if (!has_result)
        return rc;
    snprintf(url, sizeof url, "/v1/jobs/%s/result", id);
    return rc | json_object_set_new(links, "result", json_string(url));
}

/* Adds the current run and the points so far. */
static int add_study(json_t *doc, const struct orl_job_progress *progress)
{
    const struct orl_study_step *step = &progress->step;
    if (step->runs == 0) /* its first run has not started */
        return 0;
    json_t *study = orl_study_setting_to_json(&step->setting), *points = json_array();
    int rc = points ? 0 : -1;
    for (size_t i = 0; i < progress->n_points && rc == 0; i++)
        rc = json_array_append_new(points, orl_study_point_in_short(&progress->points[i]));
    rc |= json_object_set_new(study, "running", json_string(orl_study_step_name(step)));
    rc |= json_object_set_new(study, "run", json_integer(step->run));
    rc |= json_object_set_new(study, "runs", json_integer(step->runs));
    rc |= json_object_set_new(study, "settings", json_integer((json_int_t)progress->n_settings));
    rc |= json_object_set_new(study, "points", points);
    rc |= json_object_set_new(doc, "study", study);
    return rc;
}

/* Adds the state of the verdict, for a job that runs until its verdict is certain. */
static int add_annual(json_t *doc, const struct orl_job_progress *progress)
{
    const int rc = add_stage(doc, progress);
    return rc | json_object_set_new(
                    doc, "annual",
                    json_pack("{s:o}", "accuracy", orl_annual_refinement_to_json(&progress->year)));
}

static int add_bsdf(json_t *doc, const struct orl_job_progress *progress)
{
    json_t *maps = json_array();
    int rc = maps ? add_stage(doc, progress) : -1;
    for (size_t i = 0; i < progress->n_maps && rc == 0; i++)
        rc = json_array_append_new(maps, orl_map_info_to_json(&progress->maps[i]));
    return rc | json_object_set_new(doc, "maps", maps);
}

static int (*const add_kind[ORL_JOB_KIND_COUNT])(json_t *doc,
                                                 const struct orl_job_progress *progress) = {
    [ORL_JOB_KIND_RENDER] = add_render, [ORL_JOB_KIND_STUDY] = add_study,
    [ORL_JOB_KIND_ANNUAL] = add_annual, [ORL_JOB_KIND_BSDF_MAKE] = add_bsdf,
    [ORL_JOB_KIND_BSDF_FIT] = add_bsdf,
};

static int add_running(json_t *doc, json_t *links, const struct orl_jobs_job *job)
{
    struct orl_job_progress progress;
    char folder[ORL_PATH_MAX], *text = orl_worker_results(orl_jobs_worker(job), folder);
    json_t *summary = orl_json_read_stored(text);
    int rc = summary ? add_links(links, job->row.id, summary) : text ? -1 : 0;
    free(text);
    json_decref(summary);
    orl_worker_progress(orl_jobs_worker(job), &progress);
    rc |= add_kind[job->row.kind](doc, &progress);
    rc |= json_object_set_new(doc, "percent", json_real(100 * progress.job_fraction));
    rc |= json_object_set_new(doc, "eta_s", eta_to_json(&progress));
    rc |= json_object_set_new(doc, "cancelling", json_boolean(job->cancelled));
    rc |= json_object_set_new(doc, "shared", json_boolean(job->leader || job->followers));
    if (*progress.why_here)
        rc |= json_object_set_new(doc, "runner",
                                  orl_runner_to_json(progress.in_parts, progress.why_here,
                                                     progress.in_parts ? &progress.parts : NULL));
    return rc;
}

/* Works like json_object_update_missing, but also reports when there is no memory for a member. */
static int add_missing(json_t *doc, json_t *outcome)
{
    const char *key;
    json_t *value;
    int rc = outcome ? 0 : -1;
    json_object_foreach(outcome, key, value)
    {
        if (!json_object_get(doc, key))
            rc |= json_object_set(doc, key, value);
    }
    return rc;
}

static int add_finished(json_t *doc, json_t *links, const struct orl_jobs_job *job)
{
    int rc = 0;
    if (job->row.state == ORL_JOB_FAILED && job->problem)
        rc = json_object_set_new(doc, "error", orl_json_read_stored(job->problem));
    if (job->row.state == ORL_JOB_FAILED || !job->outcome)
        return rc;
    json_t *outcome = orl_json_read_stored(job->outcome);
    if (job->row.evicted_ms > 0)
        rc = json_object_set_new(doc, "evicted", time_to_json(job->row.evicted_ms));
    else
        rc = add_links(links, job->row.id, outcome);
    if (job->row.state == ORL_JOB_SUCCEEDED)
        rc |= json_object_set_new(doc, "percent", json_real(100));
    rc |= add_missing(doc, outcome);
    json_decref(outcome);
    return rc;
}

/* Adds null for members that every status has, if they are missing. */
static int add_unknown(json_t *doc)
{
    static const char *const names[] = {"stage", "percent", "eta_s"};
    int rc = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!json_object_get(doc, names[i]))
            rc |= json_object_set_new(doc, names[i], json_null());
    return rc;
}

json_t *orl_job_status(const struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    const struct orl_job_row *row = &job->row;
    char self[80], cancel[96];
    snprintf(self, sizeof self, "/v1/jobs/%s", row->id);
    snprintf(cancel, sizeof cancel, "/v1/jobs/%s/cancel", row->id);
    json_t *doc = json_pack(
        "{s:s, s:s?, s:o, s:s, s:s, s:s, s:i, s:s, s:i, s:o, s:o, s:o, s:{s:s}}", "id", row->id,
        "name", row->name, "tags", tags_to_json(job), "kind", orl_job_request_kind_name(row->kind),
        "state", orl_jobs_state_name(job), "scene", row->scene, "priority", row->priority, "client",
        row->client, "attempts", row->attempts, "created", time_to_json(row->created_ms), "started",
        time_to_json(row->started_ms), "finished", time_to_json(row->finished_ms), "links", "self",
        self);
    if (!doc)
        return NULL;
    json_t *links = json_object_get(doc, "links");
    int rc = 0;
    if (row->state == ORL_JOB_QUEUED)
        rc = json_object_set_new(doc, "queue_position",
                                 json_integer((json_int_t)orl_jobs_position(jobs, job)));
    else if (row->state == ORL_JOB_RUNNING && orl_jobs_worker(job))
        rc = add_running(doc, links, job);
    else
        rc = add_finished(doc, links, job);
    if (row->state <= ORL_JOB_RUNNING)
        rc |= json_object_set_new(links, "cancel", json_string(cancel));
    rc |= add_unknown(doc);
    return orl_json_checked(doc, rc);
}

/* ---- The short form in lists ----------------------------------------------------------------- */

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
        row->id, "name", row->name, "tags", tags_to_json(job), "kind",
        orl_job_request_kind_name(row->kind), "state", orl_jobs_state_name(job), "scene",
        row->scene, "client", row->client, "priority", row->priority, "stage", seen.stage,
        "percent", orl_json_from_real(seen.percent), "eta_s", orl_json_from_real(seen.eta_s),
        "error", orl_json_from_real(seen.error), "created", time_to_json(row->created_ms),
        "started", time_to_json(row->started_ms), "finished", time_to_json(row->finished_ms));
    return orl_json_checked(
        doc, doc && row->state == ORL_JOB_QUEUED &&
                 json_object_set_new(doc, "queue_position",
                                     json_integer((json_int_t)orl_jobs_position(jobs, job))));
}

/* ---- The cache of ended jobs' documents ------------------------------------------------------ */

struct orl_status_cache *orl_status_cache_new(void)
{
    return calloc(1, sizeof(struct orl_status_cache));
}

void orl_status_cache_free(struct orl_status_cache *cache)
{
    for (size_t i = 0; cache && i < ORL_STATUS_CACHE; i++)
        free(cache->entries[i].text);
    free(cache);
}

/* Returns the job's entry. Ids are random hexadecimal digits, so the last few serve as the hash. */
static struct orl_status_entry *entry_of(struct orl_status_cache *cache, const char *id)
{
    char tail[5];
    memcpy(tail, id + ORL_JOB_ID - sizeof tail, sizeof tail);
    return &cache->entries[strtoul(tail, NULL, 16) % ORL_STATUS_CACHE];
}

/* Compares two rows bytewise. Padding may differ while all members are equal; the text is then made
 * again. */
static bool is_same(const void *row, const void *other)
{
    return memcmp(row, other, sizeof(struct orl_job_row)) == 0;
}

const char *orl_status_cache_text(struct orl_status_cache *cache, const struct orl_jobs *jobs,
                                  const struct orl_jobs_job *job, size_t *ret_size)
{
    struct orl_status_entry *entry = entry_of(cache, job->row.id);
    if (!entry->text || !is_same(&entry->row, &job->row)) {
        free(entry->text);
        entry->text = orl_reply_text_of(orl_job_status(jobs, job));
        entry->size = entry->text ? strlen(entry->text) : 0;
        memcpy(&entry->row, &job->row, sizeof job->row);
    }
    *ret_size = entry->size;
    return entry->text;
}

/* ---- The job in a request's path ------------------------------------------------------------- */

const struct orl_jobs_job *orl_job_of_path(struct orl_request *request)
{
    bool several = false;
    const struct orl_jobs_job *job =
        orl_jobs_find_prefix(request->server->jobs, request->params[0], &several);
    if (several)
        orl_reply_problem(request, 404, "ambiguous", "The id is ambiguous",
                          "the ids of several jobs begin with %.40s", request->params[0]);
    else if (!job)
        orl_reply_not_found(request, "job");
    else
        snprintf(request->job, sizeof request->job, "%s", job->row.id);
    return job;
}

void orl_job_reply_when_ended(struct orl_request *request, const struct orl_jobs_job *job)
{
    if (job->row.state >= ORL_JOB_SUCCEEDED)
        orl_reply_when_commit_durable(request, job->commit);
}
