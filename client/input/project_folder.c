#include "input/project_folder.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/job/run.h>

#include "distributed/atomic_files.h"
#include "honeybee/hbjson.h"
#include "input/input_folders.h"
#include "project/project.h"
#include "json/decode.h"
#include "json/encode.h"

enum { PATH_SIZE = 4096, VIEW_SIDE = 800 };

/* Returns true for a file that lists a scene's files: of rad, or of frads. */
static bool is_list(const char *path)
{
    return orl_name_has_ending(path, ".rif") || orl_name_has_ending(path, ".cfg");
}

/* Returns true if the file is a model: models may be called .json, as documents are. */
static bool holds_model(const char *path)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_error err = {0};
    struct orl_file text;
    json_t *doc = NULL;
    bool model = false;
    if (here.open(here.ctx, path, &text, &err))
        return false;
    if (orl_json_parse(path, text.data, text.size, &doc, &err) == 0)
        model = orl_hbjson_is_model(doc);
    json_decref(doc);
    here.close(here.ctx, &text);
    return model;
}

bool orl_is_project(const char *path)
{
    return orl_is_folder(path) || orl_name_has_ending(path, ".hbjson") || is_list(path) ||
           (orl_name_has_ending(path, "json") && holds_model(path));
}

/* ---- Models ---------------------------------------------------------------------------------- */

static int write_file(const char *project_folder, const struct orl_text_file *file,
                      struct orl_error *err)
{
    char path[PATH_SIZE], folder[PATH_SIZE];
    int rc = orl_join_path(project_folder, file->name, path, sizeof path, err);
    if (rc)
        return rc;
    snprintf(folder, sizeof folder, "%s", path);
    *strrchr(folder, '/') = '\0';
    rc = orl_make_folder(folder, err);
    if (rc)
        return rc;
    FILE *stream = orl_fopen_regular(path, 'w');
    if (stream && fwrite(file->text, 1, file->size, stream) == file->size && fclose(stream) == 0)
        return 0;
    return orl_error_set(err, orl_err_of_errno(errno), "cannot write '%s': %s", path,
                         orl_open_reason(errno));
}

/* Translates the model into the folder, and notes its units. */
static int translate_model(const char *path, struct orl_project_folder *project_folder,
                           struct orl_names *names, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_text_files files = {0};
    struct orl_file text;
    json_t *model = NULL;
    int rc = here.open(here.ctx, path, &text, err);
    if (rc)
        return rc;
    rc = orl_json_parse(path, text.data, text.size, &model, err);
    here.close(here.ctx, &text);
    if (rc == 0)
        rc = orl_hbjson_translate(model, &files, err);
    const char *units = json_string_value(json_object_get(model, "units"));
    snprintf(project_folder->units, sizeof project_folder->units, "%s", units ? units : "Meters");
    json_decref(model);
    if (rc)
        orl_error_at(err, path, 0, NULL);
    for (size_t i = 0; i < files.count && rc == 0; i++) {
        rc = write_file(project_folder->folder, &files.items[i], err);
        if (rc == 0)
            rc = orl_names_add(names, files.items[i].name, err);
    }
    orl_text_files_done(&files);
    return rc;
}

/* ---- Projects -------------------------------------------------------------------------------- */

/* Lays a folder out in place. A model folder is linked as "model", the name that its files use. */
static int lay_out_folder(const char *path, const char *project_folder, struct orl_names *names,
                          struct orl_error *err)
{
    char scene[PATH_SIZE], whole[PATH_MAX];
    int rc = orl_join_path(path, "scene", scene, sizeof scene, err);
    if (rc)
        return rc;
    if (!orl_is_folder(scene)) {
        rc = orl_temp_folder_link_entries(project_folder, path, err);
        return rc ? rc : orl_names_list(path, "", 0, names, err);
    }
    rc = realpath(path, whole) ? orl_temp_folder_link(project_folder, "model", whole, err)
                               : orl_error_set(err, ORL_ERR_NOT_FOUND, "cannot be read");
    return rc ? rc : orl_names_list(path, "model/", 0, names, err);
}

/* Writes the commands of a rad file, and windows with BSDFs, as scene files. */
static int write_commands(const struct orl_project_folder *project_folder, struct orl_error *err)
{
    const json_t *command;
    size_t i;
    int rc = 0;
    json_array_foreach(json_object_get(project_folder->project, "commands"), i, command)
    {
        const struct orl_text_file file = {
            (char *)(uintptr_t)json_string_value(json_object_get(command, "name")),
            (char *)(uintptr_t)json_string_value(json_object_get(command, "text")),
            json_string_length(json_object_get(command, "text"))};
        rc = rc ? rc : write_file(project_folder->folder, &file, err);
    }
    return rc;
}

/* Lays the file's project out. Its names are relative to the folder of the file. */
static int lay_out_list(const char *path, struct orl_project_folder *project_folder,
                        struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    const char *slash = strrchr(path, '/');
    char folder[PATH_SIZE];
    struct orl_file text;
    int rc = here.open(here.ctx, path, &text, err);
    if (rc)
        return rc;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) : 1, slash ? path : ".");
    rc = orl_name_has_ending(path, ".cfg")
             ? orl_frads_read(path, text.data, text.size, &project_folder->project, err)
             : orl_rif_read(path, text.data, text.size, &project_folder->project, err);
    here.close(here.ctx, &text);
    if (rc == 0)
        rc = write_commands(project_folder, err);
    return rc ? rc
              : orl_temp_folder_link_entries(project_folder->folder, slash == path ? "/" : folder,
                                             err);
}

static int find_project(const char *path, const json_t *scene, const struct orl_names *names,
                        struct orl_project_folder *project_folder, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(project_folder->folder);
    const struct orl_project_choice choice = {json_object_get(scene, "states"),
                                              json_string_value(json_object_get(scene, "sky"))};
    int rc = orl_project_find((const char *const *)names->items, names->count, &files, &choice,
                              &project_folder->project, err);
    if (rc == 0 && !project_folder->project) {
        rc = orl_error_set(err, ORL_ERR_NOT_FOUND,
                           "is not a project: it has no .rad file in a folder \"scene\"");
        orl_error_hint(err, "Name the scene's files instead, or the folder that Honeybee exported");
    }
    if (rc)
        orl_error_at(err, path, 0, NULL);
    return rc;
}

int orl_project_open(const json_t *scene, const char *path, const char *beside,
                     struct orl_project_folder *ret_project_folder, struct orl_error *err)
{
    struct orl_project_folder project_folder = {.project = NULL};
    struct orl_names names = {0};
    int rc = orl_temp_folder_make("project", project_folder.folder, err);
    if (rc == 0 && is_list(path))
        rc = lay_out_list(path, &project_folder, err);
    else if (rc == 0)
        rc = orl_is_folder(path) ? lay_out_folder(path, project_folder.folder, &names, err)
                                 : translate_model(path, &project_folder, &names, err);
    if (rc == 0 && beside)
        rc = orl_temp_folder_link_entries(project_folder.folder, beside, err);
    if (rc == 0 && !project_folder.project)
        rc = find_project(path, scene, &names, &project_folder, err);
    orl_names_done(&names);
    if (rc) {
        orl_project_done(&project_folder);
        return rc;
    }
    *ret_project_folder = project_folder;
    return 0;
}

int orl_project_write(const json_t *scene, const char *path, const char *into,
                      struct orl_project_folder *ret_project_folder, struct orl_error *err)
{
    struct orl_project_folder project_folder = {.is_permanent = true};
    struct orl_names names = {0};
    int rc = 0;
    snprintf(project_folder.folder, sizeof project_folder.folder, "%s", into);
    if (orl_is_folder(path) || is_list(path)) {
        rc =
            orl_error_set(err, ORL_ERR_INVALID, "is not a model: its Radiance files exist already");
        orl_error_at(err, path, 0, NULL);
    }
    if (rc == 0)
        rc = orl_make_folder(into, err);
    if (rc == 0)
        rc = translate_model(path, &project_folder, &names, err);
    if (rc == 0)
        rc = find_project(path, scene, &names, &project_folder, err);
    orl_names_done(&names);
    if (rc) {
        orl_project_done(&project_folder);
        return rc;
    }
    *ret_project_folder = project_folder;
    return 0;
}

void orl_project_done(struct orl_project_folder *project_folder)
{
    if (project_folder->folder[0] && !project_folder->is_permanent)
        orl_remove_folder(project_folder->folder);
    json_decref(project_folder->project);
    *project_folder = (struct orl_project_folder){.project = NULL};
}

/* ---- Documents ------------------------------------------------------------------------------- */

/* Returns the text of a view's options, owned by the caller; NULL if it cannot be read, which the
 * run reports. */
static char *options_of(const struct orl_project_folder *project_folder, const json_t *view)
{
    const struct orl_files files = orl_files_from_folder(project_folder->folder);
    const char *name = json_string_value(json_object_get(view, "file"));
    const char *own = json_string_value(json_object_get(view, "view"));
    struct orl_file file;
    char *text = NULL;
    if (!name)
        return own ? strdup(own) : NULL;
    if (files.open(files.ctx, name, &file, NULL))
        return NULL;
    if (orl_view_file_read(name, file.data, file.size, NULL, &text, NULL))
        text = NULL;
    files.close(files.ctx, &file);
    return text;
}

/* Asks for the DGP of a fisheye view, from which it can be computed. */
static int add_metrics(const struct orl_project_folder *project_folder, json_t *view)
{
    char *options = options_of(project_folder, view);
    const bool is_fisheye = options && orl_view_text_is_fisheye(options);
    free(options);
    return is_fisheye ? json_object_set_new(view, "metrics", json_pack("[s]", "dgp")) : 0;
}

/* Sets square pixels, or the project's aspect; any aspect if the project gives an exact size. */
static void set_pixel_aspect(json_t *view)
{
    const json_t *const own = json_object_get(view, "pixel_aspect");
    if (!own)
        json_object_set_new(view, "pixel_aspect", json_integer(1));
    else if (json_number_value(own) == 0)
        json_object_del(view, "pixel_aspect");
}

/* Returns the views with their sizes; NULL when out of memory. */
static json_t *views_of(const struct orl_project_folder *project_folder)
{
    json_t *views = json_array(), *view;
    size_t i;
    int rc = 0;
    json_array_foreach(json_object_get(project_folder->project, "views"), i, view)
    {
        json_t *own = json_copy(view);
        if (!json_object_get(own, "width")) { /* has no size of its own */
            rc |= json_object_set_new(own, "width", json_integer(VIEW_SIDE));
            rc |= json_object_set_new(own, "height", json_integer(VIEW_SIDE));
        }
        set_pixel_aspect(own);
        rc |= add_metrics(project_folder, own);
        rc |= json_array_append_new(views, own);
    }
    return orl_json_checked(views, rc);
}

/* Labels the maps' scale bars, unless lengths are in metres. */
static int set_length_unit(const struct orl_project_folder *project_folder, json_t *doc)
{
    static const char *const labels[][2] = {
        {"Millimeters", "mm"}, {"Centimeters", "cm"}, {"Inches", "in"}, {"Feet", "ft"}};
    for (size_t i = 0; i < sizeof labels / sizeof *labels; i++)
        if (strcmp(project_folder->units, labels[i][0]) == 0)
            return json_object_set_new(
                doc, "heat_map",
                json_pack("{s:s, s:[i]}", "length_unit", labels[i][1], "thresholds", 300));
    return 0;
}

/* Chooses final gather where a view's DGP is added. The planner would take path tracing, which has
 * no bias but is six times slower for a smooth picture; the DGP of both agrees (.534 in the
 * classroom).
 */
static int choose_technique(json_t *doc)
{
    const json_t *view;
    size_t i;
    if (json_object_get(doc, "technique") || json_object_get(doc, "accuracy"))
        return 0;
    json_array_foreach(json_object_get(doc, "views"), i, view)
    {
        if (json_object_get(view, "metrics"))
            return json_object_set_new(doc, "technique", json_string("gather"));
    }
    return 0;
}

int orl_project_fill_document(const struct orl_project_folder *project_folder, const json_t *scene,
                              json_t *doc, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    const json_t *grids = json_object_get(project_folder->project, "grids");
    const bool renders = !kind || strcmp(kind, "render") == 0;
    json_t *files = json_copy(json_object_get(project_folder->project, "files")),
           *more = json_object_get(scene, "files");
    int rc = more ? json_array_extend(files, more) : 0;
    rc |= json_object_set_new(doc, "scene", json_pack("{s:o}", "files", files));
    if (rc == 0 && !json_object_get(doc, "sensors") && !json_object_get(doc, "grids") &&
        json_array_size(grids) > 0)
        rc = json_object_set(doc, "grids", (json_t *)(uintptr_t)grids);
    if (rc == 0 && renders && !json_object_get(doc, "views"))
        rc = json_object_set_new(doc, "views", views_of(project_folder)) || choose_technique(doc);
    if (rc == 0 && renders && json_object_get(doc, "grids") && !json_object_get(doc, "skies") &&
        !json_object_get(doc, "heat_map"))
        rc = set_length_unit(project_folder, doc);
    if (rc)
        return orl_error_no_memory(err);
    if (!kind || strcmp(kind, "annual") != 0)
        return 0;
    return orl_project_fill_shades(json_object_get(project_folder->project, "states"),
                                   json_object_get(scene, "states"), doc, err);
}

static void print_names(const char *what, const json_t *list)
{
    const json_t *item;
    size_t i;
    if (json_array_size(list) > 0)
        fprintf(stderr, "%s:", what);
    json_array_foreach(list, i, item)
    {
        const char *name = json_string_value(item);
        fprintf(stderr, " %s", name ? name : json_string_value(json_object_get(item, "name")));
    }
    if (json_array_size(list) > 0)
        fputc('\n', stderr);
}

void orl_project_list(const json_t *project)
{
    const json_t *name, *left;
    json_t *state;
    const char *group;
    size_t i;
    fprintf(stderr, "project: %zu scene files\n",
            json_array_size(json_object_get(project, "files")));
    print_names("grids", json_object_get(project, "grids"));
    print_names("views", json_object_get(project, "views"));
    print_names("skies", json_object_get(project, "skies"));
    json_object_foreach((json_t *)(uintptr_t)json_object_get(project, "states"), group, state)
    {
        fprintf(stderr, "group %s: %s of", group,
                json_string_value(json_object_get(state, "chosen")));
        json_array_foreach(json_object_get(state, "of"), i, name)
        {
            fprintf(stderr, " %s", json_string_value(name));
        }
        fputc('\n', stderr);
    }
    json_array_foreach(json_object_get(project, "warnings"), i, name)
    {
        fprintf(stderr, "warning: %s\n", json_string_value(name));
    }
    json_array_foreach(json_object_get(project, "left_out"), i, left)
    {
        fprintf(stderr, "left out: %s (%s)\n", json_string_value(json_object_get(left, "file")),
                json_string_value(json_object_get(left, "why")));
    }
}
