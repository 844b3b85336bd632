/* oriel project MODEL.hbjson|FOLDER: lists a project's contents and its missing files, and writes a
 * model's files. The exit code is 1 if files are missing or the scene cannot be read. */
#include "options/command.h"

#include <stdio.h>

#include "distributed/atomic_files.h"
#include "input/job_file.h"
#include "input/missing_files.h"
#include "output/project_table.h"
#include "output/reports.h"

/* Writes a job document that renders the whole project. */
static int write_job(const struct orl_project_folder *project_folder, struct orl_error *err)
{
    json_t *doc = json_pack("{s:s}", "kind", "render");
    char path[4096];
    int rc =
        doc ? orl_project_fill_document(project_folder, NULL, doc, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = orl_join_path(project_folder->folder, "job.json", path, sizeof path, err);
    if (rc == 0)
        rc = orl_write_json(path, doc, err);
    json_decref(doc);
    return rc;
}

/* Opens the project, or writes it to a folder. */
static int open_project(const char *path, const struct orl_project_line *line, const char *output,
                        struct orl_project_folder *ret_project_folder, struct orl_error *err)
{
    json_t *scene = NULL;
    int rc = orl_project_scene_to_json(path, line, &scene, err);
    if (rc == 0 && output)
        rc = orl_project_write(scene, path, output, ret_project_folder, err);
    else if (rc == 0)
        rc = orl_project_open(scene, path, NULL, ret_project_folder, err);
    if (rc == 0 && output)
        rc = write_job(ret_project_folder, err);
    json_decref(scene);
    return rc;
}

/* Prints the project as JSON, with "missing" if files are missing. */
static int print_json(const struct orl_project_folder *project_folder, json_t *missing,
                      struct orl_error *err)
{
    json_t *project = project_folder->project;
    if (json_array_size(missing) > 0 && json_object_set(project, "missing", missing) != 0)
        return orl_error_no_memory(err);
    return orl_print_json(json_incref(project), 0, err);
}

int orl_cmd_project(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *output = NULL;
    bool as_json = false;
    struct orl_project_line line = {0};
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for a model's Radiance files", &output, NULL},
        {"json", 0, NULL, "print JSON, for programs", NULL, &as_json},
        ORL_OPTIONS_PROJECT(&line),
    };
    struct orl_operands operands;
    struct orl_project_folder project_folder = {.project = NULL};
    struct orl_error err = {0}, unreadable = {0};
    json_t *missing = NULL;
    int code;
    if (!orl_options_parse(self, argc, argv, options, 4, 1, 1, &operands, &code))
        return code;
    int rc = open_project(operands.items[0], &line, output, &project_folder, &err);
    if (rc == 0)
        rc = orl_find_missing_files(&project_folder, &missing, &unreadable, &err);
    if (rc == 0 && as_json)
        rc = print_json(&project_folder, missing, &err);
    else if (rc == 0)
        orl_print_project(stdout, operands.items[0], &project_folder, missing);
    if (unreadable.code)
        orl_report_error(&unreadable);
    const bool is_sound = unreadable.code == 0 && json_array_size(missing) == 0;
    json_decref(missing);
    orl_project_done(&project_folder);
    if (rc)
        return orl_report_error(&err);
    return is_sound ? ORL_EXIT_OK : ORL_EXIT_FAILED;
}
