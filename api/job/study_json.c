#include "job/study_json.h"

#include <math.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "job/job_members_json.h"
#include "schemas.h"
#include "json/decode.h"
#include "json/encode.h"

enum { TITLE_MAX = 90, NOTE_MAX = 2000, NAME_MAX_BYTES = 60, REPEATS_MAX = 1000 };
enum { SENSOR_RAYS_MAX = 1 << 24, PIXEL_PATHS_MAX = 1 << 20 };

/* Returns a job document of the members that a study shares with a job. */
static json_t *job_part(const json_t *doc)
{
    static const char *const shared[] = {"scene", "sky", "effects", "seed", "sensors", "views"};
    json_t *job = json_object();
    for (size_t i = 0; job && i < sizeof shared / sizeof *shared; i++) {
        json_t *value = json_object_get(doc, shared[i]);
        if (value && json_object_set(job, shared[i], value)) {
            json_decref(job);
            return NULL;
        }
    }
    return job;
}

static int decode_job(const json_t *doc, enum orl_job_origin origin, struct orl_job *ret_job,
                      char **ret_scene_id, struct orl_error *err)
{
    json_t *part = job_part(doc);
    struct orl_job job;
    if (!part)
        return orl_error_no_memory(err);
    const int rc = orl_job_from_json(part, origin, &job, ret_scene_id, err);
    json_decref(part);
    if (rc)
        return rc;
    orl_job_done(ret_job);
    *ret_job = job;
    return 0;
}

static int decode_technique(const json_t *value, const char *path, void *technique,
                            struct orl_error *err)
{
    return orl_technique_from_json(value, path, &orl_schema_study_technique, ORL_TECHNIQUE_AUTO + 1,
                                   technique, err);
}

static int decode_photons(const json_t *value, const char *path, void *photons,
                          struct orl_error *err)
{
    const struct orl_json_member number = {.whole = photons};
    return orl_json_value(value, path, orl_schema_study_request_photons.items, &number, err);
}

static int decode_rays(const json_t *value, const char *path, void *rays, struct orl_error *err)
{
    const struct orl_json_member number = {.whole_32 = rays};
    return orl_json_value(value, path, orl_schema_study_request_gather_samples.items, &number, err);
}

static int decode_paths(const json_t *value, const char *path, void *paths, struct orl_error *err)
{
    const struct orl_json_member number = {.whole_32 = paths};
    return orl_json_value(value, path, orl_schema_study_request_pixel_samples.items, &number, err);
}

static int decode_given(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_study_external *external = into;
    const struct orl_json_member members[] = {{"name", .text = &external->name},
                                              {"seconds", .real = &external->seconds},
                                              {"rms", .real = &external->rms},
                                              {"rays_per_s", .real = &external->rays_per_s},
                                              {0}};
    return orl_json_members(value, path, &orl_schema_study_given, members, err);
}

#define LIST(array, n, decoder)                                                                    \
    {                                                                                              \
        .items = &(array), .count = &(n), .size = sizeof *(array), .each = (decoder)               \
    }

/* views: true if views are measured, not sensors. */
static int decode_members(const json_t *doc, bool views, struct orl_study_request *r,
                          struct orl_error *err)
{
    const struct orl_json_list techniques = LIST(r->techniques, r->n_techniques, decode_technique);
    const struct orl_json_list photons = LIST(r->photons, r->n_photons, decode_photons);
    const struct orl_json_list samples =
        LIST(r->samples, r->n_samples, views ? decode_paths : decode_rays);
    const struct orl_json_list points = LIST(r->external, r->n_external, decode_given);
    const struct orl_json_member reference[] = {{"samples", .whole_32 = &r->reference_samples},
                                                {"runs", .whole_32 = &r->reference_runs},
                                                {0}};
    const struct orl_json_member members[] = {
        {.name = "kind"},
        {"title", .text = &r->title},
        {"note", .text = &r->note},
        {.name = "scene"}, /* this and the next five: decoded as the job's */
        {.name = "sky"},
        {.name = "effects"},
        {.name = "seed"},
        {.name = "sensors"},
        {.name = "views"},
        {"techniques", .list = &techniques},
        {"photons", .list = &photons},
        {"gather_samples", .list = views ? NULL : &samples},
        {"pixel_samples", .list = views ? &samples : NULL},
        {"repeats", .whole_32 = &r->repeats},
        {"reference", .members = reference},
        {"points", .list = &points},
        {.name = "priority"},
        {.name = "name"},
        {.name = "tags"},
        {0}};
    return orl_json_members(doc, "", &orl_schema_study_request, members, err);
}

/* Refuses samples for what is not measured: they would have no effect. */
static int refuse_samples(const json_t *doc, bool views, struct orl_error *err)
{
    const char *name = views ? "pixel_samples" : "gather_samples";
    const char *other = views ? "gather_samples" : "pixel_samples";
    if (!json_object_get(doc, other))
        return 0;
    return orl_json_fail(err, ORL_ERR_INVALID, other, "the study measures %s: use \"%s\" instead",
                         views ? "views" : "sensors", name);
}

static int decode_document(const json_t *doc, enum orl_job_origin origin,
                           struct orl_study_request *request, char **ret_scene_id,
                           struct orl_error *err)
{
    const bool views = json_array_size(json_object_get(doc, "views")) > 0;
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (json_is_object(doc) && (!kind || strcmp(kind, "study") != 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "kind", "a study needs \"kind\": \"study\"");
    int rc = decode_members(doc, views, request, err);
    if (rc == 0)
        rc = decode_job(doc, origin, &request->job, ret_scene_id, err);
    return rc ? rc : refuse_samples(doc, views, err);
}

int orl_study_from_json(const json_t *doc, enum orl_job_origin origin,
                        struct orl_study_request *ret_request, char **ret_scene_id,
                        struct orl_error *err)
{
    struct orl_study_request request;
    char *scene_id = NULL;
    orl_study_request_init(&request);
    const int rc = decode_document(doc, origin, &request, &scene_id, err);
    if (rc)
        orl_study_request_done(&request);
    else
        *ret_request = request;
    return orl_json_return_text(scene_id, ret_scene_id, rc);
}

/* ---- Results --------------------------------------------------------------------------------- */

/* json_pack's "o" fails on NULL, so that one check covers all parts (as in result_json.c). */
static json_t *seconds_to_json(const struct orl_study_point *p)
{
    json_t *seconds = json_pack("{s:f, s:o}", "total", p->total_s, "total_error",
                                orl_json_from_real(p->total_error_s));
    for (int stage = 0; seconds && stage < ORL_STAGE_COUNT; stage++)
        seconds = orl_json_checked(
            seconds, json_object_set_new(seconds, orl_stage_name((enum orl_stage)stage),
                                         json_real(p->stages_s[stage])));
    return seconds;
}

static json_t *count_or_null(uint64_t count)
{
    return count ? json_integer((json_int_t)count) : json_null();
}

json_t *orl_study_setting_to_json(const struct orl_study_setting *setting)
{
    return json_pack("{s:s, s:o, s:o}", "technique", orl_technique_name(setting->technique),
                     "photons", count_or_null(setting->photons), "samples",
                     count_or_null(setting->samples));
}

json_t *orl_study_point_in_short(const struct orl_study_point *p)
{
    json_t *point = orl_study_setting_to_json(&p->setting);
    return orl_json_checked(
        point,
        point && (json_object_set_new(point, "total_s", json_real(p->total_s)) ||
                  json_object_set_new(point, "rms", orl_json_from_real(p->rms)) ||
                  json_object_set_new(point, "rms_error", orl_json_from_real(p->rms_error))));
}

static json_t *point_to_json(const struct orl_study_point *p)
{
    return json_pack("{s:s, s:o, s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:b, s:b}",
                     "technique", orl_technique_name(p->setting.technique), "photons",
                     count_or_null(p->setting.photons), "samples",
                     count_or_null(p->setting.samples), "seeds", (json_int_t)p->seeds, "seconds",
                     seconds_to_json(p), "rms", orl_json_from_real(p->rms), "rms_error",
                     orl_json_from_real(p->rms_error), "bias", orl_json_from_real(p->bias),
                     "bias_error", orl_json_from_real(p->bias_error), "noise",
                     orl_json_from_real(p->noise), "p95", orl_json_from_real(p->p95), "peak",
                     orl_json_from_real(p->peak), "map_bytes", (json_int_t)p->map_bytes,
                     "reference_shows", (int)p->reference_shows, "on_front", (int)p->on_front);
}

static json_t *terms_to_json(const struct orl_study_fit *fit)
{
    json_t *terms = json_object();
    for (int t = 0; terms && t < ORL_FIT_TERMS; t++)
        if (json_object_set_new(terms, orl_fit_term_name((enum orl_fit_term)t),
                                json_pack("{s:o, s:o}", "value", orl_json_from_real(fit->terms[t]),
                                          "error", orl_json_from_real(fit->errors[t])))) {
            json_decref(terms);
            return NULL;
        }
    return terms;
}

static json_t *fit_to_json(const struct orl_study_fit *fit)
{
    return json_pack("{s:s, s:I, s:o, s:o, s:o}", "technique", orl_technique_name(fit->technique),
                     "points", (json_int_t)fit->points, "terms", terms_to_json(fit), "chi2",
                     orl_json_from_real(fit->chi2), "residual", orl_json_from_real(fit->residual));
}

static json_t *given_to_json(const struct orl_study_external *external)
{
    return json_pack("{s:o, s:f, s:f, s:o, s:f}", "name", orl_json_from_text(external->name),
                     "seconds", external->seconds, "rms", external->rms, "rays_per_s",
                     external->rays_per_s > 0 ? json_real(external->rays_per_s) : json_null(),
                     "here_s", external->here_s);
}

static json_t *reference_to_json(const struct orl_study_reference *r)
{
    return json_pack("{s:I, s:I, s:f, s:I, s:I, s:o, s:o}", "samples", (json_int_t)r->samples,
                     "runs", (json_int_t)r->runs, "seconds", r->seconds, "values",
                     (json_int_t)r->values, "left_out", (json_int_t)r->left_out, "standard_error",
                     orl_json_from_real(r->standard_error), "worst", orl_json_from_real(r->worst));
}

enum part { PART_POINTS, PART_FITS, PART_GIVEN, PART_WARNINGS };

static json_t *part_to_json(const struct orl_study *study, enum part part)
{
    const size_t counts[] = {study->n_points, study->n_fits, study->n_external, study->n_warnings};
    json_t *array = json_array();
    for (size_t i = 0; array && i < counts[part]; i++) {
        json_t *item = part == PART_POINTS  ? point_to_json(&study->points[i])
                       : part == PART_FITS  ? fit_to_json(&study->fits[i])
                       : part == PART_GIVEN ? given_to_json(&study->external[i])
                                            : orl_json_from_text(study->warnings[i]);
        /* Takes item; NULL is an error. */
        array = orl_json_append(array, item);
    }
    return array;
}

json_t *orl_study_to_json(const struct orl_study *study, const struct orl_study_request *request)
{
    return json_pack(
        "{s:s, s:o, s:o, s:I, s:o, s:s, s:o, s:o, s:o, s:o, s:o}", "kind", "study", "title",
        orl_json_from_text(request->title), "note", orl_json_from_text(request->note), "threads",
        (json_int_t)study->threads, "rays_per_s", orl_json_from_real(study->rays_per_s), "measured",
        study->of_views ? "views" : "sensors", "reference", reference_to_json(&study->reference),
        "points", part_to_json(study, PART_POINTS), "fits", part_to_json(study, PART_FITS), "given",
        part_to_json(study, PART_GIVEN), "warnings", part_to_json(study, PART_WARNINGS));
}
