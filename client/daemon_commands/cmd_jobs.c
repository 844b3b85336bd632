/*
 * oriel submit JOB.json: uploads the files that the document names, posts the job, study or
 * year, and prints its id. oriel wait ID waits for a job, with progress on stderr. oriel cancel ID
 * cancels a job and returns when it has stopped.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon_commands/follow_job.h"
#include "http/http_client.h"
#include "http/json_get.h"
#include "http/upload_bundle.h"
#include "input/job_file.h"
#include "job/job_request_json.h"
#include "options/command.h"
#include "output/reports.h"

/* Returns the document's member that names the files to upload. */
static const char *files_member(const struct orl_job_file *file)
{
    const char *kind = json_string_value(json_object_get(file->doc, "kind"));
    return kind && strcmp(kind, orl_job_request_kind_name(ORL_JOB_KIND_BSDF_FIT)) == 0
               ? "measurements"
               : "scene";
}

/* Uploads {"files": [...]}, of a scene or of measurements, and replaces it by the upload's id.
 * An id is left as it is. */
static int send_scene(struct orl_http *http, struct orl_job_file *file, struct orl_error *err)
{
    struct orl_upload bundle = {0};
    struct orl_job_request job_request = {0};
    char *id = NULL;
    if (!json_is_object(json_object_get(file->doc, files_member(file))))
        return 0;
    /* Decoding it as a local job finds errors before anything is sent. */
    int rc = orl_job_request_from_json(file->doc, ORL_JOB_LOCAL, &job_request, NULL, err);
    if (rc) {
        orl_error_at(err, file->path, 0, NULL);
        return rc;
    }
    rc = orl_job_bundle_collect(file->folder, &job_request, &bundle, err);
    if (rc == 0)
        rc = orl_bundle_upload(&bundle, http, &id, err);
    if (rc == 0 && json_object_set_new(file->doc, files_member(file), json_string(id)) != 0)
        rc = orl_error_no_memory(err);
    free(id);
    orl_bundle_done(&bundle);
    orl_job_request_done(&job_request);
    return rc;
}

/* Returns true if sensors and views are put into the document, for render jobs and studies, so
 * that other sensors do not need another upload. A year's files stay files, which its
 * provenance names. */
static bool is_inlined(const struct orl_job_file *file)
{
    const char *kind = json_string_value(json_object_get(file->doc, "kind"));
    return !kind || strcmp(kind, orl_job_request_kind_name(ORL_JOB_KIND_ANNUAL)) != 0;
}

/* Sets name and tags from the command line, which override the document's. */
static int set_labels(struct orl_job_file *file, const char *name, const char *tags,
                      struct orl_error *err)
{
    json_t *list = tags ? json_array() : NULL;
    int rc = name ? json_object_set_new(file->doc, "name", json_string(name)) : 0;
    while (tags && *tags && rc == 0) {
        const size_t length = strcspn(tags, ",");
        rc = json_array_append_new(list, json_stringn(tags, length));
        tags += length + (tags[length] == ',');
    }
    if (list && rc == 0)
        rc = json_object_set(file->doc, "tags", list);
    json_decref(list);
    return rc ? orl_error_set(err, ORL_ERR_INVALID, "--name and --tags must be UTF-8 text") : 0;
}

/* Submits the job. *ret_reply: the job's first document, from the daemon's 202. */
static int submit_job(struct orl_http *http, const char *path,
                      const struct orl_project_line *project, const char *name, const char *tags,
                      json_t **ret_reply, struct orl_error *err)
{
    struct orl_job_file file = {0};
    int rc = orl_job_file_open(path, project, &file, err);
    if (rc == 0)
        rc = set_labels(&file, name, tags, err);
    if (rc == 0 && is_inlined(&file))
        rc = orl_job_file_inline_sensors(&file, err);
    if (rc == 0 && is_inlined(&file))
        rc = orl_job_file_inline_views(&file, err);
    if (rc == 0)
        rc = send_scene(http, &file, err);
    if (rc == 0)
        rc = orl_http_post_json(http, "/v1/jobs", file.doc, ret_reply, err);
    orl_job_file_done(&file);
    return rc;
}

int orl_cmd_submit(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const char *name = NULL, *tags = NULL;
    struct orl_project_line project = {0};
    bool wait = false;
    const struct orl_option options[] = {
        ORL_OPTION_SERVER(&daemon.server),
        {"name", 0, "NAME", "name of the job", &name, NULL},
        {"tags", 0, "TAG,...", "tags to find the job by, as with oriel status --tag", &tags, NULL},
        {"wait", 0, NULL, "follow the job to its end", NULL, &wait},
        ORL_OPTIONS_MODEL(&project),
    };
    json_t *reply = NULL;
    int rc, code;
    if (!orl_options_parse(self, argc, argv, options, 4 + ORL_MODEL_OPTIONS, 1, 1, &daemon.operands,
                           &code))
        return code;
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = submit_job(&daemon.http, daemon.operands.items[0], &project, name, tags, &reply,
                        &daemon.err);
    if (rc) {
        code = orl_report_error(&daemon.err);
    } else {
        printf("%s\n", orl_get_text(reply, "id"));
        code = wait ? orl_follow_job(&daemon.http, orl_get_text(reply, "id")) : ORL_EXIT_OK;
    }
    json_decref(reply);
    orl_http_close(&daemon.http);
    return code;
}

/* ---- oriel wait ------------------------------------------------------------------------------ */

int orl_cmd_wait(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const struct orl_option options[] = {ORL_OPTION_SERVER(&daemon.server)};
    int code;
    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &daemon.operands, &code))
        return code;
    if (orl_daemon_open(&daemon))
        code = orl_report_error(&daemon.err);
    else
        code = orl_follow_job(&daemon.http, daemon.operands.items[0]);
    orl_http_close(&daemon.http);
    return code;
}

/* ---- oriel cancel ---------------------------------------------------------------------------- */

int orl_cmd_cancel(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_daemon_command daemon = {0};
    const struct orl_option options[] = {ORL_OPTION_SERVER(&daemon.server)};
    json_t *nothing, *job = NULL;
    char path[1024];
    int rc;
    if (!orl_options_parse(self, argc, argv, options, 1, 1, 1, &daemon.operands, &rc))
        return rc;
    nothing = json_object();
    rc = orl_daemon_open(&daemon);
    if (rc == 0)
        rc = orl_job_path(daemon.operands.items[0], "/cancel", path, sizeof path, &daemon.err);
    if (rc == 0)
        rc = orl_http_post_json(&daemon.http, path, nothing, &job, &daemon.err);
    if (rc == 0 && !(job && orl_job_has_ended(job))) {
        fprintf(stderr, "job %s: cancelling\n", daemon.operands.items[0]);
        json_decref(job);
        job = NULL;
        rc = orl_await_job(&daemon.http, daemon.operands.items[0], &job, &daemon.err);
    }
    if (rc == 0)
        fprintf(stderr, "job %s: %s\n", daemon.operands.items[0], orl_get_text(job, "state"));
    json_decref(job);
    json_decref(nothing);
    return orl_daemon_end(&daemon, rc);
}
