#include "job_output.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "decode.h"
#include "job_json.h"
#include "result_json.h"

int orl_job_read(const char *text, size_t size, struct orl_job *ret_job, char **ret_scene_id,
                 struct orl_error *err)
{
    json_t *doc = NULL;
    struct orl_job job;
    char *scene = NULL;
    int rc = orl_json_parse(NULL, text, size, &doc, err);
    if (rc)
        return rc;
    rc = orl_job_from_json(doc, ORL_JOB_REMOTE, &job, &scene, err);
    json_decref(doc);
    if (rc)
        return rc;
    rc = orl_job_validate(&job, err);
    if (rc) {
        orl_job_done(&job);
        free(scene);
        return rc;
    }
    *ret_job = job;
    if (ret_scene_id)
        *ret_scene_id = scene;
    else
        free(scene);
    return 0;
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

/* Syncs one file of the results and appends {"name", "bytes"} to list. */
static int add_file(json_t *list, const char *folder, const char *name, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    struct stat st;
    if (!name)
        return 0;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const int rc = orl_sync_path(path, err);
    if (rc)
        return rc;
    if (stat(path, &st) != 0)
        return orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", name, strerror(errno));
    if (json_array_append_new(
            list, json_pack("{s:s, s:I}", "name", name, "bytes", (json_int_t)st.st_size)))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

static int write_result(json_t *result, const char *folder, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    char *text = result ? json_dumps(result, JSON_INDENT(1)) : NULL;
    if (!text)
        return orl_error_set(err, ORL_ERR_INTERNAL, "the result cannot be written as JSON");
    snprintf(path, sizeof path, "%s/result.json", folder);
    const int rc = orl_write_file(path, text, strlen(text), err);
    free(text);
    return rc;
}

int orl_job_output_write(const struct orl_result *result, const char *folder, char **ret_summary,
                         struct orl_error *err)
{
    char *text = NULL;
    json_t *doc = orl_result_to_json(result, "succeeded");
    json_t *files = json_array();
    int rc = write_result(doc, folder, err);
    if (rc == 0)
        rc = add_file(files, folder, "result.json", err);
    for (size_t i = 0; i < result->n_views && rc == 0; i++) {
        rc = add_file(files, folder, result->views[i].hdr, err);
        if (rc == 0)
            rc = add_file(files, folder, result->views[i].png, err);
    }
    json_t *summary = NULL;
    if (rc == 0)
        summary = json_pack("{s:s, s:O, s:O, s:O, s:O}", "technique",
                            orl_technique_name(result->plan.technique), "threads",
                            json_object_get(doc, "threads"), "timings_s",
                            json_object_get(doc, "timings_s"), "maps", json_object_get(doc, "maps"),
                            "files", files);
    if (rc == 0)
        text = summary ? json_dumps(summary, JSON_COMPACT) : NULL;
    if (rc == 0 && !text)
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    json_decref(summary);
    json_decref(files);
    json_decref(doc);
    if (rc == 0)
        *ret_summary = text;
    return rc;
}
