#include "job_json.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "decode.h"
#include "picture_json.h"
#include "plan_json.h"
#include "skies_json.h"
#include "sky_json.h"
#include "view_json.h"

enum { FILE_NAME_MAX_BYTES = 1024 };

/* An array of count zeroed elements; a count of 0 gives a valid pointer too. */
static void *new_array(size_t count, size_t size, struct orl_error *err)
{
    void *array = calloc(count ? count : 1, size);
    if (!array)
        orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu elements", count);
    return array;
}

static int decode_local_scene(const json_t *scene, struct orl_job *job, struct orl_error *err)
{
    static const char *const allowed[] = {"files", NULL};
    if (json_is_string(scene)) {
        orl_json_fail(err, ORL_ERR_INVALID, "scene", "an id means nothing without a daemon");
        orl_error_hint(err, "Name the files: \"scene\": {\"files\": [\"room.rad\"]}");
        return ORL_ERR_INVALID;
    }
    int rc = orl_json_object(scene, "scene", allowed, err);
    const json_t *files = rc == 0 ? json_object_get(scene, "files") : NULL;
    if (rc == 0)
        rc = orl_json_array(files, "scene.files", ORL_LIMIT_SCENE_FILES, err);
    if (rc)
        return rc;
    const size_t count = json_array_size(files);
    if (count == 0)
        return orl_json_fail(err, ORL_ERR_INVALID, "scene.files", "no file is named");
    job->scene_files = new_array(count, sizeof *job->scene_files, err);
    if (!job->scene_files)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < count && rc == 0; i++) {
        char path[ORL_JSON_PATH_MAX];
        snprintf(path, sizeof path, "scene.files[%zu]", i);
        rc = orl_json_string(json_array_get(files, i), path, FILE_NAME_MAX_BYTES,
                             &job->scene_files[i], err);
        if (rc == 0)
            job->n_scene_files++;
    }
    return rc;
}

static int decode_remote_scene(const json_t *scene, char **ret_id, struct orl_error *err)
{
    if (json_is_object(scene)) {
        orl_json_fail(err, ORL_ERR_INVALID, "scene", "the daemon does not open files by name");
        orl_error_hint(err, "Upload them with POST /v1/scenes and give the id it returns");
        return ORL_ERR_INVALID;
    }
    char *id = NULL;
    const int rc = orl_json_string(scene, "scene", ORL_DIGEST_HEX, &id, err);
    if (rc)
        return rc;
    if (strlen(id) != ORL_DIGEST_HEX || strspn(id, "0123456789abcdef") != ORL_DIGEST_HEX) {
        free(id);
        return orl_json_fail(err, ORL_ERR_INVALID, "scene",
                             "an id is 64 lower-case hexadecimal digits");
    }
    *ret_id = id;
    return 0;
}

static int decode_photons(const json_t *photons, struct orl_job *job, struct orl_error *err)
{
    static const char *const allowed[] = {"global", "caustic", "exact", NULL};
    if (!photons)
        return 0;
    int rc = orl_json_object(photons, "photons", allowed, err);
    const json_t *global = json_object_get(photons, "global");
    const json_t *caustic = json_object_get(photons, "caustic");
    if (rc == 0 && global)
        rc = orl_json_whole(global, "photons.global", 1, ORL_LIMIT_PHOTONS, &job->photons_global,
                            err);
    if (rc == 0 && json_object_get(photons, "exact"))
        rc = orl_json_bool(json_object_get(photons, "exact"), "photons.exact", &job->photons_exact,
                           err);
    if (rc == 0 && caustic)
        rc = orl_json_whole(caustic, "photons.caustic", 0, ORL_LIMIT_PHOTONS, &job->photons_caustic,
                            err);
    return rc;
}

static int decode_sensor(const json_t *row, size_t index, struct orl_sensor *sensor,
                         struct orl_error *err)
{
    char path[ORL_JSON_PATH_MAX];
    snprintf(path, sizeof path, "sensors[%zu]", index);
    int rc = orl_json_array(row, path, 6, err);
    if (rc == 0 && json_array_size(row) != 6)
        rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                           "six numbers are wanted: x, y, z and the direction dx, dy, dz");
    double v[6] = {0};
    for (size_t k = 0; k < 6 && rc == 0; k++) {
        snprintf(path, sizeof path, "sensors[%zu][%zu]", index, k);
        rc = orl_json_real(json_array_get(row, k), path, &v[k], err);
    }
    if (rc == 0 && v[3] == 0 && v[4] == 0 && v[5] == 0) {
        snprintf(path, sizeof path, "sensors[%zu]", index);
        rc = orl_json_fail(err, ORL_ERR_RANGE, path, "the direction is zero");
    }
    if (rc == 0)
        *sensor = (struct orl_sensor){orl_v3(v[0], v[1], v[2]), orl_v3(v[3], v[4], v[5])};
    return rc;
}

static int decode_sensors(const json_t *sensors, struct orl_job *job, struct orl_error *err)
{
    static const char *const allowed[] = {"file", NULL};
    if (!sensors)
        return 0;
    if (json_is_object(sensors)) {
        int rc = orl_json_object(sensors, "sensors", allowed, err);
        if (rc == 0)
            rc = orl_json_string(json_object_get(sensors, "file"), "sensors.file",
                                 FILE_NAME_MAX_BYTES, &job->sensors_file, err);
        return rc;
    }
    int rc = orl_json_array(sensors, "sensors", ORL_LIMIT_SENSORS, err);
    if (rc)
        return rc;
    const size_t count = json_array_size(sensors);
    job->sensors = new_array(count, sizeof *job->sensors, err);
    if (!job->sensors)
        return ORL_ERR_NOMEM;
    for (; job->n_sensors < count && rc == 0; job->n_sensors++)
        rc = decode_sensor(json_array_get(sensors, job->n_sensors), job->n_sensors,
                           &job->sensors[job->n_sensors], err);
    return rc;
}

static int decode_views(const json_t *views, struct orl_job *job, struct orl_error *err)
{
    if (!views)
        return 0;
    int rc = orl_json_array(views, "views", ORL_LIMIT_VIEWS, err);
    if (rc)
        return rc;
    const size_t count = json_array_size(views);
    job->views = new_array(count, sizeof *job->views, err);
    if (!job->views)
        return ORL_ERR_NOMEM;
    /* Counted before it is decoded, so that a half-filled one is freed too. */
    while (job->n_views < count && rc == 0) {
        const size_t i = job->n_views++;
        rc = orl_view_from_json(json_array_get(views, i), i, &job->views[i], err);
    }
    return rc;
}

/* A member that has only one legal value so far. */
static int decode_only(const json_t *doc, const char *key, const char *only, bool required,
                       struct orl_error *err)
{
    const json_t *value = json_object_get(doc, key);
    if (!value && !required)
        return 0;
    if (!json_is_string(value) || strcmp(json_string_value(value), only) != 0) {
        orl_json_fail(err, ORL_ERR_INVALID, key, "\"%s\" is the only value known", only);
        return ORL_ERR_INVALID;
    }
    return 0;
}

static int decode_technique(const json_t *value, struct orl_job *job, struct orl_error *err)
{
    if (!value)
        return 0;
    for (int i = 0; i < ORL_TECHNIQUE_COUNT && json_is_string(value); i++)
        if (strcmp(json_string_value(value), orl_technique_name((enum orl_technique)i)) == 0) {
            job->technique = (enum orl_technique)i;
            return 0;
        }
    return orl_json_fail(err, ORL_ERR_INVALID, "technique",
                         "\"auto\", \"backward\", \"gather\", \"direct\" or \"precomputed\" is "
                         "wanted here");
}

/* "expected": results without any light are what is wanted. */
static int decode_dark(const json_t *value, bool *ret_expected, struct orl_error *err)
{
    static const char expected[] = "expected", wrong[] = "error";
    const char *word = json_string_value(value);
    if (value && (!word || (strcmp(word, expected) != 0 && strcmp(word, wrong) != 0)))
        return orl_json_fail(err, ORL_ERR_INVALID, "dark", "it is \"%s\" or \"%s\"", expected,
                             wrong);
    *ret_expected = word && strcmp(word, expected) == 0;
    return 0;
}

static int decode_settings(const json_t *doc, struct orl_job *job, struct orl_error *err)
{
    const json_t *seed = json_object_get(doc, "seed");
    const json_t *samples = json_object_get(doc, "gather_samples");
    int rc = decode_technique(json_object_get(doc, "technique"), job, err);
    if (rc == 0 && seed)
        rc = orl_json_whole(seed, "seed", 0, INT64_MAX, &job->seed, err);
    const json_t *pixel_samples = json_object_get(doc, "pixel_samples");
    uint64_t count = 0, pixel_count = 0;
    if (rc == 0 && samples)
        rc = orl_json_whole(samples, "gather_samples", 0, 1U << 24, &count, err);
    if (rc == 0 && pixel_samples)
        rc = orl_json_whole(pixel_samples, "pixel_samples", 0, 1U << 20, &pixel_count, err);
    job->gather_samples = (uint32_t)count;
    job->pixel_samples = (uint32_t)pixel_count;
    if (rc == 0)
        rc = decode_dark(json_object_get(doc, "dark"), &job->dark_expected, err);
    if (rc == 0)
        rc = orl_wishes_from_json(json_object_get(doc, "effects"), job->wishes, err);
    return rc ? rc : decode_photons(json_object_get(doc, "photons"), job, err);
}

/* {"relative_error": e} or {"deadline_s": t}; "at" beside either. */
static int decode_goal(const json_t *value, struct orl_goal *goal, struct orl_error *err)
{
    static const char *const allowed[] = {"relative_error", "dgp_error", "deadline_s", "at", NULL};
    if (!value)
        return 0;
    int rc = orl_json_object(value, "accuracy", allowed, err);
    const json_t *error = json_object_get(value, "relative_error");
    const json_t *deadline = json_object_get(value, "deadline_s");
    const json_t *dgp = json_object_get(value, "dgp_error");
    const json_t *at = json_object_get(value, "at");
    if (rc == 0 && !!error + !!deadline + !!dgp != 1) {
        rc = orl_json_fail(err, ORL_ERR_INVALID, "accuracy",
                           "one of \"relative_error\", \"dgp_error\" and \"deadline_s\" is "
                           "wanted here");
        orl_error_hint(err, "Write \"accuracy\": {\"relative_error\": 0.05} or "
                            "{\"deadline_s\": 30}");
    }
    if (rc == 0 && error)
        rc = orl_json_real(error, "accuracy.relative_error", &goal->relative_error, err);
    if (rc == 0 && deadline)
        rc = orl_json_real(deadline, "accuracy.deadline_s", &goal->deadline_s, err);
    if (rc == 0 && dgp)
        rc = orl_json_real(dgp, "accuracy.dgp_error", &goal->dgp_error, err);
    if (rc == 0 && dgp && !(goal->dgp_error >= 1e-5 && goal->dgp_error <= 1))
        rc = orl_json_fail(err, ORL_ERR_RANGE, "accuracy.dgp_error",
                           "it is half the interval of DGP, from 0.00001 to 1");
    if (rc == 0 && at)
        rc = orl_json_real(at, "accuracy.at", &goal->at, err);
    if (rc == 0 && error && !(goal->relative_error > 0 && goal->relative_error <= 10))
        rc = orl_json_fail(err, ORL_ERR_RANGE, "accuracy.relative_error",
                           "it is a fraction, from above 0 to 10: 0.05 is 5 %%");
    if (rc == 0 && deadline &&
        !(goal->deadline_s > 0 && goal->deadline_s <= (double)ORL_LIMIT_DEADLINE_S))
        rc = orl_json_fail(err, ORL_ERR_RANGE, "accuracy.deadline_s",
                           "it is from above 0 to %lu seconds", ORL_LIMIT_DEADLINE_S);
    if (rc == 0 && !(goal->at > 0 && goal->at <= 1))
        rc = orl_json_fail(err, ORL_ERR_RANGE, "accuracy.at",
                           "it is the share of sensors or pixels, from above 0 to 1");
    return rc;
}

/* What a goal chooses by itself. */
static int refuse_settings(const json_t *doc, struct orl_error *err)
{
    static const char *const chosen[] = {"photons", "gather_samples", "pixel_samples"};
    for (size_t i = 0; i < sizeof chosen / sizeof *chosen; i++)
        if (json_object_get(doc, chosen[i])) {
            orl_json_fail(err, ORL_ERR_INVALID, chosen[i],
                          "a job with \"accuracy\" chooses its photons and samples itself");
            orl_error_hint(err, "Leave out one of the two");
            return ORL_ERR_INVALID;
        }
    return 0;
}

int orl_job_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_job *ret_job,
                      char **ret_scene_id, struct orl_error *err)
{
    static const char *const allowed[] = {
        "kind",           "scene",         "technique", "effects",  "seed",    "photons",
        "gather_samples", "pixel_samples", "sky",       "skies",    "sensors", "views",
        "accuracy",       "priority",      "dark",      "heat_map", NULL};
    struct orl_job job;
    char *id = NULL;
    orl_job_init(&job);
    int rc = json_is_object(doc) ? decode_only(doc, "kind", "render", false, err) : 0;
    if (rc == 0)
        rc = orl_json_object(doc, "", allowed, err);
    const json_t *scene = json_object_get(doc, "scene");
    if (rc == 0 && !scene)
        rc = orl_json_fail(err, ORL_ERR_INVALID, "scene", "the job names no scene");
    if (rc == 0)
        rc = origin == ORL_JOB_LOCAL ? decode_local_scene(scene, &job, err)
                                     : decode_remote_scene(scene, &id, err);
    if (rc == 0)
        rc = decode_settings(doc, &job, err);
    if (rc == 0)
        rc = decode_goal(json_object_get(doc, "accuracy"), &job.goal, err);
    if (rc == 0 && json_object_get(doc, "accuracy"))
        rc = refuse_settings(doc, err);
    if (rc == 0)
        rc = orl_sky_from_json(json_object_get(doc, "sky"), &job.sky, err);
    if (rc == 0)
        rc = orl_skies_from_json(json_object_get(doc, "skies"), &job, err);
    if (rc == 0)
        rc = decode_sensors(json_object_get(doc, "sensors"), &job, err);
    if (rc == 0)
        rc = orl_heat_map_from_json(json_object_get(doc, "heat_map"), &job.heat_map, err);
    if (rc == 0)
        rc = decode_views(json_object_get(doc, "views"), &job, err);
    if (rc == 0 && job.n_views == 0 && job.n_sensors == 0 && !job.sensors_file) {
        rc = orl_json_fail(err, ORL_ERR_INVALID, "document", "the job asks for nothing");
        orl_error_hint(err, "Add sensors, views or both");
    }
    if (rc) {
        orl_job_done(&job);
        free(id);
        return rc;
    }
    *ret_job = job;
    if (ret_scene_id)
        *ret_scene_id = id;
    return 0;
}
