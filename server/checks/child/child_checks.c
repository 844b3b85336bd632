#include "checks/child/child_checks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/json_read.h>
#include <oriel/base/limits.h>
#include <oriel/bsdf/bsdf.h>
#include <oriel/job/run.h>

#include "bsdf_json/bsdf_json.h"
#include "checks/child/messages.h"
#include "checks/job_manifest.h"
#include "health/crash.h"
#include "project/main_files.h"
#include "project/project.h"
#include "result/result_json.h"
#include "uploads/uploads.h"
#include "json/encode.h"

/* ---- Kinds ----------------------------------------------------------------------------------- */

/* Reads the files as a project. *ret_project stays NULL if they are not a project. */
static int find_project(struct orl_child_task *task, json_t **ret_project, struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    const struct orl_bundle *bundle = &task->files.bundle;
    const json_t *wishes = json_object_get(task->request, "choice");
    const struct orl_project_choice choice = {json_object_get(wishes, "states"),
                                              json_string_value(json_object_get(wishes, "sky"))};
    const struct orl_files files = orl_mapped_inputs_provider(&task->files);
    for (size_t i = 0; i < bundle->count; i++)
        names[i] = bundle->files[i].name;
    return orl_project_find(names, bundle->count, &files, &choice, ret_project, err);
}

/* Adds to the summary the project's members other than its scene. */
static int add_project(struct orl_child_task *task, json_t *summary, struct orl_error *err)
{
    json_t *project = NULL;
    const int rc = json_object_get(task->request, "choice") ? find_project(task, &project, err) : 0;
    if (rc || !project)
        return rc;
    json_object_del(project, "files");
    return json_object_set_new(summary, "project", project) ? orl_error_no_memory(err) : 0;
}

static bool is_listed(const json_t *list, const char *name)
{
    const json_t *one;
    size_t i;
    json_array_foreach(list, i, one) if (strcmp(json_string_value(one), name) == 0) return true;
    return false;
}

/* Returns true if a file of that name holds surfaces or materials. */
static bool describes_scene(const char *name)
{
    return orl_name_has_ending(name, ".rad") || orl_name_has_ending(name, ".mat") ||
           orl_name_has_ending(name, ".hbjson");
}

/* Lists the main files, and files that describe a scene but are not read. */
static void add_files(json_t *summary, const struct orl_bundle *bundle)
{
    json_t *mains = json_array(), *unread = json_array();
    const json_t *referenced = json_object_get(summary, "referenced");
    for (size_t i = 0; i < bundle->count; i++) {
        const char *name = bundle->files[i].name;
        if (!bundle->files[i].resource)
            json_array_append_new(mains, json_string(name));
        else if (describes_scene(name) && !is_listed(referenced, name))
            json_array_append_new(unread, json_string(name));
    }
    json_object_set_new(summary, "main", mains);
    json_object_set_new(summary, "unread", unread);
}

/* Returns true if the first main file is a table of measurements. */
static bool is_measured(const struct orl_files *files, const char *name)
{
    struct orl_file file;
    if (files->open(files->ctx, name, &file, NULL) < 0)
        return false;
    const bool measured = orl_bsdf_is_measured(file.data, file.size);
    files->close(files->ctx, &file);
    return measured;
}

/* Checks the measurements of a goniophotometer. */
static int check_measurements(const struct orl_bundle *bundle, const char *const *names,
                              size_t count, const struct orl_files *files, json_t **ret_result,
                              struct orl_error *err)
{
    struct orl_bsdf_measurements found;
    const int rc = orl_bsdf_measurements_check(names, count, files, &found, err);
    if (rc)
        return rc;
    *ret_result = json_pack("{s:o}", "measurements", orl_bsdf_measurements_to_json(&found));
    if (!*ret_result)
        return orl_error_no_memory(err);
    add_files(*ret_result, bundle);
    return 0;
}

static int check_scene(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    struct orl_scene_summary summary;
    struct orl_bundle *bundle = &task->files.bundle;
    const size_t count = orl_bundle_main_count(bundle);
    for (size_t i = 0; i < count; i++)
        names[i] = bundle->files[i].name;
    const struct orl_files files = orl_mapped_inputs_provider(&task->files);
    if (count > 0 && is_measured(&files, names[0]))
        return check_measurements(bundle, names, count, &files, ret_result, err);
    int rc = orl_scene_check(names, count, &files, NULL, &summary, err);
    if (rc == 0) {
        *ret_result = orl_scene_summary_to_json(&summary);
        add_files(*ret_result, bundle);
        orl_scene_summary_done(&summary);
        rc = *ret_result ? add_project(task, *ret_result, err) : 0;
    }
    return rc;
}

static int check_bsdf(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_check found;
    const struct orl_file *file = &task->files.single;
    const struct orl_bsdf_xml xml = {.name =
                                         json_string_value(json_object_get(task->request, "name")),
                                     .data = file->data,
                                     .size = file->size};
    const int rc = orl_bsdf_load(&xml, &bsdf, err);
    if (rc)
        return rc;
    orl_bsdf_examine(bsdf, &found);
    orl_bsdf_unref(bsdf);
    *ret_result = orl_bsdf_check_to_json(&found);
    return 0;
}

static int check_job(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    struct orl_job_manifest manifest;
    const int rc = orl_job_manifest_read(&task->files.single, &manifest, err);
    if (rc == 0) {
        *ret_result = orl_job_manifest_to_json(&manifest);
        orl_job_manifest_done(&manifest);
    }
    return rc;
}

static int send_file(void *ctx, const char *name, struct orl_error *err)
{
    const struct orl_child_task *task = ctx;
    return orl_frame_send(task->fd, ORL_FRAME_FILE, name, strlen(name))
               ? 0
               : orl_error_set(err, ORL_ERR_IO, "cannot send the files to the daemon");
}

static int send_data(void *ctx, const char *data, size_t size, struct orl_error *err)
{
    const struct orl_child_task *task = ctx;
    while (size > 0) {
        const size_t n = size < ORL_FRAME_BYTES ? size : ORL_FRAME_BYTES;
        if (!orl_frame_send(task->fd, ORL_FRAME_DATA, data, n))
            return orl_error_set(err, ORL_ERR_IO, "cannot send the files to the daemon");
        data += n;
        size -= n;
    }
    return 0;
}

static int check_zip(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    const struct orl_incoming_sink sink = {send_file, send_data, task};
    struct orl_bundle files = {0};
    const int rc = orl_unzip_entries(&task->files.single, NULL, &sink, 0, &files, err);
    orl_bundle_done(&files);
    *ret_result = rc ? NULL : json_null();
    return rc;
}

static int check_files(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    const struct orl_incoming_sink sink = {send_file, send_data, task};
    return orl_scene_document_read(&task->files.single, &sink, ret_result, err);
}

static int guess_places(struct orl_mapped_inputs *mapped, unsigned *ret_places,
                        struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    const struct orl_bundle *bundle = &mapped->bundle;
    const struct orl_files files = orl_mapped_inputs_provider(mapped);
    for (size_t i = 0; i < bundle->count; i++)
        names[i] = bundle->files[i].name;
    return orl_main_files_ranks(names, bundle->count, &files, ret_places, err);
}

/* Computes the positions of a project's main files. */
static void place_project(const struct orl_bundle *bundle, const json_t *project,
                          unsigned *ret_places)
{
    const json_t *mains = json_object_get(project, "files"), *name;
    size_t i;
    memset(ret_places, 0, bundle->count * sizeof *ret_places);
    json_array_foreach(mains, i, name)
    {
        const struct orl_bundle_file *file = orl_bundle_find(bundle, json_string_value(name));
        if (file)
            ret_places[file - bundle->files] = (unsigned)i + 1;
    }
}

static int check_roles(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    unsigned places[ORL_LIMIT_SCENE_FILES];
    struct orl_bundle *bundle = &task->files.bundle;
    json_t *project = NULL;
    int rc = find_project(task, &project, err);
    if (rc == 0 && project)
        place_project(bundle, project, places);
    else if (rc == 0)
        rc = guess_places(&task->files, places, err);
    json_t *roles = rc ? NULL : json_array();
    for (size_t i = 0; roles && i < bundle->count; i++)
        json_array_append_new(roles, json_integer(places[i]));
    json_decref(project);
    *ret_result = roles;
    return rc;
}

/* ---- Files that a job names ------------------------------------------------------------------ */

/* One use of a file, and the findings of the uses before it. */
struct use {
    const char *name, *entry;
    const struct orl_file *data;
    uint64_t sensors, rows;
    struct orl_annual_steps steps; /* time steps of the weather year */
};

static int read_sensors(struct use *use, struct orl_error *err)
{
    size_t count = 0;
    const int rc = orl_sensors_check(use->name, use->data->data, use->data->size, &count, err);
    use->sensors += count;
    return rc;
}

/* Returns the year whose rows are used; 0: all rows. */
static int year_of(const struct use *use)
{
    return use->entry ? (int)strtol(use->entry, NULL, 10) : 0;
}

static int read_weather(struct use *use, struct orl_error *err)
{
    return orl_weather_check(use->name, use->data->data, use->data->size, year_of(use), err);
}

static int read_view(struct use *use, struct orl_error *err)
{
    char *text = NULL;
    const int rc =
        orl_view_file_read(use->name, use->data->data, use->data->size, use->entry, &text, err);
    free(text);
    return rc;
}

static int read_year(struct use *use, struct orl_error *err)
{
    size_t rows = 0;
    const int rc = orl_annual_weather_check(use->name, use->data->data, use->data->size,
                                            year_of(use), &use->steps, &rows, err);
    use->rows = rows;
    return rc;
}

static int read_occupancy(struct use *use, struct orl_error *err)
{
    return orl_occupancy_check(use->name, use->data->data, use->data->size, &use->steps, err);
}

static int read_use(const struct orl_mapped_inputs *files, const json_t *entry, struct use *use,
                    struct orl_error *err)
{
    static int (*const readers[ORL_FILE_ROLES])(struct use * use, struct orl_error * err) = {
        [ORL_FILE_SENSORS] = read_sensors,
        [ORL_FILE_WEATHER] = read_weather,
        [ORL_FILE_VIEW] = read_view,
        [ORL_FILE_YEAR] = read_year,
        [ORL_FILE_OCCUPANCY] = read_occupancy};
    const json_int_t role = json_integer_value(json_array_get(entry, 1));
    use->name = json_string_value(json_array_get(entry, 0));
    use->entry = json_string_value(json_array_get(entry, 2));
    const struct orl_bundle_file *file =
        use->name ? orl_bundle_find(&files->bundle, use->name) : NULL;
    if (!file || role < 0 || role >= ORL_FILE_ROLES || !readers[role])
        return orl_error_set(err, ORL_ERR_INTERNAL, "the request to the check process is invalid");
    use->data = &files->data[file - files->bundle.files];
    return readers[role](use, err);
}

static int check_inputs(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    const json_t *uses = json_object_get(task->request, "uses");
    struct use use = {0};
    int rc = 0;
    for (size_t i = 0; i < json_array_size(uses) && rc == 0; i++)
        rc = read_use(&task->files, json_array_get(uses, i), &use, err);
    struct orl_job_inputs_found found = {.sensors = use.sensors, .year_rows = use.rows};
    if (rc == 0 && task->files.single.data)
        rc = orl_child_document(task, &found, err);
    uint64_t *places[ORL_JOB_INPUTS_COUNTS];
    orl_job_inputs_counts(&found, places);
    *ret_result = rc ? NULL : orl_counts_to_json(places, ORL_JOB_INPUTS_COUNTS);
    return rc;
}

/* ---- The check ------------------------------------------------------------------------------- */

static int run_kind(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    static const struct {
        const char *name;
        int (*run)(struct orl_child_task *task, json_t **ret_result, struct orl_error *err);
    } kinds[] = {
        {"scene", check_scene},    {"bsdf", check_bsdf},     {"job", check_job},
        {"unzip", check_zip},      {"files", check_files},   {"roles", check_roles},
        {"inputs", check_inputs},  {"plan", orl_child_plan}, {"outline", orl_child_outline},
        {"polar", orl_child_polar}};
    const char *name = json_string_value(json_object_get(task->request, "kind"));
    for (size_t i = 0; name && i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i].name, name) == 0)
            return kinds[i].run(task, ret_result, err);
    return orl_error_set(err, ORL_ERR_INTERNAL,
                         "the check process does not know this kind of check");
}

/* ---- Errors ---------------------------------------------------------------------------------- */

/* Converts an error to JSON for the verdict. */
static json_t *error_to_json(const struct orl_error *err)
{
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o}", "code", err->code, "line", err->line, "file",
                     orl_json_from_text(err->file), "primitive", orl_json_from_text(err->primitive),
                     "message", orl_json_from_text(err->message), "hint",
                     orl_json_from_text(err->hint));
}

static void get_text(const json_t *json, const char *name, char *ret_text, size_t size)
{
    const char *text = json_string_value(json_object_get(json, name));
    snprintf(ret_text, size, "%s", text ? text : "");
}

void orl_child_error_from_json(const json_t *json, struct orl_error *ret_err)
{
    const json_int_t code = json_integer_value(json_object_get(json, "code"));
    const json_int_t line = json_integer_value(json_object_get(json, "line"));
    memset(ret_err, 0, sizeof *ret_err);
    ret_err->code = code < 0 && code >= ORL_ERR_UNLIT && code != ORL_ERR_CANCELLED
                        ? (int)code
                        : ORL_ERR_INTERNAL;
    ret_err->line = line > 0 && line < INT32_MAX ? (int)line : 0;
    get_text(json, "file", ret_err->file, sizeof ret_err->file);
    get_text(json, "primitive", ret_err->primitive, sizeof ret_err->primitive);
    get_text(json, "message", ret_err->message, sizeof ret_err->message);
    get_text(json, "hint", ret_err->hint, sizeof ret_err->hint);
}

/* ---- The process ----------------------------------------------------------------------------- */

static json_t *receive_request(int fd)
{
    struct orl_frame_text text = {0};
    char *packet = malloc(ORL_FRAME_BYTES + 1);
    ssize_t n = packet ? 1 : 0;
    bool complete = false;
    while (n > 0 && !complete) {
        n = recv(fd, packet, ORL_FRAME_BYTES + 1, 0);
        if (n > 0 && !orl_frame_text_add(&text, packet + 1, (size_t)n - 1, SIZE_MAX >> 1))
            break;
        complete = n > 0 && packet[0] == ORL_FRAME_REQUEST_END;
    }
    json_t *request = complete ? orl_json_read(text.text, text.size, 0, NULL) : NULL;
    free(packet);
    free(text.text);
    return request;
}

/*
 * Embree is C++: when memory runs out where it cannot throw, std::terminate is called. The child
 * reports that by its exit status.
 */
static void on_terminate(void)
{
    _exit(ORL_CHILD_NO_MEMORY);
}

static uint64_t get_number(const json_t *request, const char *name)
{
    const json_int_t value = json_integer_value(json_object_get(request, name));
    return value > 0 ? (uint64_t)value : 0;
}

void orl_child_check(int fd)
{
    struct orl_error err = {0};
    json_t *request = receive_request(fd), *result = NULL;
    struct orl_child_task task = {.fd = fd, .request = request};
    if (!request) /* requests of the daemon are well-formed, so memory must have run out */
        _exit(ORL_CHILD_NO_MEMORY);
    const struct orl_sandbox_limits bounds = {get_number(request, "memory"),
                                              (uint32_t)get_number(request, "cpu_s")};
    orl_set_terminate_handler(on_terminate);
    int rc = orl_mapped_inputs_open(request, &task.files, &err);
    orl_unzip_prepare();
    if (rc == 0)
        rc = orl_sandbox_enter(&bounds, &err);
    if (rc == 0)
        rc = run_kind(&task, &result, &err);
    if (rc == 0 && !result)
        rc = orl_error_no_memory(&err);
    json_t *verdict = rc ? json_pack("{s:o}", "error", error_to_json(&err))
                         : json_pack("{s:o}", "result", result);
    char *text = orl_json_text(verdict, JSON_COMPACT);
    if (!text)
        _exit(ORL_CHILD_NO_MEMORY);
    orl_frame_send_text(fd, ORL_FRAME_VERDICT, ORL_FRAME_VERDICT_END, text, strlen(text));
}
