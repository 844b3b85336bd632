#include "runner/job_output.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/sha256.h>
#include <oriel/base/thread_pool.h>

#include "chart/charts.h"
#include "job/study_json.h"
#include "result/result_json.h"
#include "store/files/folders.h"
#include "json/encode.h"

void orl_job_output_path(const char *folder, const char *name, char ret_path[ORL_PATH_MAX])
{
    snprintf(ret_path, ORL_PATH_MAX, "%.*s/%.400s", ORL_PATH_MAX - 512, folder, name);
}

static _Thread_local const atomic_bool *cancel_flag;

void orl_job_output_set_cancel(const atomic_bool *cancel)
{
    cancel_flag = cancel;
}

/* Computes the digest in steps and polls the cancel flag between them: a gigabyte takes some
 * seconds. */
static int find_digest(const struct orl_file *file, char ret_sha[ORL_SHA_HEX],
                       struct orl_error *err)
{
    enum { STEP = 16 << 20 };
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    for (size_t at = 0; at < file->size; at += STEP) {
        if (orl_is_cancelled(cancel_flag))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while listing results");
        orl_sha256_add(&hash, file->data + at, file->size - at < STEP ? file->size - at : STEP);
    }
    orl_sha256_finish_hex(&hash, ret_sha);
    return 0;
}

int orl_job_output_list(const char *name, const char *folder, json_t *list, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    struct orl_file file;
    char sha[ORL_SHA_HEX];
    if (!name)
        return 0;
    orl_job_output_path(folder, name, path);
    int rc = orl_sync_path(path, err);
    if (rc == 0)
        rc = orl_map_file(path, &file, err);
    if (rc)
        return rc;
    const json_int_t bytes = (json_int_t)file.size;
    rc = find_digest(&file, sha, err);
    orl_unmap_file(&file);
    if (rc)
        return rc;
    return json_array_append_new(
               list, json_pack("{s:s, s:I, s:s}", "name", name, "bytes", bytes, "sha256", sha))
               ? orl_error_no_memory(err)
               : 0;
}

static int list_names(const char *const names[], size_t count, const char *folder, json_t *list,
                      struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < count && rc == 0; i++)
        rc = orl_job_output_list(names[i], folder, list, err);
    return rc;
}

int orl_job_output_list_view(const struct orl_view_result *view, const char *folder, json_t *list,
                             struct orl_error *err)
{
    return list_names((const char *const *)view->files, ORL_PICTURES, folder, list, err);
}

int orl_job_output_list_sensors(const struct orl_sensor_files *sensors, const char *folder,
                                json_t *list, struct orl_error *err)
{
    const char *const tables[] = {sensors->csv, sensors->res};
    int rc = list_names(tables, 2, folder, list, err);
    for (size_t i = 0; i < sensors->n_maps && rc == 0; i++) {
        const char *const maps[] = {sensors->maps[i].png, sensors->maps[i].svg,
                                    sensors->maps[i].dat};
        rc = list_names(maps, 3, folder, list, err);
    }
    return rc;
}

int orl_job_output_list_grids(const struct orl_result *result, const char *folder, json_t *list,
                              struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < result->n_grids && rc == 0; i++) {
        const char *const files[] = {result->grids[i].res, result->grids[i].npy,
                                     result->grids[i].map};
        rc = list_names(files, 3, folder, list, err);
    }
    return rc ? rc : orl_job_output_list(result->grids_info, folder, list, err);
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
            rc = orl_job_output_list(name, folder, list, err);
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

/* Writes a document as a file, and appends it to the list. */
static int write_document(const json_t *doc, const char *name, const char *folder, json_t *list,
                          struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    char *text = orl_json_text(doc, JSON_INDENT(1));
    if (!text)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the result");
    orl_job_output_path(folder, name, path);
    const int rc = orl_write_file(path, text, strlen(text), err);
    free(text);
    return rc ? rc : orl_job_output_list(name, folder, list, err);
}

static const char result_file[] = "result.json";

/* Returns the summary as text. Takes ownership of it; NULL is an error. */
static int dump_summary(json_t *summary, char **ret_summary, struct orl_error *err)
{
    char *text = orl_json_text(summary, JSON_COMPACT);
    json_decref(summary);
    if (!text)
        return orl_error_no_memory(err);
    *ret_summary = text;
    return 0;
}

/* Returns the first of a document's warnings, as many as are reported while a job runs. */
static json_t *first_warnings(const json_t *doc)
{
    const json_t *warnings = json_object_get(doc, "warnings");
    const size_t count = json_array_size(warnings);
    json_t *first = json_array();
    int rc = first ? 0 : -1;
    for (size_t i = 0; i < count && i < ORL_JOB_WARNINGS; i++)
        rc |= json_array_append(first, json_array_get(warnings, i));
    if (count > ORL_JOB_WARNINGS)
        rc |= json_array_append_new(
            first,
            json_sprintf("and %zu more, in %s", count - (size_t)ORL_JOB_WARNINGS, result_file));
    return orl_json_checked(first, rc);
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
        rc = orl_job_output_list_grids(result, folder, files, err);
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
                 ? orl_error_no_memory(err)
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

/* ---- BSDFs ----------------------------------------------------------------------------------- */

static json_t *bsdf_document(const struct orl_bsdf_output *o)
{
    json_t *doc = o->report;
    json_t *more =
        json_pack("{s:s, s:i, s:{s:f, s:f}, s:[o], s:{s:s, s:s, s:I}, s:o}", "state", "succeeded",
                  "threads", (int)o->threads, "timings_s", "making", o->kept->seconds, "total",
                  o->total_s, "maps", orl_map_info_to_json(o->kept), "bsdf", "id", o->id, "file",
                  o->file, "bytes", (json_int_t)o->bytes, "warnings", o->warnings);
    if (doc && more && json_object_update(doc, more) == 0) {
        json_decref(more);
        return doc;
    }
    json_decref(doc);
    json_decref(more);
    return NULL;
}

int orl_bsdf_output_write(const struct orl_bsdf_output *output, const char *folder,
                          char **ret_summary, struct orl_error *err)
{
    json_t *doc = bsdf_document(output);
    json_t *files = json_array();
    int rc = write_document(doc, result_file, folder, files, err);
    if (rc == 0)
        rc = orl_job_output_list(output->file, folder, files, err);
    if (rc == 0)
        rc = dump_summary(
            json_pack("{s:O, s:O, s:O, s:O, s:o, s:O}", "threads", json_object_get(doc, "threads"),
                      "timings_s", json_object_get(doc, "timings_s"), "maps",
                      json_object_get(doc, "maps"), "bsdf", json_object_get(doc, "bsdf"),
                      "warnings", first_warnings(doc), "files", files),
            ret_summary, err);
    json_decref(files);
    json_decref(doc);
    return rc;
}

/* ---- Annual jobs ---------------------------------------------------------------------------- */

static int add_verdict(json_t *verdicts, const json_t *of)
{
    static const char *const keys[] = {"rule",  "target",      "grid",    "unit",
                                       "value", "interval_95", "verdict", "note"};
    if (json_array_size(verdicts) >= ORL_JOB_VERDICTS)
        return 0;
    json_t *copy = json_object();
    int rc = copy ? 0 : -1;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        json_t *value = json_object_get(of, keys[i]);
        rc |= json_object_set_new(copy, keys[i], value ? json_incref(value) : json_null());
    }
    return rc | json_array_append_new(verdicts, copy);
}

/* Adds the verdicts on targets of rules, or those on the job's own targets. */
static int add_verdicts(json_t *verdicts, const json_t *of, bool of_rules)
{
    const json_t *one;
    size_t i;
    int rc = 0;
    json_array_foreach(of, i, one)
    {
        if (json_is_null(json_object_get(one, "rule")) != of_rules)
            rc |= add_verdict(verdicts, one);
    }
    return rc;
}

/* Returns the verdicts of each rule as a whole, of each of the job's own targets, and of each
 * target of a rule. */
static json_t *short_verdicts(const json_t *document)
{
    json_t *verdicts = json_array();
    const json_t *all = json_object_get(document, "verdicts");
    int rc = verdicts ? 0 : -1;
    rc |= add_verdicts(verdicts, json_object_get(document, "rules"), true);
    rc |= add_verdicts(verdicts, all, false);
    rc |= add_verdicts(verdicts, all, true);
    return orl_json_checked(verdicts, rc);
}

/* Syncs the folders of a name, below the results' folder. Skips folders that the next name is also
 * in: they are synced once all their files exist. */
static int sync_folders(const char *next, const char *name, const char *folder,
                        struct orl_error *err)
{
    char path[ORL_PATH_MAX], part[256];
    int rc = 0;
    for (const char *slash = strchr(name, '/'); slash && rc == 0; slash = strchr(slash + 1, '/')) {
        if (strncmp(next, name, (size_t)(slash - name) + 1) == 0)
            continue;
        snprintf(part, sizeof part, "%.*s", (int)(slash - name), name);
        orl_job_output_path(folder, part, path);
        rc = orl_sync_path(path, err);
    }
    return rc;
}

int orl_annual_output_write(const json_t *document, const json_t *names, const char *folder,
                            char **ret_summary, struct orl_error *err)
{
    json_t *files = json_array();
    const json_t *entry;
    size_t i;
    int rc = write_document(document, result_file, folder, files, err);
    json_array_foreach(names, i, entry)
    {
        const char *name = json_string_value(entry);
        const char *next = json_string_value(json_array_get(names, i + 1));
        rc = rc ? rc : orl_job_output_list(name, folder, files, err);
        rc = rc ? rc : sync_folders(next ? next : "", name, folder, err);
    }
    if (rc == 0)
        rc = dump_summary(json_pack("{s:O, s:O, s:{s:O, s:o}, s:o, s:O}", "threads",
                                    json_object_get(document, "threads"), "timings_s",
                                    json_object_get(document, "timings_s"), "annual", "accuracy",
                                    json_object_get(document, "accuracy"), "verdicts",
                                    short_verdicts(document), "warnings", first_warnings(document),
                                    "files", files),
                          ret_summary, err);
    json_decref(files);
    return rc;
}
