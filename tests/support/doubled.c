#include "support/doubled.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/base/files.h>
#include <oriel/bsdf/bsdf.h>
#include <oriel/job/run.h>
#include <oriel/job/study.h>

#include "annual/matrices/imported_matrices.h"
#include "annual_job/annual_json.h"
#include "bsdf/fit/measurements/measurements.h"
#include "bsdf_json/bsdf_json.h"
#include "function/function.h"
#include "honeybee/hbjson.h"
#include "job/job_json.h"
#include "job/study_json.h"
#include "light/daylight/weather.h"
#include "run/request/job_inputs.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"
#include "support/zip.h"
#include "uploads/uploads.h"
#include "json/decode.h"

/* ---- Readers --------------------------------------------------------------------------------- */

static int read_scene(const struct doubled_input *input, struct orl_error *err)
{
    char panel[2048];
    static const char *const names[] = {"main.rad", "part.rad", "args.txt", "panel.xml"};
    scene_uniform_bsdf(0.1, panel);
    const struct orl_file contents[] = {
        {input->data, input->size, NULL},
        {"m sphere p 0 0 4 0 0 0 1\n", 25, NULL},
        {input->copies, input->copies_size, NULL},
        {panel, strlen(panel), NULL},
    };
    struct orl_memory_files memory = {names, contents, 4};
    const struct orl_files files = orl_files_from_memory(&memory);
    if (input->of->kind == DOUBLED_WORLD) {
        struct orl_scene_summary summary = {0};
        const int code = orl_scene_check(names, 1, &files, NULL, &summary, err);
        orl_scene_summary_done(&summary);
        return code;
    }
    struct orl_parsed_scene parsed_scene = {0};
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, err);
    orl_parsed_scene_done(&parsed_scene);
    return code;
}

static int read_mesh(const struct doubled_input *input, struct orl_error *err)
{
    static const char *const names[] = {"s.rad",  "m.obj",    "m.map", "m.stl",
                                        "m.gltf", "lamp.tab", "l.ies"};
    static const char scene[] = "void plastic m 0 0 5 .5 .5 .5 0 0\nvoid alias white m\n";
    static const char *const commands[] = {"!obj2rad m.obj\n", "!obj2rad -m m.map m.obj\n",
                                           "!xform -s 2 m.stl\n", "!xform -m m m.gltf\n",
                                           "!ies2rad l.ies\n"};
    static const char luminaire[] = "IESNA91\n[LAMP] the wanted lamp\nTILT=NONE\n"
                                    "1 1000 1 2 1 1 2 .3 .6 0\n1 1 40\n0 90\n0\n1 0\n";
    static const char object[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng g1\nf 1 2 3\n";
    const enum doubled_kind kind = input->of->kind;
    const struct orl_file whole = {input->data, input->size, NULL};
    const struct orl_file small = {object, sizeof object - 1, NULL};
    struct orl_parsed_scene parsed_scene = {0};
    char text[sizeof scene + 32];
    snprintf(text, sizeof text, "%s%s", scene, commands[kind - DOUBLED_OBJ]);
    const struct orl_file contents[] = {{text, strlen(text), NULL},
                                        kind == DOUBLED_OBJ ? whole : small,
                                        whole,
                                        whole,
                                        whole,
                                        whole,
                                        {luminaire, sizeof luminaire - 1, NULL}};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, err);
    orl_parsed_scene_done(&parsed_scene);
    return code;
}

static int read_bsdf(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    const int code = orl_bsdf_load_xml("file.xml", input->data, input->size, &bsdf, err);
    orl_bsdf_unref(bsdf);
    return code;
}

static int read_sensors(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_sensor *sensors = NULL;
    size_t count = 0;
    const int code =
        orl_sensors_parse("sensors.pts", input->data, input->size, &sensors, &count, err);
    free(sensors);
    return code;
}

static int read_views(const struct doubled_input *input, struct orl_error *err)
{
    char *view = NULL;
    const int code = orl_view_file_read("views.vf", input->data, input->size, "1", &view, err);
    free(view);
    return code;
}

static int read_weather(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_weather weather = {0};
    const int code = orl_weather_parse("place.wea", input->data, input->size, 0, &weather, err);
    orl_weather_done(&weather);
    return code;
}

static int read_job(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_job job;
    json_t *doc = NULL;
    int code = orl_json_parse("job.json", input->data, input->size, &doc, err);
    if (code < 0)
        return code;
    code = orl_job_from_json(doc, ORL_JOB_LOCAL, &job, NULL, err);
    json_decref(doc);
    if (code < 0)
        return code;
    code = orl_job_validate(&job, err);
    orl_job_done(&job);
    return code;
}

static int read_study(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_study_request request;
    json_t *doc = NULL;
    int code = orl_json_parse("study.json", input->data, input->size, &doc, err);
    if (code < 0)
        return code;
    code = orl_study_from_json(doc, ORL_JOB_LOCAL, &request, NULL, err);
    json_decref(doc);
    if (code < 0)
        return code;
    code = orl_study_request_validate(&request, err);
    orl_study_request_done(&request);
    return code;
}

static int read_year(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_annual_job job;
    json_t *doc = NULL;
    int code = orl_json_parse("year.json", input->data, input->size, &doc, err);
    if (code < 0)
        return code;
    code = orl_annual_job_from_json(doc, ORL_JOB_LOCAL, &job, NULL, err);
    json_decref(doc);
    if (code < 0)
        return code;
    code = orl_annual_validate(&job.request, err);
    orl_annual_job_done(&job);
    return code;
}

static int read_panel(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_bsdf_make_request request;
    json_t *doc = NULL;
    int code = orl_json_parse("make.json", input->data, input->size, &doc, err);
    if (code < 0)
        return code;
    code = orl_bsdf_make_from_json(doc, ORL_JOB_LOCAL, &request, NULL, err);
    json_decref(doc);
    if (code < 0)
        return code;
    code = orl_bsdf_make_validate(&request, err);
    orl_bsdf_make_request_done(&request);
    return code;
}

static int read_occupancy(const struct doubled_input *input, struct orl_error *err)
{
    static const struct orl_annual_steps minutes = {8760 * 60, 60};
    static unsigned char marks[8760 * 60];
    return orl_occupancy_read("use.csv", input->data, input->size, &minutes, marks, err);
}

static int read_schedule(const struct doubled_input *input, struct orl_error *err)
{
    static char name[] = "s.csv", group_name[] = "south", open[] = "open", shut[] = "shut";
    static const char *const names[] = {name};
    const struct orl_file contents[] = {{input->data, input->size, NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_shade_state states[2] = {{.name = open}, {.name = shut}};
    struct orl_window_group group = {
        .name = group_name, .states = states, .n_states = 2, .schedule_file = name};
    struct orl_annual_request request = {.groups = &group, .n_groups = 1};
    const int code = orl_annual_schedules_read(&request, &files, err);
    free(group.series);
    return code;
}

static int read_matrix(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_rgb_matrix matrix = {.rows = 0};
    const int code = orl_rgb_matrix_read("m.mtx", input->data, input->size, &matrix, err);
    orl_rgb_matrix_done(&matrix);
    return code;
}

/* Compiles and evaluates x. */
static int read_function(const struct doubled_input *input, struct orl_error *err)
{
    static const char *const inputs[] = {"s"};
    static const char *const expressions[] = {"x"};
    const struct orl_function_request request = {
        .expressions = expressions, .n_expressions = 1, .operations = UINT32_MAX};
    struct orl_functions *const set = orl_functions_new(inputs, 1);
    struct orl_function_scratch *const scratch = orl_function_scratch_new();
    struct orl_function *function = NULL;
    const double s = 1;
    double value;
    int code = set && scratch ? 0 : ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_functions_define(set, ORL_FUNCTION_GLOBAL, "some.cal", 1, input->data,
                                    input->size, err);
    if (code == 0)
        code = orl_function_compile(set, &request, &function, err);
    if (code == 0 && orl_function_at(function, scratch, &s, &value).exceeded)
        code = orl_error_set(err, ORL_ERR_LIMIT, "evaluation was given up");
    orl_function_free(function);
    orl_functions_free(set);
    orl_function_scratch_free(scratch);
    return code;
}

/* Unpacks into a temporary folder, which is removed at once. */
static int read_zip(const struct doubled_input *input, struct orl_error *err)
{
    const struct orl_file archive = {input->data, input->size, NULL};
    static struct orl_folders folders;
    struct orl_bundle bundle = {0};
    char tmp[ORL_PATH_MAX];
    snprintf(folders.root, sizeof folders.root, "/tmp/oriel-test-XXXXXX");
    if (!mkdtemp(folders.root))
        return orl_error_set(err, ORL_ERR_IO, "there is no temporary folder");
    orl_folders_path(&folders, tmp, "tmp");
    mkdir(tmp, 0700);
    const int code = orl_unzip(&archive, &folders, true, &bundle, err);
    orl_bundle_done(&bundle);
    orl_remove_tree(folders.root, NULL);
    return code;
}

static int read_model(const struct doubled_input *input, struct orl_error *err)
{
    struct orl_text_files files = {0};
    json_t *doc = NULL;
    int code = orl_json_parse("model.hbjson", input->data, input->size, &doc, err);
    if (code == 0)
        code = orl_hbjson_translate(doc, &files, err);
    json_decref(doc);
    orl_text_files_done(&files);
    return code;
}

/* ---- Inputs ---------------------------------------------------------------------------------- */

struct doubled_input doubled_make(const struct doubled *of, size_t n)
{
    struct doubled_input input = {.of = of};
    FILE *file = open_memstream(&input.data, &input.size);
    FILE *copies = open_memstream(&input.copies, &input.copies_size);
    if (!file || !copies)
        abort();
    of->write(file, n);
    for (size_t i = 0; i < n; i++)
        fprintf(copies, "-t 0 0 %zu\n", i);
    fclose(file);
    fclose(copies);
    return input;
}

void doubled_done(struct doubled_input *input)
{
    free(input->data);
    free(input->copies);
}

static int read_measured(const struct doubled_input *input, struct orl_error *err)
{
    const struct orl_fit_read_options reading = {0};
    struct orl_fit_data data = {0};
    const int code = orl_fit_read("data.txt", 0, input->data, input->size, &reading, &data, err);
    orl_fit_data_done(&data);
    return code;
}

int doubled_read(const struct doubled_input *input, char text[256])
{
    static int (*const readers[])(const struct doubled_input *, struct orl_error *) = {
        [DOUBLED_SCENE] = read_scene,       [DOUBLED_WORLD] = read_scene,
        [DOUBLED_BSDF] = read_bsdf,         [DOUBLED_SENSORS] = read_sensors,
        [DOUBLED_WEATHER] = read_weather,   [DOUBLED_JOB] = read_job,
        [DOUBLED_STUDY] = read_study,       [DOUBLED_ZIP] = read_zip,
        [DOUBLED_VIEWS] = read_views,       [DOUBLED_YEAR] = read_year,
        [DOUBLED_PANEL] = read_panel,       [DOUBLED_OCCUPANCY] = read_occupancy,
        [DOUBLED_FUNCTION] = read_function, [DOUBLED_MODEL] = read_model,
        [DOUBLED_SCHEDULE] = read_schedule, [DOUBLED_MEASURED] = read_measured,
        [DOUBLED_MATRIX] = read_matrix,     [DOUBLED_OBJ] = read_mesh,
        [DOUBLED_RULES] = read_mesh,        [DOUBLED_STL] = read_mesh,
        [DOUBLED_GLTF] = read_mesh,         [DOUBLED_LAMPS] = read_mesh,
    };
    struct orl_error err = {0};
    const int code = readers[input->of->kind](input, &err);
    snprintf(text, 256, "%.200s", err.message);
    return code;
}
