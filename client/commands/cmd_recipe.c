/*
 * oriel recipe NAME [MODEL] -o DIR: runs a recipe of Ladybug Tools (api/recipe/recipe.h). Its
 * inputs are options of the same names, or members of the file that --inputs names. DIR gets the
 * recipe's results, and DIR/oriel the files of the jobs that they come from.
 */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/base/suggest.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/input_folders.h"
#include "input/job_file.h"
#include "output/reports.h"
#include "recipe/recipe.h"
#include "result/result_json.h"
#include "json/decode.h"

enum { PATH_SIZE = 4096 };
#define OWN_FOLDER "oriel"

/* A recipe while it runs. */
struct recipe_command {
    const struct orl_recipe *recipe;
    json_t *given, *inputs, *notes; /* inputs as given, and as checked */
    struct orl_recipe_run *run;
    const char *output;
    uint32_t threads;
    /* The job under way. */
    size_t job;
    struct orl_annual_job *year;
    char job_folder[PATH_SIZE];
};

/* ---- Inputs ---------------------------------------------------------------------------------- */

/* Adds the members of an inputs file. Its files are relative to its folder. */
static int read_inputs_file(struct recipe_command *command, const char *path, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    const char *slash = strrchr(path, '/');
    char folder[PATH_SIZE], joined[PATH_SIZE];
    struct orl_file text;
    json_t *doc = NULL;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1,
             slash ? path : ".");
    int rc = here.open(here.ctx, path, &text, err);
    if (rc)
        return rc;
    rc = orl_json_parse(path, text.data, text.size, &doc, err);
    here.close(here.ctx, &text);
    for (size_t i = 0; rc == 0 && i < ORL_RECIPE_MOST_INPUTS && command->recipe->inputs[i].name;
         i++) {
        const struct orl_recipe_input *input = &command->recipe->inputs[i];
        const char *name = json_string_value(json_object_get(doc, input->name));
        if (input->type != ORL_INPUT_FILE || !name)
            continue;
        rc = orl_join_path(folder, name, joined, sizeof joined, err);
        if (rc == 0 && json_object_set_new(doc, input->name, json_string(joined)))
            rc = orl_error_no_memory(err);
    }
    if (rc == 0 && !json_is_object(doc)) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "the file must be a JSON object of inputs");
        orl_error_at(err, path, 0, NULL);
    } else if (rc == 0 && json_object_update_missing(command->given, doc)) {
        rc = orl_error_no_memory(err);
    }
    json_decref(doc);
    return rc;
}

/* Reads a whole file into text, owned; none if path is NULL. */
static int read_text(const char *path, char **ret_text, size_t *ret_size, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_file file;
    if (!path)
        return 0;
    const int rc = here.open(here.ctx, path, &file, err);
    if (rc)
        return rc;
    *ret_text = strndup(file.data, file.size);
    *ret_size = strlen(*ret_text ? *ret_text : "");
    here.close(here.ctx, &file);
    return *ret_text ? 0 : orl_error_no_memory(err);
}

/* Reads the model, unless it is a folder. */
static int read_model(const char *path, json_t **ret_model, struct orl_error *err)
{
    char *text = NULL;
    size_t size = 0;
    if (orl_is_folder(path))
        return 0;
    if (orl_name_has_ending(path, ".zip") || orl_name_has_ending(path, ".pkl") ||
        orl_name_has_ending(path, ".hbpkl")) {
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "'%.200s' is no HBJSON", path);
        orl_error_hint(err, "save the model as HBJSON, or unpack the zip and give its folder");
        return ORL_ERR_UNSUPPORTED;
    }
    int rc = read_text(path, &text, &size, err);
    if (rc == 0)
        rc = orl_json_parse(path, text, size, ret_model, err);
    free(text);
    const char *type = json_string_value(json_object_get(*ret_model, "type"));
    if (rc || (type && strcmp(type, "Model") == 0))
        return rc;
    orl_error_set(err, ORL_ERR_INVALID, "the file is no Honeybee model: its type is not \"Model\"");
    orl_error_at(err, path, 0, NULL);
    return ORL_ERR_INVALID;
}

static int make_run(struct recipe_command *command, struct orl_error *err)
{
    char *weather = NULL, *schedule = NULL;
    struct orl_recipe_texts texts = {.model = NULL};
    json_t *model = NULL;
    int rc = orl_recipe_check_inputs(command->recipe, command->given, &command->inputs,
                                     &command->notes, err);
    if (rc == 0)
        rc = read_model(orl_recipe_text(command->inputs, "model"), &model, err);
    if (rc == 0)
        rc = read_text(orl_recipe_weather(command->inputs), &weather, &texts.weather_size, err);
    if (rc == 0)
        rc = read_text(orl_recipe_text(command->inputs, "schedule"), &schedule,
                       &texts.schedule_size, err);
    texts.model = model;
    texts.weather = weather;
    texts.schedule = schedule;
    if (rc == 0)
        rc = orl_recipe_run_new(command->recipe, command->inputs, &texts, command->output,
                                &command->run, err);
    json_decref(model);
    free(weather);
    free(schedule);
    return rc;
}

static void print_notes(const json_t *notes)
{
    const json_t *note;
    size_t i;
    json_array_foreach(notes, i, note)
    {
        fprintf(stderr, "note: %s\n", json_string_value(note));
    }
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

/* Puts the weather file, and the texts that the recipe made, beside the scene. */
static int add_files(const struct recipe_command *command, const struct orl_job_file *file,
                     struct orl_error *err)
{
    const char *weather = orl_recipe_weather(command->inputs), *name;
    char path[PATH_SIZE];
    json_t *text;
    int rc = weather ? orl_job_file_link(file, weather, err) : 0;
    json_object_foreach((json_t *)(uintptr_t)orl_recipe_job_files(command->run), name, text)
    {
        rc = rc ? rc : orl_join_path(file->folder, name, path, sizeof path, err);
        rc = rc ? rc : orl_write_text(path, json_string_value(text), json_string_length(text), err);
    }
    return rc;
}

static int write_result(const struct recipe_command *command, const json_t *document,
                        struct orl_error *err)
{
    char path[PATH_SIZE];
    const int rc = orl_join_path(command->job_folder, "result.json", path, sizeof path, err);
    return rc ? rc : orl_write_json(path, document, err);
}

static int run_render(struct recipe_command *command, const struct orl_job_file *file,
                      struct orl_error *err)
{
    struct orl_job job = {0};
    struct orl_result result = {0};
    int rc = orl_job_file_decode(file, &job, err);
    if (rc == 0)
        rc = orl_local_run(&job, file->folder, command->job_folder, command->threads, NULL, &result,
                           err);
    if (rc == 0) {
        json_t *document = orl_result_to_json(&result, "succeeded");
        rc = write_result(command, document, err);
        json_decref(document);
    }
    if (rc == 0)
        rc = orl_recipe_take_result(command->run, command->job, &job, &result, command->job_folder,
                                    err);
    orl_result_done(&result);
    orl_job_done(&job);
    return rc;
}

static int on_year(void *ctx, const struct orl_annual_result *result,
                   const struct orl_annual_report *report, json_t *document, struct orl_error *err)
{
    struct recipe_command *command = ctx;
    const int rc = write_result(command, document, err);
    return rc ? rc
              : orl_recipe_take_year(command->run, command->job, command->year, result, report,
                                     orl_local_interrupted(), err);
}

static int run_year(struct recipe_command *command, const struct orl_job_file *file,
                    struct orl_error *err)
{
    const struct orl_local_callback callback = {on_year, command};
    struct orl_annual_job job = {0};
    int rc = orl_annual_job_from_json(file->doc, ORL_JOB_LOCAL, &job, NULL, err);
    command->year = &job;
    if (rc == 0)
        rc = orl_local_annual(&job, file->folder, command->job_folder, NULL, command->threads, NULL,
                              &callback, err);
    orl_annual_job_done(&job);
    command->year = NULL;
    return rc;
}

static int run_job(struct recipe_command *command, struct orl_error *err)
{
    json_t *document = orl_recipe_job_document(command->run, command->job);
    const char *kind = json_string_value(json_object_get(document, "kind"));
    struct orl_job_file file = {0};
    char name[32];
    snprintf(name, sizeof name, OWN_FOLDER);
    if (orl_recipe_job_count(command->run) > 1)
        snprintf(name, sizeof name, OWN_FOLDER "/%zu", command->job + 1);
    int rc = orl_join_path(command->output, name, command->job_folder, PATH_SIZE, err);
    if (rc == 0)
        rc = orl_make_folder(command->job_folder, err);
    if (rc == 0)
        rc = orl_job_file_make(document, orl_recipe_text(command->inputs, "model"), &file, err);
    if (rc == 0)
        rc = add_files(command, &file, err);
    if (rc == 0)
        rc = orl_recipe_filter(command->run, file.doc, err);
    if (rc == 0)
        rc = strcmp(kind, "annual") == 0 ? run_year(command, &file, err)
                                         : run_render(command, &file, err);
    orl_job_file_done(&file);
    return rc;
}

/* Removes the results of an earlier run of this command in the folder, and of no other program. */
static void remove_earlier(const char *output)
{
    static const char *const folders[] = {"results",      "metrics",        "en17037",
                                          "leed_summary", "breeam_summary", "well_summary",
                                          "simulation",   OWN_FOLDER};
    char path[PATH_SIZE];
    struct stat status;
    if (orl_join_path(output, OWN_FOLDER, path, sizeof path, NULL) || stat(path, &status) != 0)
        return;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        if (orl_join_path(output, folders[i], path, sizeof path, NULL) == 0)
            orl_remove_folder(path);
}

static int run_recipe(struct recipe_command *command, struct orl_error *err)
{
    int rc = make_run(command, err);
    if (rc)
        return rc;
    print_notes(command->notes);
    remove_earlier(command->output);
    for (; rc == 0 && command->job < orl_recipe_job_count(command->run); command->job++)
        rc = run_job(command, err);
    if (rc == 0)
        printf("%s\n", command->output);
    return rc;
}

/* ---- The command line ------------------------------------------------------------------------ */

enum { OWN_OPTIONS = 3 };

/* Values of a recipe's inputs on the line. */
struct input_values {
    const char *texts[ORL_RECIPE_MOST_INPUTS], *file;
    char help[ORL_RECIPE_MOST_INPUTS][256];
};

/* Fills in an option for each input. Returns their number. */
static size_t fill_options(const struct orl_recipe *recipe, struct input_values *values,
                           struct orl_option *options)
{
    size_t n = 0;
    for (; n < ORL_RECIPE_MOST_INPUTS && recipe->inputs[n].name; n++) {
        const struct orl_recipe_input *input = &recipe->inputs[n];
        if (input->value)
            snprintf(values->help[n], sizeof values->help[n], "%s (default: %s)", input->help,
                     input->value);
        options[n] = (struct orl_option){.name = input->name,
                                         .metavar = input->type == ORL_INPUT_FILE ? "FILE"
                                                    : input->words                ? input->words
                                                                                  : "VALUE",
                                         .help = input->value ? values->help[n] : input->help,
                                         .value = &values->texts[n]};
    }
    return n;
}

/* Refuses an option that is no input, and names the nearest one. */
static int check_names(const struct orl_subcommand *self, int argc, char **argv,
                       const struct orl_option *options, size_t n)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        struct orl_suggestion nearest = {.word = NULL};
        char name[64];
        bool known = strncmp(argv[i], "--", 2) != 0 || strcmp(argv[i], "--help") == 0;
        snprintf(name, sizeof name, "%.*s", known ? 0 : (int)strcspn(argv[i] + 2, "="),
                 known ? "" : argv[i] + 2);
        nearest.word = name;
        for (size_t k = 0; k < n && !known; k++) {
            orl_suggestion_add(&nearest, options[k].name);
            known = strcmp(options[k].name, name) == 0;
        }
        if (!known)
            return orl_usage_error(self, "this recipe has no input \"%s\"%s%s%s", name,
                                   nearest.best ? "; did you mean --" : "",
                                   nearest.best ? nearest.best : "", nearest.best ? "?" : "");
    }
    return 0;
}

/* Collects the line's inputs. The first operand is the model. */
static int collect(struct recipe_command *command, const struct input_values *values,
                   const char *model, struct orl_error *err)
{
    int rc = model && json_object_set_new(command->given, "model", json_string(model))
                 ? ORL_ERR_INVALID
                 : 0;
    for (size_t i = 0; i < ORL_RECIPE_MOST_INPUTS && command->recipe->inputs[i].name; i++)
        if (values->texts[i] && json_object_set_new(command->given, command->recipe->inputs[i].name,
                                                    json_string(values->texts[i])))
            rc = ORL_ERR_INVALID;
    if (rc)
        return orl_error_set(err, ORL_ERR_INVALID, "an option's value is not UTF-8");
    return values->file ? read_inputs_file(command, values->file, err) : 0;
}

/* Runs a recipe with its own options; argv[0] is its name. */
static int run_line(const struct orl_recipe *recipe, const struct orl_subcommand *self, int argc,
                    char **argv)
{
    struct recipe_command command = {.recipe = recipe, .given = json_object()};
    const struct orl_subcommand own = {
        .name = self->name, .synopsis = self->synopsis, .summary = recipe->summary};
    struct orl_local_line line = {.writes = true, .may_be_bare = true};
    struct input_values values = {.file = NULL};
    struct orl_option options[ORL_RECIPE_MOST_INPUTS + OWN_OPTIONS];
    struct orl_error err = {0};
    int code;
    size_t n = fill_options(recipe, &values, options);
    options[n++] = (struct orl_option){.name = "inputs",
                                       .metavar = "FILE.json",
                                       .help = "file of inputs, as lbt-recipes writes it",
                                       .value = &values.file};
    options[n++] = (struct orl_option){.name = "output",
                                       .letter = 'o',
                                       .metavar = "DIR",
                                       .help = "folder for the results",
                                       .value = &line.output};
    options[n++] = (struct orl_option)ORL_OPTION_THREADS(&line.threads_text);
    if (check_names(&own, argc, argv, options, n)) {
        json_decref(command.given);
        return ORL_EXIT_USAGE;
    }
    if (!orl_local_parse(&own, argc, argv, options, n, &line, &code)) {
        json_decref(command.given);
        return code;
    }
    command.output = line.output;
    command.threads = line.threads;
    int rc = collect(&command, &values, line.operand, &err);
    if (rc == 0)
        rc = run_recipe(&command, &err);
    if (rc)
        orl_report_error(&err);
    orl_recipe_run_free(command.run);
    json_decref(command.given);
    json_decref(command.inputs);
    json_decref(command.notes);
    return rc ? ORL_EXIT_FAILED : ORL_EXIT_OK;
}

int orl_cmd_recipe(const struct orl_subcommand *self, int argc, char **argv)
{
    const struct orl_recipe *recipe = NULL;
    struct orl_operands operands;
    struct orl_error err = {0};
    int code;
    if (argc < 2 || argv[1][0] == '-') /* help, or a mistake */
        return orl_options_parse(self, argc, argv, NULL, 0, 1, 1, &operands, &code) ? ORL_EXIT_USAGE
                                                                                    : code;
    if (orl_recipe_find(argv[1], &recipe, &err)) {
        orl_report_error(&err);
        return ORL_EXIT_USAGE;
    }
    return run_line(recipe, self, argc - 1, argv + 1);
}
