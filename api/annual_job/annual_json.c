#include "annual_job/annual_json.h"

#include <stdlib.h>
#include <string.h>

#include "annual_job/annual_members_json.h"
#include "schemas.h"
#include "json/decode.h"

/* Paths per sensor in the first round of a job with "accuracy". */
enum { FIRST_ROUND = 256 };

void orl_annual_job_done(struct orl_annual_job *job)
{
    if (!job)
        return;
    for (size_t i = 0; job->grid_files && i < job->request.n_grids; i++)
        free(job->grid_files[i]);
    free(job->grid_files);
    free(job->title);
    free(job->document);
    orl_annual_request_done(&job->request);
    orl_report_request_done(&job->report_request);
    *job = (struct orl_annual_job){.title = NULL};
}

/* ---- Occupancy ------------------------------------------------------------------------------- */

static int decode_day(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    unsigned day = 0;
    const struct orl_json_member word = {.word = &day};
    const int rc = orl_json_value(value, path, &orl_schema_weekday, &word, err);
    if (rc == 0)
        *(unsigned *)into |= 1U << day;
    return rc;
}

static int decode_days(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    unsigned days = 0;
    const int rc = orl_json_each(value, path, &orl_schema_occupancy_days, decode_day, &days, err);
    if (rc == 0)
        *(unsigned *)into = days;
    return rc;
}

static int decode_occupancy(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_report_request *report_request = into;
    struct orl_occupancy *use = &report_request->occupancy;
    const struct orl_json_member members[] = {{"file", .text = &report_request->occupancy_file},
                                              {"from", .real = &use->from_h},
                                              {"to", .real = &use->to_h},
                                              {"days", .decode = decode_days, .into = &use->days},
                                              {"first_day", .word = &use->first_day},
                                              {0}};
    const int rc = orl_json_members(value, path, &orl_schema_occupancy, members, err);
    if (rc == 0 && report_request->occupancy_file && json_object_size(value) > 1)
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "\"file\" gives the whole occupancy: leave the other members out");
    return rc;
}

/* ---- Metrics, targets, rules ----------------------------------------------------------------- */

/* Decodes a string and parses it with parse. */
static int decode_words(const json_t *value, const char *path, const struct orl_json_schema *schema,
                        int (*parse)(const char *text, void *into, struct orl_error *err),
                        void *into, struct orl_error *err)
{
    struct orl_error found = {0};
    char *text = NULL;
    int rc = orl_json_text_of(value, path, schema, &text, err);
    if (rc)
        return rc;
    rc = parse(text, into, &found);
    free(text);
    if (rc) {
        orl_json_fail(err, rc, path, "%s", found.message);
        orl_error_hint(err, "%s", found.hint);
    }
    return rc;
}

static int parse_metric(const char *text, void *into, struct orl_error *err)
{
    return orl_annual_metric_parse(text, into, err);
}

static int parse_target(const char *text, void *into, struct orl_error *err)
{
    return orl_annual_target_parse(text, into, err);
}

static int decode_metric(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, &orl_schema_short_text, parse_metric, into, err);
}

static int decode_target(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, &orl_schema_target_text, parse_target, into, err);
}

/* Adds all rules whose name begins with text. */
static int add_rules(const char *text, void *into, struct orl_error *err)
{
    struct orl_report_request *report_request = into;
    const struct orl_annual_rule *first;
    size_t count;
    const int rc = orl_annual_rules_find(text, &first, &count, err);
    if (rc)
        return rc;
    const size_t n = report_request->n_rules + count;
    struct orl_annual_rule *grown = realloc(report_request->rules, n * sizeof *grown);
    if (!grown)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < count; i++)
        grown[report_request->n_rules + i] = first[i];
    report_request->rules = grown;
    report_request->n_rules = n;
    return 0;
}

static int decode_rule(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, &orl_schema_short_text, add_rules, into, err);
}

static int decode_rules(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_each(value, path, &orl_schema_annual_request_rules, decode_rule, into, err);
}

/* Fails if two metrics have one name, because a metric is reported once and its files are named by
 * it. */
static int check_metrics(const struct orl_report_request *report_request, const char *path,
                         struct orl_error *err)
{
    char name[64], other[64];
    for (size_t i = 1; i < report_request->n_metrics; i++) {
        orl_annual_metric_file(&report_request->metrics[i], name, sizeof name);
        for (size_t k = 0; k < i; k++) {
            orl_annual_metric_file(&report_request->metrics[k], other, sizeof other);
            if (strcmp(name, other) == 0)
                return orl_json_fail(err, ORL_ERR_INVALID, path, "the metric %s is listed twice",
                                     name);
        }
    }
    return 0;
}

static int decode_metrics(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_report_request *report_request = into;
    const struct orl_json_list list = {.items = &report_request->metrics,
                                       .count = &report_request->n_metrics,
                                       .size = sizeof *report_request->metrics,
                                       .each = decode_metric};
    free(report_request->metrics);
    report_request->metrics = NULL;
    report_request->n_metrics = 0;
    const int rc = orl_json_list(value, path, &orl_schema_annual_request_metrics, &list, err);
    return rc ? rc : check_metrics(report_request, path, err);
}

/* ---- The document ---------------------------------------------------------------------------- */

static int decode_until(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_report_request *report_request = into;
    report_request->until = calloc(1, sizeof *report_request->until);
    return report_request->until ? decode_target(value, path, report_request->until, err)
                                 : orl_error_no_memory(err);
}

static int decode_format(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_annual_formats *formats = into;
    bool *const flags[] = {&formats->honeybee, &formats->matrices, &formats->coefficients,
                           &formats->phases};
    unsigned which = 0;
    const struct orl_json_member word = {.word = &which};
    const int rc = orl_json_value(value, path, orl_schema_annual_request_formats.items, &word, err);
    if (rc == 0)
        *flags[which] = true;
    return rc;
}

static int decode_formats(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_each(value, path, &orl_schema_annual_request_formats, decode_format, into, err);
}

/* Refuses settings that only path tracing supports. */
static int check_precomputed(const struct orl_annual_job *job, struct orl_error *err)
{
    if (job->request.technique != ORL_ANNUAL_PRECOMPUTED)
        return 0;
    if (job->report_request.glare.n_viewpoints > 0)
        return orl_json_fail(err, ORL_ERR_UNSUPPORTED, "glare",
                             "glare needs the technique \"paths\": leave \"technique\" out");
    if (job->formats.phases)
        return orl_json_fail(
            err, ORL_ERR_UNSUPPORTED, "formats",
            "phase matrices need the technique \"paths\": leave \"technique\" out");
    return 0;
}

static int decode_members(const json_t *doc, struct orl_annual_job *job, struct orl_error *err)
{
    struct orl_annual_request *request = &job->request;
    struct orl_report_request *report_request = &job->report_request;
    unsigned technique = ORL_ANNUAL_BY_PATHS, sun_method = ORL_SUN_ACCURATE;
    const struct orl_json_list targets = {.items = &report_request->targets,
                                          .count = &report_request->n_targets,
                                          .size = sizeof *report_request->targets,
                                          .each = decode_target};
    const struct orl_json_member accuracy[] = {
        {"verdict", .decode = decode_until, .into = report_request}, {0}};
    const struct orl_json_member members[] = {
        {.name = "kind"},
        {"title", .text = &job->title},
        {.name = "scene"}, /* scene, grids and sensors are decoded after the rest */
        {.name = "grids"},
        {.name = "sensors"},
        {"weather", .text = &request->weather_file},
        {"year", .whole_int = &request->weather_year},
        {"north", .real = &request->north_deg},
        {"ground_reflectance", .real = &request->ground_reflectance},
        {"sun", .word = &sun_method},
        {"matrices", .decode = orl_annual_matrices_from_json, .into = request},
        {"shades", .decode = orl_annual_shades_from_json, .into = request},
        {"occupancy", .decode = decode_occupancy, .into = report_request},
        {"metrics", .decode = decode_metrics, .into = report_request},
        {"targets", .list = &targets},
        {"rules", .decode = decode_rules, .into = report_request},
        {"samples", .whole_32 = &request->samples},
        {"sun_halvings", .whole_32 = &request->sun_halvings},
        {"technique", .word = &technique},
        {"photons", .whole_32 = &request->photons},
        {"seed", .whole = &request->seed},
        {"median_diffuse", .real = &report_request->median_diffuse_lx},
        {"exposure", .decode = orl_annual_exposure_from_json, .into = &report_request->exposure},
        {"glare", .decode = orl_annual_glare_from_json, .into = &report_request->glare},
        {"view_out", .decode = orl_annual_view_out_from_json, .into = &report_request->view_out},
        {"accuracy", .members = accuracy},
        {"formats", .decode = decode_formats, .into = &job->formats},
        {.name = "priority"},
        {.name = "name"},
        {.name = "tags"},
        {0}};
    int rc = orl_json_members(doc, "", &orl_schema_annual_request, members, err);
    request->technique = (enum orl_annual_technique)technique;
    request->sun_method = (enum orl_sun_method)sun_method;
    request->coefficients = job->formats.coefficients;
    if (rc == 0)
        rc = check_precomputed(job, err);
    if (rc == 0 && request->coefficients && report_request->until)
        return orl_json_fail(err, ORL_ERR_INVALID, "formats",
                             "daylight coefficients need a single run: leave \"accuracy\" out");
    if (rc == 0 && job->formats.phases && (report_request->until || request->n_terms > 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "formats",
                             "phase matrices need a single run by path tracing: leave \"accuracy\" "
                             "and \"matrices\" out");
    if (rc == 0 && report_request->until && request->samples == 0)
        request->samples = FIRST_ROUND;
    return rc;
}

static int decode_document(const json_t *doc, enum orl_job_origin origin,
                           struct orl_annual_job *job, char **ret_scene_id, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (json_is_object(doc) && (!kind || strcmp(kind, "annual") != 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "kind",
                             "an annual job needs \"kind\": \"annual\"");
    const int rc = decode_members(doc, job, err);
    return rc ? rc : orl_annual_grids_from_json(doc, origin, job, ret_scene_id, err);
}

/* Keeps a copy of the document without the members for the queue. */
static int keep_document(const json_t *doc, struct orl_annual_job *job, struct orl_error *err)
{
    static const char *const not_kept[] = {"priority", "name", "tags"};
    json_t *copy = json_copy((json_t *)(uintptr_t)doc);
    for (size_t i = 0; copy && i < sizeof not_kept / sizeof *not_kept; i++)
        json_object_del(copy, not_kept[i]);
    job->document = copy ? json_dumps(copy, JSON_COMPACT) : NULL;
    json_decref(copy);
    return job->document ? 0 : orl_error_no_memory(err);
}

int orl_annual_job_validate(const struct orl_annual_job *job, struct orl_error *err)
{
    const struct orl_annual_request *request = &job->request;
    const int rc = orl_annual_validate_numbers(request, err);
    return rc ? rc : orl_report_request_validate(request, &job->report_request, err);
}

int orl_annual_job_from_json(const json_t *doc, enum orl_job_origin origin,
                             struct orl_annual_job *ret_job, char **ret_scene_id,
                             struct orl_error *err)
{
    struct orl_annual_job job = {.title = NULL};
    char *scene_id = NULL;
    orl_annual_request_init(&job.request);
    int rc = orl_report_request_init(&job.report_request);
    if (rc)
        orl_error_set(err, rc, "out of memory");
    else
        rc = decode_document(doc, origin, &job, &scene_id, err);
    if (rc == 0)
        rc = keep_document(doc, &job, err);
    if (rc)
        orl_annual_job_done(&job);
    else
        *ret_job = job;
    return orl_json_return_text(scene_id, ret_scene_id, rc);
}
