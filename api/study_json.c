#include "study_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "decode.h"
#include "encode.h"
#include "job_json.h"

enum { TITLE_MAX = 90, NOTE_MAX = 2000, NAME_MAX_BYTES = 60, REPEATS_MAX = 1000 };

/* What a study has in common with a job, as a job document of its own. */
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
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const int rc = orl_job_from_json(part, origin, &job, ret_scene_id, err);
    json_decref(part);
    if (rc)
        return rc;
    orl_job_done(ret_job);
    *ret_job = job;
    return 0;
}

/* An array that is there and holds something: zeroed, owned, one per element; or NULL, and why. */
static void *new_list(const json_t *value, const char *path, size_t size, int *ret_code,
                      struct orl_error *err)
{
    void *items = NULL;
    *ret_code = orl_json_array(value, path, ORL_LIMIT_STUDY_LIST, err);
    if (*ret_code)
        return NULL;
    if (json_array_size(value) > 0)
        items = calloc(json_array_size(value), size);
    else
        *ret_code = orl_json_fail(err, ORL_ERR_INVALID, path, "the list is empty");
    if (!items && *ret_code == 0)
        *ret_code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return items;
}

static int decode_technique(const json_t *value, const char *path, enum orl_technique *ret,
                            struct orl_error *err)
{
    for (int i = ORL_TECHNIQUE_AUTO + 1; i < ORL_TECHNIQUE_COUNT && json_is_string(value); i++)
        if (strcmp(json_string_value(value), orl_technique_name((enum orl_technique)i)) == 0) {
            *ret = (enum orl_technique)i;
            return 0;
        }
    return orl_json_fail(err, ORL_ERR_INVALID, path,
                         "\"backward\", \"gather\", \"direct\" or \"precomputed\" is wanted here");
}

static int decode_techniques(const json_t *list, struct orl_study_request *request,
                             struct orl_error *err)
{
    int rc = 0;
    request->techniques = new_list(list, "techniques", sizeof *request->techniques, &rc, err);
    if (!request->techniques)
        return rc;
    for (size_t i = 0; rc == 0 && i < json_array_size(list); i++) {
        char path[ORL_JSON_PATH_MAX];
        snprintf(path, sizeof path, "techniques[%zu]", i);
        rc = decode_technique(json_array_get(list, i), path, &request->techniques[i], err);
        request->n_techniques = i + 1;
    }
    return rc;
}

static int decode_photons(const json_t *list, struct orl_study_request *request,
                          struct orl_error *err)
{
    int rc = 0;
    if (!list)
        return 0;
    request->photons = new_list(list, "photons", sizeof *request->photons, &rc, err);
    if (!request->photons)
        return rc;
    for (size_t i = 0; rc == 0 && i < json_array_size(list); i++) {
        char path[ORL_JSON_PATH_MAX];
        snprintf(path, sizeof path, "photons[%zu]", i);
        rc = orl_json_whole(json_array_get(list, i), path, 1, ORL_LIMIT_PHOTONS,
                            &request->photons[i], err);
        request->n_photons = i + 1;
    }
    return rc;
}

/* "gather_samples" of sensors, "pixel_samples" of views; the other one would be without effect. */
static int decode_samples(const json_t *doc, struct orl_study_request *request,
                          struct orl_error *err)
{
    const bool views = request->job.n_views > 0;
    const char *name = views ? "pixel_samples" : "gather_samples";
    const char *other = views ? "gather_samples" : "pixel_samples";
    const json_t *list = json_object_get(doc, name);
    const uint64_t most = views ? 1U << 20 : 1U << 24;
    int rc = 0;
    if (json_object_get(doc, other))
        return orl_json_fail(err, ORL_ERR_INVALID, other, "%s are measured: \"%s\" is wanted",
                             views ? "views" : "sensors", name);
    if (!list)
        return 0;
    request->samples = new_list(list, name, sizeof *request->samples, &rc, err);
    if (!request->samples)
        return rc;
    for (size_t i = 0; rc == 0 && i < json_array_size(list); i++) {
        char path[ORL_JSON_PATH_MAX];
        uint64_t count = 0;
        snprintf(path, sizeof path, "%s[%zu]", name, i);
        rc = orl_json_whole(json_array_get(list, i), path, 1, most, &count, err);
        request->samples[i] = (uint32_t)count;
        request->n_samples = i + 1;
    }
    return rc;
}

static int decode_above_zero(const json_t *value, const char *path, double *ret_value,
                             struct orl_error *err)
{
    double real = 0;
    const int rc = orl_json_real(value, path, &real, err);
    if (rc)
        return rc;
    if (!(real > 0))
        return orl_json_fail(err, ORL_ERR_RANGE, path, "a number above zero is wanted");
    *ret_value = real;
    return 0;
}

static int decode_given(const json_t *value, size_t index, struct orl_study_given *given,
                        struct orl_error *err)
{
    static const char *const allowed[] = {"name", "seconds", "rms", "rays_per_s", NULL};
    char path[ORL_JSON_PATH_MAX];
    snprintf(path, sizeof path, "points[%zu]", index);
    int rc = orl_json_object(value, path, allowed, err);
    if (rc == 0) {
        snprintf(path, sizeof path, "points[%zu].name", index);
        rc = orl_json_string(json_object_get(value, "name"), path, NAME_MAX_BYTES, &given->name,
                             err);
    }
    if (rc == 0) {
        snprintf(path, sizeof path, "points[%zu].seconds", index);
        rc = decode_above_zero(json_object_get(value, "seconds"), path, &given->seconds, err);
    }
    if (rc == 0) {
        snprintf(path, sizeof path, "points[%zu].rms", index);
        rc = decode_above_zero(json_object_get(value, "rms"), path, &given->rms, err);
    }
    if (rc == 0 && json_object_get(value, "rays_per_s")) {
        snprintf(path, sizeof path, "points[%zu].rays_per_s", index);
        rc = decode_above_zero(json_object_get(value, "rays_per_s"), path, &given->rays_per_s, err);
    }
    return rc;
}

static int decode_points(const json_t *list, struct orl_study_request *request,
                         struct orl_error *err)
{
    int rc = 0;
    if (!list)
        return 0;
    request->given = new_list(list, "points", sizeof *request->given, &rc, err);
    if (!request->given)
        return rc;
    /* Counted before it is decoded, so that a half-filled one is freed too. */
    while (rc == 0 && request->n_given < json_array_size(list)) {
        const size_t i = request->n_given++;
        rc = decode_given(json_array_get(list, i), i, &request->given[i], err);
    }
    return rc;
}

static int decode_reference(const json_t *doc, struct orl_study_request *request,
                            struct orl_error *err)
{
    static const char *const allowed[] = {"samples", "runs", NULL};
    const json_t *reference = json_object_get(doc, "reference");
    const json_t *repeats = json_object_get(doc, "repeats");
    const uint64_t most = request->job.n_views > 0 ? 1U << 20 : 1U << 24;
    uint64_t samples = 0, runs = request->reference_runs, count = request->repeats;
    int rc = orl_json_object(reference, "reference", allowed, err);
    if (rc == 0)
        rc = orl_json_whole(json_object_get(reference, "samples"), "reference.samples", 1, most,
                            &samples, err);
    if (rc == 0 && repeats)
        rc = orl_json_whole(repeats, "repeats", 1, REPEATS_MAX, &count, err);
    if (rc == 0 && json_object_get(reference, "runs"))
        rc = orl_json_whole(json_object_get(reference, "runs"), "reference.runs", 1, REPEATS_MAX,
                            &runs, err);
    request->reference_samples = (uint32_t)samples;
    request->reference_runs = (uint32_t)runs;
    request->repeats = (uint32_t)count;
    return rc;
}

static int decode_kind(const json_t *doc, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (kind && strcmp(kind, "study") == 0)
        return 0;
    return orl_json_fail(err, ORL_ERR_INVALID, "kind", "a study says \"kind\": \"study\"");
}

static int decode(const json_t *doc, enum orl_job_origin origin, struct orl_study_request *request,
                  char **ret_scene_id, struct orl_error *err)
{
    static const char *const allowed[] = {
        "kind",          "title",   "note",      "scene",      "sky",      "effects",
        "seed",          "sensors", "views",     "techniques", "photons",  "gather_samples",
        "pixel_samples", "repeats", "reference", "points",     "priority", NULL};
    int rc = json_is_object(doc) ? decode_kind(doc, err) : 0;
    if (rc == 0)
        rc = orl_json_object(doc, "", allowed, err);
    if (rc == 0)
        rc = decode_job(doc, origin, &request->job, ret_scene_id, err);
    if (rc == 0)
        rc = decode_techniques(json_object_get(doc, "techniques"), request, err);
    if (rc == 0)
        rc = decode_photons(json_object_get(doc, "photons"), request, err);
    if (rc == 0)
        rc = decode_samples(doc, request, err);
    if (rc == 0)
        rc = decode_reference(doc, request, err);
    if (rc == 0)
        rc = decode_points(json_object_get(doc, "points"), request, err);
    if (rc == 0 && json_object_get(doc, "title"))
        rc = orl_json_string(json_object_get(doc, "title"), "title", TITLE_MAX, &request->title,
                             err);
    if (rc == 0 && json_object_get(doc, "note"))
        rc = orl_json_string(json_object_get(doc, "note"), "note", NOTE_MAX, &request->note, err);
    return rc;
}

int orl_study_from_json(const json_t *doc, enum orl_job_origin origin,
                        struct orl_study_request *ret_request, char **ret_scene_id,
                        struct orl_error *err)
{
    struct orl_study_request request;
    char *scene_id = NULL;
    orl_study_request_init(&request);
    const int rc = decode(doc, origin, &request, &scene_id, err);
    if (rc) {
        orl_study_request_done(&request);
        free(scene_id);
        return rc;
    }
    *ret_request = request;
    if (ret_scene_id)
        *ret_scene_id = scene_id;
    return 0;
}

/* ---- Results --------------------------------------------------------------------------------- */

/* As in result_json.c: json_pack's "o" fails on NULL, so that one check covers all parts. */
static json_t *seconds_to_json(const struct orl_study_point *p)
{
    json_t *seconds = json_pack("{s:f, s:o}", "total", p->total_s, "total_error",
                                orl_json_from_real(p->total_error_s));
    for (int stage = 0; seconds && stage < ORL_STAGE_COUNT; stage++)
        if (json_object_set_new(seconds, orl_stage_name((enum orl_stage)stage),
                                json_real(p->stages_s[stage]))) {
            json_decref(seconds);
            return NULL;
        }
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
    if (point && (json_object_set_new(point, "total_s", json_real(p->total_s)) ||
                  json_object_set_new(point, "rms", orl_json_from_real(p->rms)) ||
                  json_object_set_new(point, "rms_error", orl_json_from_real(p->rms_error)))) {
        json_decref(point);
        return NULL;
    }
    return point;
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

static json_t *given_to_json(const struct orl_study_given *given)
{
    return json_pack("{s:o, s:f, s:f, s:o, s:f}", "name", orl_json_from_text(given->name),
                     "seconds", given->seconds, "rms", given->rms, "rays_per_s",
                     given->rays_per_s > 0 ? json_real(given->rays_per_s) : json_null(), "here_s",
                     given->here_s);
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
    const size_t counts[] = {study->n_points, study->n_fits, study->n_given, study->n_warnings};
    json_t *array = json_array();
    for (size_t i = 0; array && i < counts[part]; i++) {
        json_t *item = part == PART_POINTS  ? point_to_json(&study->points[i])
                       : part == PART_FITS  ? fit_to_json(&study->fits[i])
                       : part == PART_GIVEN ? given_to_json(&study->given[i])
                                            : orl_json_from_text(study->warnings[i]);
        /* Takes item, NULL included, which is an error. */
        if (json_array_append_new(array, item)) {
            json_decref(array);
            return NULL;
        }
    }
    return array;
}

static json_t *text_or_null(const char *text)
{
    return text ? orl_json_from_text(text) : json_null();
}

json_t *orl_study_to_json(const struct orl_study *study, const struct orl_study_request *request)
{
    return json_pack(
        "{s:s, s:o, s:o, s:I, s:o, s:s, s:o, s:o, s:o, s:o, s:o}", "kind", "study", "title",
        text_or_null(request->title), "note", text_or_null(request->note), "threads",
        (json_int_t)study->threads, "rays_per_s", orl_json_from_real(study->rays_per_s), "measured",
        study->of_views ? "views" : "sensors", "reference", reference_to_json(&study->reference),
        "points", part_to_json(study, PART_POINTS), "fits", part_to_json(study, PART_FITS), "given",
        part_to_json(study, PART_GIVEN), "warnings", part_to_json(study, PART_WARNINGS));
}
