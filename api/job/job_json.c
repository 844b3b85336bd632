#include "job/job_json.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "job/job_members_json.h"
#include "schemas.h"
#include "view/view_json.h"
#include "json/decode.h"
#include "json/encode.h"

/* A job while it is decoded. */
struct draft {
    enum orl_job_origin origin;
    struct orl_job job;
    char *scene_id;
};

static int decode_file_name(const json_t *value, const char *path, void *name,
                            struct orl_error *err)
{
    return orl_json_text_of(value, path, &orl_schema_file_name, name, err);
}

static int decode_local_scene(const json_t *scene, const char *path, struct orl_job *job,
                              struct orl_error *err)
{
    const struct orl_json_list files = {.items = &job->scene_files,
                                        .count = &job->n_scene_files,
                                        .size = sizeof *job->scene_files,
                                        .each = decode_file_name};
    const struct orl_json_member members[] = {{"files", .list = &files}, {0}};
    if (json_is_string(scene)) {
        orl_json_fail(err, ORL_ERR_INVALID, path, "a scene id needs a daemon");
        orl_error_hint(err, "Name the files: \"scene\": {\"files\": [\"room.rad\"]}");
        return ORL_ERR_INVALID;
    }
    return orl_json_members(scene, path, &orl_schema_local_scene, members, err);
}

static int decode_remote_scene(const json_t *scene, const char *path, char **ret_id,
                               struct orl_error *err)
{
    if (json_is_object(scene)) {
        orl_json_fail(err, ORL_ERR_INVALID, path, "the daemon does not open files by name");
        orl_error_hint(err, "Upload them with POST /v1/scenes and give the id it returns");
        return ORL_ERR_INVALID;
    }
    char *id = NULL;
    const int rc = orl_json_string(scene, path, ORL_DIGEST_HEX, &id, err);
    if (rc)
        return rc;
    if (strlen(id) != ORL_DIGEST_HEX || strspn(id, "0123456789abcdef") != ORL_DIGEST_HEX) {
        free(id);
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "an id is 64 lower-case hexadecimal digits");
    }
    *ret_id = id;
    return 0;
}

int orl_job_scene_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            struct orl_job *job, char **ret_scene_id, struct orl_error *err)
{
    if (!scene)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "the job names no scene");
    return origin == ORL_JOB_LOCAL ? decode_local_scene(scene, path, job, err)
                                   : decode_remote_scene(scene, path, ret_scene_id, err);
}

int orl_job_files_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            char ***ret_files, size_t *ret_count, char **ret_scene_id,
                            struct orl_error *err)
{
    struct orl_job job;
    orl_job_init(&job);
    const int rc = orl_job_scene_from_json(scene, path, origin, &job, ret_scene_id, err);
    *ret_files = job.scene_files;
    *ret_count = job.n_scene_files;
    job.scene_files = NULL;
    job.n_scene_files = 0;
    orl_job_done(&job);
    return rc;
}

static int decode_scene(const json_t *scene, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    return orl_job_scene_from_json(scene, path, draft->origin, &draft->job, &draft->scene_id, err);
}

static int decode_sensors(const json_t *sensors, const char *path, void *into,
                          struct orl_error *err)
{
    return orl_job_sensors_from_json(sensors, path, into, err);
}

static int decode_technique(const json_t *value, const char *path, void *technique,
                            struct orl_error *err)
{
    return orl_technique_from_json(value, path, &orl_schema_job_request_technique,
                                   ORL_TECHNIQUE_AUTO, technique, err);
}

/* Decodes an error or a deadline, either with an optional "at". */
static int decode_goal(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_goal *goal = into;
    const struct orl_json_member members[] = {{"relative_error", .real = &goal->relative_error},
                                              {"dgp_error", .real = &goal->dgp_error},
                                              {"deadline_s", .real = &goal->deadline_s},
                                              {"at", .real = &goal->at},
                                              {0}};
    const int rc = orl_json_members(value, path, &orl_schema_goal, members, err);
    if (rc || (goal->relative_error > 0) + (goal->dgp_error > 0) + (goal->deadline_s > 0) == 1)
        return rc;
    orl_json_fail(err, ORL_ERR_INVALID, path,
                  "one of \"relative_error\", \"dgp_error\" and \"deadline_s\" is expected here");
    orl_error_hint(err, "Write \"accuracy\": {\"relative_error\": 0.05} or {\"deadline_s\": 30}");
    return ORL_ERR_INVALID;
}

/* Refuses settings that a goal chooses by itself. */
static int refuse_settings(const json_t *doc, struct orl_error *err)
{
    static const char *const chosen[] = {"photons", "gather_samples", "pixel_samples"};
    for (size_t i = 0; i < sizeof chosen / sizeof *chosen; i++)
        if (json_object_get(doc, chosen[i])) {
            orl_json_fail(err, ORL_ERR_INVALID, chosen[i],
                          "a job with \"accuracy\" chooses its photons and samples automatically");
            orl_error_hint(err, "Leave out one of the two");
            return ORL_ERR_INVALID;
        }
    return 0;
}

static int decode_members(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    struct orl_job *job = &draft->job;
    unsigned dark = 0;
    const struct orl_json_member photons[] = {{"global", .whole = &job->photons_global},
                                              {"caustic", .whole = &job->photons_caustic},
                                              {"exact", .flag = &job->photons_exact},
                                              {0}};
    const struct orl_json_list views = {.items = &job->views,
                                        .count = &job->n_views,
                                        .size = sizeof *job->views,
                                        .each = orl_view_from_json};
    const struct orl_json_member members[] = {
        {.name = "kind"}, /* read before */
        {"scene", .decode = decode_scene, .into = draft},
        {"technique", .decode = decode_technique, .into = &job->technique},
        {"effects", .decode = orl_effect_overrides_from_json, .into = job->overrides},
        {"seed", .whole = &job->seed},
        {"photons", .members = photons},
        {"gather_samples", .whole_32 = &job->gather_samples},
        {"pixel_samples", .whole_32 = &job->pixel_samples},
        {"sky", .decode = orl_sky_from_json, .into = &job->sky},
        {"skies", .decode = orl_skies_from_json, .into = job},
        {"sensors", .decode = decode_sensors, .into = job},
        {"grids", .decode = orl_grids_from_json, .into = job},
        {"views", .list = &views},
        {"accuracy", .decode = decode_goal, .into = &job->goal},
        {.name = "priority"}, /* for the daemon: job_request_json.h */
        {.name = "name"},
        {.name = "tags"},
        {"dark", .word = &dark},
        {"heat_map", .decode = orl_heat_map_from_json, .into = &job->heat_map},
        {"sequence", .decode = orl_sequence_from_json, .into = &job->sequence},
        {0}};
    const int rc = orl_json_members(doc, "", &orl_schema_job_request, members, err);
    job->dark_expected = dark == 1;
    job->sensor_files = job->n_skies == 0; /* of many skies, the files would fill the folder */
    return rc;
}

static int decode_document(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    const json_t *kind = json_object_get(doc, "kind");
    if (kind && !json_is_string(kind))
        return orl_json_wrong_type(kind, "kind", "a string", err);
    if (kind && strcmp(json_string_value(kind), "render") != 0)
        return orl_json_fail(err, ORL_ERR_INVALID, "kind",
                             "a job of kind \"render\" is expected here, not \"%.64s\"",
                             json_string_value(kind));
    int rc = decode_members(doc, draft, err);
    if (rc == 0 && json_object_get(doc, "accuracy"))
        rc = refuse_settings(doc, err);
    if (rc == 0 && draft->job.n_views == 0 && draft->job.n_sensors == 0 &&
        draft->job.n_grids == 0 && !draft->job.sensors_file) {
        rc = orl_json_fail(err, ORL_ERR_INVALID, "document", "the job requests no results");
        orl_error_hint(err, "Add sensors, views or both");
    }
    return rc;
}

int orl_job_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_job *ret_job,
                      char **ret_scene_id, struct orl_error *err)
{
    struct draft draft = {.origin = origin};
    orl_job_init(&draft.job);
    const int rc = decode_document(doc, &draft, err);
    if (rc)
        orl_job_done(&draft.job);
    else
        *ret_job = draft.job;
    return orl_json_return_text(draft.scene_id, ret_scene_id, rc);
}

void orl_labels_done(struct orl_labels *labels)
{
    if (!labels)
        return;
    free(labels->name);
    free(labels->tags);
    *labels = (struct orl_labels){0};
}

/* Returns the number of characters, or most + 1 if text has a control character (including C1,
 * which terminals interpret) or one of others. jansson has already checked the UTF-8. */
static size_t count_characters(const char *text, const char *others, size_t most)
{
    size_t characters = 0;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        const bool c1 = c[0] == 0xc2 && c[1] < 0xa0;
        if (*c < 0x20 || *c == 0x7f || c1 || strchr(others, *c))
            return most + 1;
        characters += (*c & 0xc0) != 0x80;
    }
    return characters;
}

static bool is_label(const char *text, const char *others, size_t most)
{
    const size_t characters = count_characters(text, others, most);
    return characters >= 1 && characters <= most;
}

bool orl_label_is_tag(const char *text)
{
    return is_label(text, "\"\\,", ORL_LABEL_TAG);
}

bool orl_labels_have(const char *tags, const char *tag)
{
    char quoted[4 * ORL_LABEL_TAG + 3];
    snprintf(quoted, sizeof quoted, "\"%s\"", tag);
    return tags && strstr(tags, quoted);
}

static int read_name(const json_t *value, char **ret_name, struct orl_error *err)
{
    const char *name = json_string_value(value);
    if (!value)
        return 0;
    if (!name)
        return orl_json_wrong_type(value, "name", "a string", err);
    /* strdup would cut the name at a NUL inside. */
    if (strlen(name) != json_string_length(value) || !is_label(name, "", ORL_LABEL_NAME))
        return orl_json_fail(err, ORL_ERR_INVALID, "name",
                             "a name must have 1 to %d characters, without control characters",
                             ORL_LABEL_NAME);
    *ret_name = strdup(name);
    return *ret_name ? 0 : orl_error_no_memory(err);
}

static int check_tag(const json_t *tags, size_t at, struct orl_error *err)
{
    const json_t *value = json_array_get(tags, at);
    const char *tag = json_string_value(value);
    char path[ORL_JSON_PATH_MAX];
    snprintf(path, sizeof path, "tags[%zu]", at);
    if (!tag)
        return orl_json_wrong_type(value, path, "a string", err);
    if (strlen(tag) != json_string_length(value) || !orl_label_is_tag(tag))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "a tag must have 1 to %d characters, without control characters, "
                             "quotation marks, backslashes and commas",
                             ORL_LABEL_TAG);
    for (size_t i = 0; i < at; i++)
        if (strcmp(json_string_value(json_array_get(tags, i)), tag) == 0)
            return orl_json_fail(err, ORL_ERR_INVALID, path, "the tag is listed twice");
    return 0;
}

static int read_tags(const json_t *value, char **ret_tags, struct orl_error *err)
{
    int rc = value ? orl_json_array_of(value, "tags", &orl_schema_tags, err) : 0;
    for (size_t i = 0; i < json_array_size(value) && rc == 0; i++)
        rc = check_tag(value, i, err);
    if (rc || json_array_size(value) == 0)
        return rc;
    *ret_tags = orl_json_text(value, JSON_COMPACT);
    return *ret_tags ? 0 : orl_error_no_memory(err);
}

int orl_labels_from_json(const json_t *doc, struct orl_labels *ret_labels, struct orl_error *err)
{
    struct orl_labels labels = {0};
    int rc = read_name(json_object_get(doc, "name"), &labels.name, err);
    if (rc == 0)
        rc = read_tags(json_object_get(doc, "tags"), &labels.tags, err);
    if (rc)
        orl_labels_done(&labels);
    else
        *ret_labels = labels;
    return rc;
}
