#include "runner/job_output.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chart/study_chart.h"
#include "decode.h"
#include "encode.h"
#include "process/limits.h"
#include "result_json.h"
#include "skies_result_json.h"
#include "store/mapped_file.h"
#include "study_json.h"

/* What the daemon takes of studies is less than what the command does. */
static int check_runs(const struct orl_task *task, struct orl_error *err)
{
    if (task->kind != ORL_TASK_STUDY)
        return 0;
    return orl_study_check_runs(&task->of.study, ORL_SERVER_STUDY_RUNS, err);
}

int orl_job_read(const char *text, size_t size, struct orl_task *ret_task, char **ret_scene_id,
                 struct orl_error *err)
{
    json_t *doc = NULL;
    struct orl_task task;
    char *scene = NULL;
    int rc = orl_json_parse(NULL, text, size, &doc, err);
    if (rc)
        return rc;
    rc = orl_task_from_json(doc, ORL_JOB_REMOTE, &task, &scene, err);
    json_decref(doc);
    if (rc)
        return rc;
    rc = check_runs(&task, err);
    if (rc) {
        orl_task_done(&task);
        free(scene);
        return rc;
    }
    *ret_task = task;
    if (ret_scene_id)
        *ret_scene_id = scene;
    else
        free(scene);
    return 0;
}

/* Of result.json, without sensors; of one of these. */
enum { DOCUMENT = 8192, STUDY = 1 << 18, SENSOR = 200 };
/* Of the outlines and pixels of some heat maps; of a sensor in map and tables. */
enum { HEAT_MAPS = 1 << 20, HEAT_MAP_SENSOR = 400 };

/* Bytes of a pixel in all the files of a view, errors included. */
static uint64_t pixel_bytes(const struct orl_view_request *view)
{
    enum { RGBE = 4, RGB = 3, WORDS = 6, HALVES = 6, FLOATS = 12 };
    const uint32_t formats = view->formats ? view->formats : ORL_PICTURES_USUAL;
    uint64_t bytes = RGBE + RGB;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_HDR) ? RGBE : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_PNG) ? RGB : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_PNG16) ? WORDS : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_EXR) ? HALVES : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_EXR_FLOAT) ? FLOATS : 0;
    return bytes + (view->false_color.asked ? 3 * RGB : 0);
}

/* Of a sky's part in sequences: a picture, the same in the animation and, smaller, on the sheet. */
static uint64_t sequence_bytes(const struct orl_job *job)
{
    enum { RGB = 3, PICTURES = 3, MARGINS = 1 << 16 };
    uint64_t bytes = 0;
    for (size_t i = 0; i < job->n_views; i++)
        bytes += (uint64_t)job->views[i].width * job->views[i].height * PICTURES * RGB + MARGINS;
    return bytes;
}

uint64_t orl_job_output_expect_sensor(const struct orl_task *task)
{
    const size_t skies = task->of.render.n_skies;
    if (task->kind == ORL_TASK_STUDY)
        return 0;
    return skies > 0 ? (skies + 1) * SENSOR : SENSOR;
}

uint64_t orl_job_output_expect(const struct orl_task *task)
{
    const struct orl_job *job = &task->of.render;
    if (task->kind == ORL_TASK_STUDY)
        return STUDY;
    uint64_t bytes = DOCUMENT + SENSOR * (uint64_t)job->n_sensors;
    for (size_t i = 0; i < job->n_views; i++)
        bytes += pixel_bytes(&job->views[i]) * (uint64_t)job->views[i].width * job->views[i].height;
    if (job->sequence.asked)
        bytes += sequence_bytes(job);
    if (job->heat_map.asked)
        bytes += HEAT_MAPS + HEAT_MAP_SENSOR * (uint64_t)job->n_sensors;
    /* Of each sky as much, and of all together less than of one more. */
    return job->n_skies > 0 ? (job->n_skies + 1) * bytes : bytes;
}

int orl_job_set_scene(struct orl_job *job, const struct orl_bundle *bundle, struct orl_error *err)
{
    const size_t count = orl_bundle_main_count(bundle);
    if (count == 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the job's scene is not stored");
    job->scene_files = calloc(count, sizeof *job->scene_files);
    for (size_t i = 0; job->scene_files && i < bundle->count; i++) {
        if (bundle->files[i].resource)
            continue;
        char *name = strdup(bundle->files[i].name);
        if (!name)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        job->scene_files[job->n_scene_files++] = name;
    }
    return job->scene_files ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

void orl_job_output_path(const char *folder, const char *name, char ret_path[ORL_PATH_MAX])
{
    snprintf(ret_path, ORL_PATH_MAX, "%.*s/%.400s", ORL_PATH_MAX - 512, folder, name);
}

int orl_job_output_list(const char *name, const char *folder, json_t *list, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    struct orl_file file;
    char sha[ORL_SHA_HEX];
    orl_job_output_path(folder, name, path);
    int rc = orl_sync_path(path, err);
    if (rc == 0)
        rc = orl_map_file(path, &file, err);
    if (rc)
        return rc;
    const json_int_t bytes = (json_int_t)file.size;
    orl_sha256_hex(file.data, file.size, sha);
    orl_unmap_file(&file);
    if (json_array_append_new(
            list, json_pack("{s:s, s:I, s:s}", "name", name, "bytes", bytes, "sha256", sha)))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

int orl_job_output_list_view(const struct orl_view_result *view, const char *folder, json_t *list,
                             struct orl_error *err)
{
    int rc = 0;
    for (int i = 0; i < ORL_PICTURES && rc == 0; i++)
        rc = view->files[i] ? orl_job_output_list(view->files[i], folder, list, err) : 0;
    return rc;
}

int orl_job_output_list_sensors(const struct orl_sensor_files *sensors, const char *folder,
                                json_t *list, struct orl_error *err)
{
    int rc = sensors->csv ? orl_job_output_list(sensors->csv, folder, list, err) : 0;
    if (rc == 0 && sensors->res)
        rc = orl_job_output_list(sensors->res, folder, list, err);
    for (size_t i = 0; i < sensors->n_maps && rc == 0; i++) {
        rc = orl_job_output_list(sensors->maps[i].png, folder, list, err);
        if (rc == 0)
            rc = orl_job_output_list(sensors->maps[i].svg, folder, list, err);
        if (rc == 0 && sensors->maps[i].dat)
            rc = orl_job_output_list(sensors->maps[i].dat, folder, list, err);
    }
    return rc;
}

int orl_job_output_list_sequence(const json_t *results, const char *folder, json_t *list,
                                 struct orl_error *err)
{
    static const char *const keys[] = {"sheet", "animation", "dgp_png", "dgp_svg"};
    const json_t *strip, *frame;
    size_t i, k;
    int rc = 0;
    json_array_foreach(json_object_get(results, "sequence"), i, strip)
    {
        json_array_foreach(json_object_get(strip, "frames"), k, frame)
        {
            rc = rc ? rc : orl_job_output_list(json_string_value(frame), folder, list, err);
        }
        for (k = 0; k < sizeof keys / sizeof *keys && rc == 0; k++) {
            const char *name = json_string_value(json_object_get(strip, keys[k]));
            rc = name ? orl_job_output_list(name, folder, list, err) : 0;
        }
    }
    return rc;
}

static bool is_listed(const json_t *list, const char *name)
{
    const json_t *entry;
    size_t i;
    json_array_foreach(list, i, entry)
    {
        const char *listed = json_string_value(json_object_get(entry, "name"));
        if (listed && strcmp(listed, name) == 0)
            return true;
    }
    return false;
}

void orl_job_output_prune(const json_t *list, const char *folder)
{
    char path[ORL_PATH_MAX];
    DIR *entries = opendir(folder);
    for (const struct dirent *entry; entries && (entry = readdir(entries));) {
        if (entry->d_name[0] == '.' || is_listed(list, entry->d_name))
            continue;
        orl_job_output_path(folder, entry->d_name, path);
        unlink(path);
    }
    if (entries)
        closedir(entries);
}

/* A document as a file, on the list. */
static int write_document(const json_t *doc, const char *name, const char *folder, json_t *list,
                          struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    char *text = doc ? orl_json_text(doc, JSON_INDENT(1)) : NULL;
    if (!text)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the result");
    orl_job_output_path(folder, name, path);
    const int rc = orl_write_file(path, text, strlen(text), err);
    free(text);
    return rc ? rc : orl_job_output_list(name, folder, list, err);
}

static const char result_file[] = "result.json";

/* The summary as text; takes it, NULL included, which is an error. */
static int dump_summary(json_t *summary, char **ret_summary, struct orl_error *err)
{
    char *text = summary ? orl_json_text(summary, JSON_COMPACT) : NULL;
    json_decref(summary);
    if (!text)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    *ret_summary = text;
    return 0;
}

/* The first of a document's warnings, as many as are told while a job runs. */
static json_t *first_warnings(const json_t *doc)
{
    const json_t *warnings = json_object_get(doc, "warnings");
    const size_t count = json_array_size(warnings);
    json_t *first = json_array();
    int rc = first ? 0 : -1;
    for (size_t i = 0; i < count && i < ORL_JOB_WARNINGS; i++)
        rc |= json_array_append(first, json_array_get(warnings, i));
    if (count > ORL_JOB_WARNINGS)
        rc |= json_array_append_new(first,
                                    json_sprintf("and %zu more, which %s has",
                                                 count - (size_t)ORL_JOB_WARNINGS, result_file));
    if (rc) {
        json_decref(first);
        return NULL;
    }
    return first;
}

int orl_job_output_write(const struct orl_result *result, const char *state, const char *folder,
                         char **ret_summary, struct orl_error *err)
{
    json_t *doc = orl_result_to_json(result, state);
    json_t *files = json_array();
    int rc = write_document(doc, result_file, folder, files, err);
    for (size_t i = 0; i < result->n_views && rc == 0; i++)
        rc = orl_job_output_list_view(&result->views[i], folder, files, err);
    if (rc == 0)
        rc = orl_job_output_list_sensors(&result->sensor_files, folder, files, err);
    if (rc == 0)
        rc = dump_summary(json_pack("{s:s, s:O, s:O, s:O, s:o, s:O*, s:O}", "technique",
                                    orl_technique_name(result->plan.technique), "threads",
                                    json_object_get(doc, "threads"), "timings_s",
                                    json_object_get(doc, "timings_s"), "maps",
                                    json_object_get(doc, "maps"), "warnings", first_warnings(doc),
                                    "accuracy", json_object_get(doc, "accuracy"), "files", files),
                          ret_summary, err);
    json_decref(files);
    json_decref(doc);
    return rc;
}

int orl_sky_output_write(const json_t *result, const char *sky, const char *folder, json_t *files,
                         struct orl_error *err)
{
    char name[96];
    snprintf(name, sizeof name, "%.80s.json", sky);
    return write_document(result, name, folder, files, err);
}

int orl_skies_output_write(json_t *results, const char *state, size_t count, const char *folder,
                           json_t *files, char **ret_summary, struct orl_error *err)
{
    const json_int_t done = (json_int_t)json_array_size(json_object_get(results, "skies"));
    int rc = orl_skies_result_end(results, state)
                 ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory")
                 : write_document(results, result_file, folder, files, err);
    if (rc == 0)
        rc = dump_summary(json_pack("{s:O, s:O, s:{s:I, s:I}, s:o, s:O}", "threads",
                                    json_object_get(results, "threads"), "timings_s",
                                    json_object_get(results, "timings_s"), "skies", "count",
                                    (json_int_t)count, "done", done, "warnings",
                                    first_warnings(results), "files", files),
                          ret_summary, err);
    return rc;
}

int orl_study_output_write(const struct orl_study *study, const struct orl_study_request *request,
                           const char *folder, char **ret_summary, struct orl_error *err)
{
    static const enum orl_canvas_kind kinds[] = {ORL_CANVAS_SVG, ORL_CANVAS_PNG};
    static const char *const drawn[] = {"study.svg", "study.png"};
    char path[ORL_PATH_MAX];
    json_t *doc = orl_study_to_json(study, request);
    json_t *files = json_array();
    int rc = write_document(doc, result_file, folder, files, err);
    snprintf(path, sizeof path, "%s/study.csv", folder);
    if (rc == 0)
        rc = orl_study_write_csv(study, path, err);
    if (rc == 0)
        rc = orl_job_output_list("study.csv", folder, files, err);
    for (size_t i = 0; i < 2 && rc == 0; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, drawn[i]);
        rc = orl_study_chart_write(study, request->title, kinds[i], path, err);
        if (rc == 0)
            rc = orl_job_output_list(drawn[i], folder, files, err);
    }
    if (rc == 0)
        rc = dump_summary(json_pack("{s:O, s:o, s:O}", "threads", json_object_get(doc, "threads"),
                                    "warnings", first_warnings(doc), "files", files),
                          ret_summary, err);
    json_decref(files);
    json_decref(doc);
    return rc;
}
