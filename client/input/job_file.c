#include "input/job_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/limits.h>

#include "distributed/atomic_files.h"
#include "input/input_folders.h"
#include "job/job_json.h"
#include "json/decode.h"

/* Returns the folder part of path, "." if there is none. */
static int folder_of(const char *path, char *ret_folder, size_t size, struct orl_error *err)
{
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    if (length >= size)
        return orl_error_set(err, ORL_ERR_LIMIT, "the document's path is too long");
    if (!slash)
        snprintf(ret_folder, size, ".");
    else if (length == 0)
        snprintf(ret_folder, size, "/");
    else
        snprintf(ret_folder, size, "%.*s", (int)length, path);
    return 0;
}

/* Returns true if a '{' follows white space and a byte-order mark. */
static bool begins_as_object(const char *text, size_t size)
{
    size_t i = 0;
    while (i < size && strchr(" \t\r\n\xef\xbb\xbf", text[i]) && text[i])
        i++;
    return i < size && text[i] == '{';
}

static int read_document(struct orl_job_file *file, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_file text;
    int rc = folder_of(file->path, file->folder, sizeof file->folder, err);
    if (rc)
        return rc;
    rc = here.open(here.ctx, file->path, &text, err);
    if (rc)
        return rc;
    if (text.size > ORL_LIMIT_JOB_BYTES)
        rc = orl_error_set(err, ORL_ERR_LIMIT, "the job document is larger than %lu MiB",
                           ORL_LIMIT_JOB_BYTES >> 20);
    else
        rc = orl_json_parse(file->path, text.data, text.size, &file->doc, err);
    if (rc == ORL_ERR_SYNTAX && !begins_as_object(text.data, text.size))
        orl_error_hint(err, "the file must be a JSON document");
    here.close(here.ctx, &text);
    return rc;
}

/* Requires sensors or views of a render job. The message is about the project, which may have
 * none. */
static int check_project_members(const char *path, const json_t *doc, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if ((kind && strcmp(kind, "render") != 0) || json_object_get(doc, "sensors") ||
        json_object_get(doc, "grids") || json_array_size(json_object_get(doc, "views")) > 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "the project has no sensor grids and no views");
    orl_error_at(err, path, 0, NULL);
    orl_error_hint(err,
                   "Add grids or views to the model, or write a job with \"scene\": "
                   "{\"project\": \"%.200s\"} and \"sensors\" or \"views\"",
                   path);
    return ORL_ERR_INVALID;
}

/* Replaces names such as "../place.epw" by absolute paths. The project is in another folder,
 * which has links only to the entries of the document's own folder. */
static int lead_from_root(json_t *value, const char *folder, json_t **ret_instead,
                          struct orl_error *err)
{
    const char *name = json_string_value(value), *key;
    char path[4096], whole[PATH_MAX];
    json_t *item, *instead;
    size_t i;
    int rc = 0;
    *ret_instead = NULL;
    if (name && strncmp(name, "../", 3) == 0 &&
        orl_join_path(folder, name, path, sizeof path, NULL) == 0 && realpath(path, whole))
        *ret_instead = json_string(whole);
    json_object_foreach(value, key, item)
    {
        rc = rc ? rc : lead_from_root(item, folder, &instead, err);
        if (rc == 0 && instead)
            rc = json_object_set_new(value, key, instead);
    }
    json_array_foreach(value, i, item)
    {
        rc = rc ? rc : lead_from_root(item, folder, &instead, err);
        if (rc == 0 && instead)
            rc = json_array_set_new(value, i, instead);
    }
    return rc ? orl_error_no_memory(err) : 0;
}

/* Replaces "scene": {"project": PATH, ...} by the project's contents. */
static int resolve_project(struct orl_job_file *file, const char *beside, struct orl_error *err)
{
    json_t *scene = json_incref(json_object_get(file->doc, "scene"));
    const char *named = json_string_value(json_object_get(scene, "project"));
    char path[4096];
    json_t *instead;
    int rc = named ? orl_join_path(file->folder, named, path, sizeof path, err) : 0;
    if (rc == 0 && named)
        rc = orl_project_open(scene, path, beside, &file->project, err);
    if (rc == 0 && named && beside)
        rc = lead_from_root(file->doc, file->folder, &instead, err);
    if (named)
        named = json_string_value(json_object_get(scene, "project"));
    if (rc == 0 && named) {
        orl_project_list(file->project.project);
        snprintf(file->folder, sizeof file->folder, "%s", file->project.folder);
        rc = orl_project_fill_document(&file->project, scene, file->doc, err);
        rc = rc ? rc : check_project_members(named, file->doc, err);
    }
    json_decref(scene);
    return rc;
}

int orl_job_file_read(const char *path, struct orl_job_file *ret_file, struct orl_error *err)
{
    *ret_file = (struct orl_job_file){.path = path};
    int rc = read_document(ret_file, err);
    return rc ? rc : resolve_project(ret_file, ret_file->folder, err);
}

/* Parses "GROUP=STATE,...". */
static int read_states(const char *text, json_t *scene, struct orl_error *err)
{
    json_t *states = json_object();
    int rc = json_object_set_new(scene, "states", states);
    while (rc == 0 && *text) {
        const size_t length = strcspn(text, ","), group = strcspn(text, "=,");
        if (group == length)
            rc = orl_error_set(err, ORL_ERR_INVALID, "--states takes GROUP=STATE,...");
        else
            rc = json_object_setn_new(states, text, group,
                                      json_stringn(text + group + 1, length - group - 1));
        text += length + (text[length] == ',');
    }
    return rc ? orl_error_set(err, ORL_ERR_INVALID, "--states takes GROUP=STATE,...") : 0;
}

int orl_project_scene_to_json(const char *path, const struct orl_project_line *line,
                              json_t **ret_scene, struct orl_error *err)
{
    json_t *scene = json_pack("{s:s}", "project", path);
    int rc = scene ? 0 : orl_error_set(err, ORL_ERR_INVALID, "the project's path is not UTF-8");
    if (rc == 0 && line->states)
        rc = read_states(line->states, scene, err);
    if (rc == 0 && line->sky && line->sky[0] != '{')
        json_object_set_new(scene, "sky", json_string(line->sky));
    *ret_scene = scene;
    return rc;
}

bool orl_project_line_has_year(const struct orl_project_line *line)
{
    return line->weather || line->rules || line->year;
}

/* Refuses options that exclude each other: a year takes its sky and rows from a weather file. */
static int check_line(const struct orl_project_line *line, struct orl_error *err)
{
    if (line->weather && line->sky)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "--sky is for one moment, and --weather for a year: leave one out");
    if (line->weather || !orl_project_line_has_year(line))
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "--rules and --year are for a year of a project");
    orl_error_hint(err, "give --weather FILE.epw, too");
    return ORL_ERR_INVALID;
}

/* Fails if a year of the project lacks grids. */
static int check_year(const struct orl_job_file *file, const struct orl_project_line *line,
                      struct orl_error *err)
{
    if (!line->weather || json_object_get(file->doc, "grids"))
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "%s has no sensor grids, which a year needs", file->path);
    orl_error_hint(err, "add sensor grids to the model, or use it as \"scene\": {\"project\": ...} "
                        "in a document with \"grids\"");
    return ORL_ERR_INVALID;
}

/* Parses "NAME, NAME" as an array. */
static json_t *read_rules(const char *text)
{
    json_t *rules = json_array();
    while (text && *text) {
        text += strspn(text, " ");
        const size_t length = strcspn(text, ",");
        json_array_append_new(rules, json_stringn(text, length));
        text += length + (text[length] == ',');
    }
    return rules;
}

/* Text that is no whole number stays text, and the decoder refuses it. */
static json_t *read_year(const char *text)
{
    char *end = NULL;
    const long year = strtol(text, &end, 10);
    return end > text && *end == '\0' ? json_integer(year) : json_string(text);
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Links the weather file into the project's folder. */
static int link_weather(const struct orl_job_file *file, const char *path, struct orl_error *err)
{
    char whole[PATH_MAX];
    if (!realpath(path, whole))
        return orl_error_set(err, orl_err_of_errno(errno), "cannot open '%.300s': %s", path,
                             strerror(errno));
    return orl_temp_folder_link(file->folder, name_of(path), whole, err);
}

/* Links the weather file of a --sky option: below the current folder, or else the project's own
 * file. */
static int link_sky_weather(const struct orl_job_file *file, struct orl_error *err)
{
    json_t *weather = json_object_get(json_object_get(file->doc, "sky"), "weather");
    const char *path = json_string_value(json_object_get(weather, "file"));
    if (!path || access(path, F_OK) != 0)
        return 0;
    int rc = link_weather(file, path, err);
    if (rc == 0 && json_object_set_new(weather, "file", json_string(name_of(path))) != 0)
        rc = orl_error_no_memory(err);
    return rc;
}

static int make_year(json_t *doc, const struct orl_project_line *line, struct orl_error *err)
{
    int rc = json_object_set_new(doc, "kind", json_string("annual"));
    rc |= json_object_set_new(doc, "weather", json_string(name_of(line->weather)));
    if (rc == 0 && line->rules)
        rc = json_object_set_new(doc, "rules", read_rules(line->rules));
    if (rc == 0 && line->year)
        rc = json_object_set_new(doc, "year", read_year(line->year));
    return rc ? orl_error_set(err, ORL_ERR_INVALID, "the weather file's name is not UTF-8") : 0;
}

static int make_document(struct orl_job_file *file, const struct orl_project_line *line,
                         struct orl_error *err)
{
    json_t *scene = NULL, *sky = NULL;
    int rc = orl_project_scene_to_json(file->path, line, &scene, err);
    file->doc = json_pack("{s:s, s:o*}", "kind", "render", "scene", scene);
    if (rc == 0 && file->doc && line->weather)
        rc = make_year(file->doc, line, err);
    if (rc == 0 && !file->doc)
        rc = orl_error_no_memory(err);
    if (rc == 0 && line->sky && line->sky[0] == '{') {
        rc = orl_json_parse("--sky", line->sky, strlen(line->sky), &sky, err);
        if (rc == 0)
            json_object_set_new(file->doc, "sky", sky);
    }
    return rc;
}

/* Reads a document in a place where a project is also allowed. */
static int read_job(const char *path, struct orl_job_file *ret_file, struct orl_error *err)
{
    const int rc = orl_job_file_read(path, ret_file, err);
    if (rc == ORL_ERR_SYNTAX && !ret_file->doc && err->hint[0])
        orl_error_hint(err, "the file must be a JSON job document that lists the scene's files, or "
                            "a project: a Honeybee model or folder, or a .rif file");
    return rc;
}

int orl_job_file_open(const char *path, const struct orl_project_line *line,
                      struct orl_job_file *ret_file, struct orl_error *err)
{
    if (!orl_is_project(path)) {
        if (!line->sky && !line->states && !line->weather && !line->rules && !line->year)
            return read_job(path, ret_file, err);
        *ret_file = (struct orl_job_file){.path = path};
        return orl_error_set(
            err, ORL_ERR_INVALID, "%s only for projects: write these settings into the document",
            line->weather || line->rules || line->year ? "--weather, --year and --rules are"
                                                       : "--sky and --states are");
    }
    *ret_file = (struct orl_job_file){.path = path, .folder = "."};
    int rc = check_line(line, err);
    if (rc == 0)
        rc = make_document(ret_file, line, err);
    if (rc == 0)
        rc = resolve_project(ret_file, NULL, err);
    if (rc == 0 && line->weather)
        rc = link_weather(ret_file, line->weather, err);
    if (rc == 0)
        rc = link_sky_weather(ret_file, err);
    return rc ? rc : check_year(ret_file, line, err);
}

int orl_job_file_make(json_t *doc, const char *path, struct orl_job_file *ret_file,
                      struct orl_error *err)
{
    *ret_file = (struct orl_job_file){.path = path, .doc = json_incref(doc), .folder = "."};
    return resolve_project(ret_file, NULL, err);
}

int orl_job_file_link(const struct orl_job_file *file, const char *path, struct orl_error *err)
{
    return link_weather(file, path, err);
}

void orl_job_file_done(struct orl_job_file *file)
{
    if (!file)
        return;
    json_decref(file->doc);
    orl_project_done(&file->project);
}

/* Adds a hint with the command for documents of that kind. */
static void hint_command(const struct orl_job_file *file, struct orl_error *err)
{
    static const struct {
        const char *kind, *command;
    } commands[] = {{"annual", "annual"},
                    {"study", "study"},
                    {"bsdf_make", "bsdf make"},
                    {"bsdf_fit", "bsdf fit"}};
    const char *kind = json_string_value(json_object_get(file->doc, "kind"));
    for (size_t i = 0; kind && i < sizeof commands / sizeof *commands; i++)
        if (strcmp(kind, commands[i].kind) == 0)
            orl_error_hint(err, "use `oriel %s` for such a document", commands[i].command);
}

int orl_job_file_decode(const struct orl_job_file *file, struct orl_job *ret_job,
                        struct orl_error *err)
{
    struct orl_error found = {0};
    struct orl_job job = {0};
    int rc = orl_job_from_json(file->doc, ORL_JOB_LOCAL, &job, NULL, &found);
    if (rc == 0)
        rc = orl_job_validate(&job, &found);
    if (rc) {
        hint_command(file, &found);
        orl_job_done(&job);
        orl_error_at(&found, file->path, 0, NULL);
        if (err)
            *err = found;
        return rc;
    }
    *ret_job = job;
    return 0;
}

static int append_sensor(void *array, const double v[6])
{
    return json_array_append_new(array, json_pack("[ffffff]", v[0], v[1], v[2], v[3], v[4], v[5]));
}

/* Replaces "sensors" of holder. */
static int inline_sensors(json_t *holder, const struct orl_files *folder, struct orl_error *err)
{
    const json_t *sensors = json_object_get(holder, "sensors");
    const char *name = json_string_value(json_object_get(sensors, "file"));
    struct orl_file text;
    json_t *array;
    int rc;
    if (!name)
        return 0; /* absent, an array, or invalid, which the daemon reports */
    rc = folder->open(folder->ctx, name, &text, err);
    if (rc)
        return rc;
    array = json_array();
    rc = array ? orl_sensors_read(name, text.data, text.size, append_sensor, array, err)
               : orl_error_no_memory(err);
    folder->close(folder->ctx, &text);
    if (rc == 0 && json_object_set(holder, "sensors", array) != 0)
        rc = orl_error_no_memory(err);
    json_decref(array);
    return rc;
}

int orl_job_file_inline_sensors(struct orl_job_file *file, struct orl_error *err)
{
    const struct orl_files folder = orl_files_from_folder(file->folder);
    int rc = inline_sensors(file->doc, &folder, err);
    json_t *grid;
    size_t i;
    json_array_foreach(json_object_get(file->doc, "grids"), i, grid)
    {
        rc = rc ? rc : inline_sensors(grid, &folder, err);
    }
    return rc;
}

/* Replaces "file" and "entry" of a view by the options they name. */
static int inline_view(json_t *view, const struct orl_files *folder, struct orl_error *err)
{
    const char *name = json_string_value(json_object_get(view, "file"));
    const json_t *entry = json_object_get(view, "entry");
    struct orl_file text;
    char number[24], *options = NULL;
    if (!name)
        return 0;
    snprintf(number, sizeof number, "%lld", (long long)json_integer_value(entry));
    int rc = folder->open(folder->ctx, name, &text, err);
    if (rc)
        return rc;
    rc = orl_view_file_read(name, text.data, text.size,
                            json_is_integer(entry) ? number : json_string_value(entry), &options,
                            err);
    folder->close(folder->ctx, &text);
    if (rc)
        return rc;
    char *whole = orl_view_text_join(options, json_string_value(json_object_get(view, "view")));
    if (!whole || json_object_set_new(view, "view", json_string(whole)))
        rc = orl_error_no_memory(err);
    json_object_del(view, "file");
    json_object_del(view, "entry");
    free(options);
    free(whole);
    return rc;
}

int orl_job_file_inline_views(struct orl_job_file *file, struct orl_error *err)
{
    const struct orl_files folder = orl_files_from_folder(file->folder);
    json_t *view;
    size_t i;
    int rc = 0;
    json_array_foreach(json_object_get(file->doc, "views"), i, view)
    {
        rc = rc ? rc : inline_view(view, &folder, err);
    }
    return rc;
}
