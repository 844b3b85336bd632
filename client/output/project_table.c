#include "output/project_table.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/job/run.h>

#include "http/json_get.h"
#include "output/style.h"
#include "output/terminal.h"

enum { NAME_WIDTH = 32, HEAD_WIDTH = 10 };

static void print_heading(FILE *to, const char *left, const char *right)
{
    fprintf(to, "\n%s%-*s %s%s\n", orl_style_begin(to, ORL_STYLE_HEADING), NAME_WIDTH, left, right,
            orl_style_end(to));
}

/* ---- Grids ----------------------------------------------------------------------------------- */

/* Opens a file of the project; returns false if it cannot be read. */
static bool open_file(const struct orl_project_folder *project_folder, const char *name,
                      struct orl_files *ret_files, struct orl_file *ret_file)
{
    *ret_files = orl_files_from_folder(project_folder->folder);
    return name && ret_files->open(ret_files->ctx, name, ret_file, NULL) == 0;
}

/* Formats the number of a grid's sensors, or why it is not known. */
static void format_sensors(const struct orl_project_folder *project_folder, const json_t *grid,
                           char *ret_text, size_t size)
{
    const char *name = orl_get_text(json_object_get(grid, "sensors"), "file");
    struct orl_error why = {0};
    struct orl_files files;
    struct orl_file file;
    size_t count;
    if (!open_file(project_folder, name, &files, &file)) {
        snprintf(ret_text, size, "file is missing");
        return;
    }
    if (orl_sensors_check(name, file.data, file.size, &count, &why) == 0)
        snprintf(ret_text, size, "%zu", count);
    else
        snprintf(ret_text, size, "line %d: %s", why.line, why.message);
    files.close(files.ctx, &file);
}

static void print_grids(FILE *to, const struct orl_project_folder *project_folder)
{
    const json_t *grids = json_object_get(project_folder->project, "grids"), *grid;
    size_t i;
    if (json_array_size(grids) == 0)
        return;
    print_heading(to, "grid", "sensors");
    json_array_foreach(grids, i, grid)
    {
        char sensors[600];
        format_sensors(project_folder, grid, sensors, sizeof sensors);
        fprintf(to, "%-*s %7s\n", NAME_WIDTH, orl_get_text(grid, "name"), sensors);
    }
}

/* ---- Views ----------------------------------------------------------------------------------- */

/* Returns the name of a view's type, by the letter behind "-vt" (rpict(1)). */
static const char *type_name(const char *options)
{
    static const struct {
        char letter;
        const char *name;
    } types[] = {{'v', "perspective"}, {'l', "parallel"},    {'a', "angular fisheye"},
                 {'h', "fisheye"},     {'s', "planisphere"}, {'c', "cylindrical panorama"}};
    const char *at = strstr(options, "-vt");
    for (size_t i = 0; at && i < sizeof types / sizeof *types; i++)
        if (at[3] == types[i].letter)
            return types[i].name;
    return types[0].name;
}

static void print_view(FILE *to, const struct orl_project_folder *project_folder,
                       const json_t *view)
{
    const char *name = json_string_value(json_object_get(view, "file"));
    const char *own = json_string_value(json_object_get(view, "view"));
    const char *type = own ? type_name(own) : "not known: the file is missing or has no view";
    const bool is_own_fisheye = own && orl_view_text_is_fisheye(own);
    bool is_fisheye = is_own_fisheye;
    struct orl_files files;
    struct orl_file file;
    char *text = NULL;
    if (name && open_file(project_folder, name, &files, &file)) {
        if (orl_view_file_read(name, file.data, file.size, NULL, &text, NULL) == 0) {
            type = type_name(text);
            is_fisheye = orl_view_text_is_fisheye(text);
            free(text);
        }
        files.close(files.ctx, &file);
    }
    fprintf(to, "%-*s %s%s\n", NAME_WIDTH, orl_get_text(view, "name"), type,
            is_fisheye ? " (with DGP)" : "");
}

static void print_views(FILE *to, const struct orl_project_folder *project_folder)
{
    const json_t *views = json_object_get(project_folder->project, "views"), *view;
    size_t i;
    if (json_array_size(views) == 0)
        return;
    print_heading(to, "view", "type");
    json_array_foreach(views, i, view)
    {
        print_view(to, project_folder, view);
    }
}

/* ---- States ---------------------------------------------------------------------------------- */

static void print_states(FILE *to, const json_t *project)
{
    json_t *states = json_object_get(project, "states"), *group;
    const json_t *state;
    const char *name;
    size_t i;
    if (json_object_size(states) == 0)
        return;
    print_heading(to, "window group", "states (* is used)");
    json_object_foreach(states, name, group)
    {
        fprintf(to, "%-*s", NAME_WIDTH, name);
        json_array_foreach(json_object_get(group, "of"), i, state)
        {
            const char *text = json_string_value(state);
            fprintf(to, "%s %s%s", i > 0 ? "," : "", text,
                    strcmp(text, orl_get_text(group, "chosen")) == 0 ? "*" : "");
        }
        fputc('\n', to);
    }
}

/* ---- Lists ----------------------------------------------------------------------------------- */

static void print_skies(FILE *to, const json_t *project)
{
    const json_t *skies = json_object_get(project, "skies"), *sky;
    size_t i;
    fprintf(to, "%-*s", HEAD_WIDTH, "skies");
    json_array_foreach(skies, i, sky)
    {
        fprintf(to, "%s%s", i > 0 ? ", " : "", json_string_value(sky));
    }
    fprintf(to, "%s\n",
            json_array_size(skies) > 0 ? "" : "none: give --sky, or --weather for a year");
}

static void print_left_out(FILE *to, const json_t *project)
{
    const json_t *left_out = json_object_get(project, "left_out"), *one;
    size_t i;
    if (json_array_size(left_out) == 0)
        return;
    print_heading(to, "file left out", "reason");
    json_array_foreach(left_out, i, one)
    {
        fprintf(to, "%-*s %s\n", NAME_WIDTH, orl_get_text(one, "file"), orl_get_text(one, "why"));
    }
}

static void print_warnings(FILE *to, const json_t *project)
{
    const json_t *warning;
    size_t i;
    json_array_foreach(json_object_get(project, "warnings"), i, warning)
    {
        fprintf(to, "%s%swarning:%s %s\n", i == 0 ? "\n" : "",
                orl_style_begin(to, ORL_STYLE_WARNING), orl_style_end(to),
                json_string_value(warning));
    }
}

static void print_missing(FILE *to, const json_t *missing)
{
    const json_t *name;
    size_t i;
    if (json_array_size(missing) == 0)
        return;
    print_heading(to, "missing file", "");
    json_array_foreach(missing, i, name)
    {
        fprintf(to, "%s%s%s\n", orl_style_begin(to, ORL_STYLE_BAD), json_string_value(name),
                orl_style_end(to));
    }
}

void orl_print_project(FILE *to, const char *path, const struct orl_project_folder *project_folder,
                       const json_t *missing)
{
    const json_t *project = project_folder->project;
    const size_t n_files = json_array_size(json_object_get(project, "files"));
    fprintf(to, "%-*s%s\n", HEAD_WIDTH, "project", path);
    fprintf(to, "%-*s%s\n", HEAD_WIDTH, "units",
            project_folder->units[0] ? project_folder->units
                                     : "those of its files, which name none");
    fprintf(to, "%-*s%zu file%s\n", HEAD_WIDTH, "scene", n_files, n_files == 1 ? "" : "s");
    print_skies(to, project);
    print_grids(to, project_folder);
    print_views(to, project_folder);
    if (json_array_size(json_object_get(project, "grids")) == 0 &&
        json_array_size(json_object_get(project, "views")) == 0)
        fputs("\nThe project has no sensor grids and no views.\n", to);
    print_states(to, project);
    print_left_out(to, project);
    print_warnings(to, project);
    print_missing(to, missing);
}
