/*
 * Annual documents, as the command line and the daemon read them. Input that is not JSON is parsed
 * as a target in words, or as a metric.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "annual_job/annual_json.h"
#include "fuzz/fuzz.h"
#include "json/decode.h"

static void check_metric(const struct orl_annual_metric *metric)
{
    char name[128];
    FUZZ_PROMISE(metric->kind < ORL_METRIC_KINDS && metric->when < ORL_WHEN_COUNT);
    FUZZ_PROMISE(metric->low_lx >= 0 && isfinite(metric->low_lx));
    FUZZ_PROMISE(metric->high_lx >= 0 && isfinite(metric->high_lx));
    memset(name, 'x', sizeof name);
    orl_annual_metric_name(metric, name, sizeof name);
    FUZZ_PROMISE(memchr(name, '\0', sizeof name) != NULL);
    orl_annual_metric_name(metric, name, 4);
    FUZZ_PROMISE(strlen(name) < 4);
}

/* Checks the verdicts on intervals far above, far below and on both sides of the bound. */
static void check_target(const struct orl_annual_target *target)
{
    struct orl_annual_target again;
    const struct orl_annual_value low = {-1, -1, -1}, high = {1e300, 1e300, 1e300},
                                  open = {1, -1, 1e300};
    check_metric(&target->figure.metric);
    FUZZ_PROMISE(target->bound >= 0 && isfinite(target->bound));
    FUZZ_PROMISE(target->figure.least >= 0 && isfinite(target->figure.least));
    FUZZ_PROMISE(strlen(target->grid) < ORL_TARGET_GRID && strlen(target->text) < ORL_TARGET_TEXT);
    FUZZ_PROMISE(orl_annual_target_parse(target->text, &again, NULL) == 0);
    FUZZ_PROMISE(again.bound == target->bound && again.relation == target->relation &&
                 strcmp(again.grid, target->grid) == 0);
    if (target->bound > 1e200)
        return;
    FUZZ_PROMISE(orl_annual_judge(target, &low) != orl_annual_judge(target, &high));
    FUZZ_PROMISE(orl_annual_judge(target, &open) == ORL_VERDICT_UNDECIDED);
}

static bool check_words(const char *text)
{
    struct orl_annual_target target;
    struct orl_annual_metric metric;
    struct orl_error err = {0};
    const int as_target = orl_annual_target_parse(text, &target, &err);
    if (as_target < 0)
        fuzz_check_error(as_target, &err);
    else
        check_target(&target);
    err = (struct orl_error){0};
    const int as_metric = orl_annual_metric_parse(text, &metric, &err);
    if (as_metric < 0)
        fuzz_check_error(as_metric, &err);
    else
        check_metric(&metric);
    return as_target == 0 || as_metric == 0;
}

static void check_request(const struct orl_annual_job *job, bool local)
{
    const struct orl_annual_request *request = &job->request;
    size_t sensors = 0;
    struct orl_error err = {0};
    FUZZ_PROMISE(local == (request->n_scene_files > 0) && request->n_grids > 0);
    for (size_t i = 0; i < request->n_grids; i++) {
        FUZZ_PROMISE(request->grids[i].name && request->grids[i].first == sensors);
        FUZZ_PROMISE((request->grids[i].count > 0) != (job->grid_files[i] != NULL));
        sensors += request->grids[i].count;
    }
    FUZZ_PROMISE(sensors == request->n_sensors);
    const int code = orl_annual_validate(request, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
}

static void check_report_request(const struct orl_report_request *report_request, size_t n_grids)
{
    for (size_t i = 0; i < report_request->n_metrics; i++)
        check_metric(&report_request->metrics[i]);
    for (size_t i = 0; i < report_request->n_targets; i++)
        check_target(&report_request->targets[i]);
    if (report_request->until)
        check_target(report_request->until);
    for (size_t i = 0; report_request->grid_area && i < n_grids; i++)
        FUZZ_PROMISE(report_request->grid_area[i] > 0);
    for (size_t i = 0; i < report_request->n_rules; i++)
        for (size_t k = 0; k < ORL_RULE_TARGETS && report_request->rules[i].targets[k]; k++)
            FUZZ_PROMISE(check_words(report_request->rules[i].targets[k]));
}

static bool check_document(const json_t *doc, enum orl_job_origin origin)
{
    struct orl_annual_job job;
    struct orl_error err = {0};
    char *id = NULL;
    const int code = orl_annual_job_from_json(doc, origin, &job, &id, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(id == NULL);
        return false;
    }
    FUZZ_PROMISE((origin == ORL_JOB_REMOTE) == (id != NULL));
    check_request(&job, origin == ORL_JOB_LOCAL);
    check_report_request(&job.report_request, job.request.n_grids);
    orl_annual_job_done(&job);
    free(id);
    return true;
}

bool fuzz_annual(const uint8_t *data, size_t size)
{
    struct orl_error err = {0};
    json_t *doc = NULL;
    const int code = orl_json_parse("year.json", (const char *)data, size, &doc, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        char *text = strndup((const char *)data, size);
        const bool accepted = text && check_words(text);
        free(text);
        return accepted;
    }
    bool accepted = check_document(doc, ORL_JOB_LOCAL);
    accepted |= check_document(doc, ORL_JOB_REMOTE);
    json_decref(doc);
    return accepted;
}
