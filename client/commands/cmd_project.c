/* oriel project MODEL.hbjson|FOLDER: lists a project's contents, and writes a model's files. */
#include "options/command.h"

#include <stdio.h>

#include "distributed/atomic_files.h"
#include "input/job_file.h"
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

int orl_cmd_project(const struct orl_subcommand *self, int argc, char **argv)
{
    const char *output = NULL;
    struct orl_project_line line = {0};
    const struct orl_option options[] = {
        {"output", 'o', "DIR", "folder for a model's Radiance files", &output, NULL},
        ORL_OPTIONS_PROJECT(&line),
    };
    struct orl_operands operands;
    struct orl_project_folder project_folder = {0};
    struct orl_error err = {0};
    json_t *scene = NULL;
    int rc, code;
    if (!orl_options_parse(self, argc, argv, options, 3, 1, 1, &operands, &code))
        return code;
    rc = orl_project_scene_to_json(operands.items[0], &line, &scene, &err);
    if (rc == 0 && output)
        rc = orl_project_write(scene, operands.items[0], output, &project_folder, &err);
    else if (rc == 0)
        rc = orl_project_open(scene, operands.items[0], NULL, &project_folder, &err);
    if (rc == 0 && output)
        rc = write_job(&project_folder, &err);
    if (rc == 0) {
        json_dumpf(project_folder.project, stdout, JSON_INDENT(2));
        putchar('\n');
    }
    orl_project_done(&project_folder);
    json_decref(scene);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
