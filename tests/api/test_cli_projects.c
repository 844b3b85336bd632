/* `oriel run` with sensor grids and Honeybee projects, selected by name. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"

/* Two plates under a uniform sky. */
static const char scene_text[] = "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void glow sky_glow\n0\n0\n4 10 10 10 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0\n"
                                 "grey polygon roof\n0\n0\n12 0 0 3  0 4 3  3 4 3  3 0 3\n";

#define JOB(GRIDS)                                                                                 \
    "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]}, \"technique\": "               \
    "\"backward\",\n"                                                                              \
    " \"gather_samples\": 64, \"grids\": [" GRIDS "]}\n"

static int set_up(void **state)
{
    static const struct cli_file files[] = {
        {"job.json", JOB("{\"name\": \"desks\", \"sensors\": {\"file\": \"desks.pts\"}},"
                         "{\"name\": \"upper/rail\", \"sensors\": [[1, 1, 3.5, 0, 0, 1]]}")},
        {"room.rad", scene_text},
        {"desks.pts", "1.5 1 0.8 0 0 1\n1.5 3 0.8 0 0 1\n"},
        {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static json_t *load(const char *folder, const char *name)
{
    char *text = cli_read_file(folder, name);
    assert_non_null(text);
    json_t *json = json_loads(text, 0, NULL);
    assert_non_null(json);
    free(text);
    return json;
}

static void assert_grid(const json_t *grid, const char *name, int first, int count)
{
    assert_string_equal(json_string_value(json_object_get(grid, "name")), name);
    assert_int_equal(json_integer_value(json_object_get(grid, "first")), first);
    assert_int_equal(json_integer_value(json_object_get(grid, "count")), count);
}

static void test_grids_keep_their_names(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"run", f->document, "-o", f->output, "--threads", "1", NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    json_t *result = load(f->output, "result.json");
    const json_t *grids = json_object_get(result, "grids");
    const json_t *sensors = json_object_get(result, "sensors");
    assert_int_equal(json_array_size(grids), 2);
    assert_int_equal(json_array_size(sensors), 3);
    assert_grid(json_array_get(grids, 0), "desks", 0, 2);
    assert_grid(json_array_get(grids, 1), "upper/rail", 2, 1);
    char *res = cli_read_file(f->output, "results/desks.res"), wanted[64];
    snprintf(wanted, sizeof wanted, "%.6g\n%.6g\n",
             json_number_value(json_object_get(json_array_get(sensors, 0), "illuminance_lx")),
             json_number_value(json_object_get(json_array_get(sensors, 1), "illuminance_lx")));
    assert_string_equal(res, wanted);
    free(res);
    json_t *info = load(f->output, "results/grids_info.json");
    assert_string_equal(json_string_value(json_object_get(json_array_get(info, 1), "group")),
                        "upper");
    assert_string_equal(json_string_value(json_object_get(json_array_get(info, 1), "full_id")),
                        "upper/rail");
    free(cli_read_file(f->output, "results/upper/rail.npy"));
    json_decref(info);
    json_decref(result);
}

static void assert_refused(struct cli_desk *f, const char *job, const char *why)
{
    FILE *stream = fopen(f->document, "w");
    assert_non_null(stream);
    fputs(job, stream);
    assert_int_equal(fclose(stream), 0);
    const char *const args[] = {"run", f->document, "-o", f->output, "--threads", "1", NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    if (!strstr(f->result.err, why))
        fail_msg("\"%s\" is not in: %s", why, f->result.err);
}

static void test_names_that_are_none_are_refused(void **state)
{
    struct cli_desk *f = *state;
    assert_refused(f, JOB("{\"name\": \"../a\", \"sensors\": [[1, 1, 1, 0, 0, 1]]}"),
                   "needs a name");
    assert_refused(f, JOB("{\"name\": \"a/\", \"sensors\": [[1, 1, 1, 0, 0, 1]]}"), "needs a name");
    assert_refused(f,
                   JOB("{\"name\": \"a\", \"sensors\": [[1, 1, 1, 0, 0, 1]]},"
                       "{\"name\": \"a\", \"sensors\": [[1, 1, 2, 0, 0, 1]]}"),
                   "two grids are named 'a'");
    assert_refused(f, JOB("{\"name\": \"a\", \"sensors\": []}"), "there are no sensors");
    assert_refused(f, JOB("{\"sensors\": [[1, 1, 1, 0, 0, 1]]}"), "grids[0]");
}

/* ---- Projects -------------------------------------------------------------------------------- */

static const char model[] = "tests/fixtures/honeybee/two_rooms.hbjson";

/* Returns the scene's files by `oriel project`. */
static json_t *list_project(struct cli_desk *f, const char *path, const char *states)
{
    const char *const args[] = {"project", path, "--json", "--states", states, NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    json_t *project = json_loads(f->result.out, 0, NULL);
    assert_non_null(project);
    return project;
}

static void test_a_model_is_listed_and_written(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"project", model, "--json", "-o", f->output, NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    json_t *whole = json_loads(f->result.out, 0, NULL);
    json_t *folder = list_project(f, f->output, "south_glass=0_south_glass");
    /* The written folder is read back, also under the folder's own name. */
    assert_true(json_equal(whole, folder));
    json_decref(folder);
    char own[128];
    snprintf(own, sizeof own, "%s/model", f->output);
    folder = list_project(f, own, "south_glass=0_south_glass");
    assert_true(json_equal(whole, folder));
    json_decref(folder);
    folder = list_project(f, own, "south_glass=1_south_glass");
    assert_false(json_equal(whole, folder));
    json_decref(folder);
    json_decref(whole);
}

/* Two grids with one identifier cause a warning on standard error, in the list, and in that of the
 * written folder. */
static void test_a_model_is_warned_of(void **state)
{
    static const char wanted[] = "2 sensor grids of the model have this identifier";
    struct cli_desk *f = *state;
    char path[128];
    json_t *doc = load(".", model);
    json_t *radiance = json_object_get(json_object_get(doc, "properties"), "radiance");
    json_t *grids = json_object_get(radiance, "sensor_grids");
    json_array_append(grids, json_array_get(grids, 0));
    char *text = json_dumps(doc, JSON_COMPACT);
    cli_write_file(f->folder, "two.hbjson", text);
    free(text);
    json_decref(doc);
    snprintf(path, sizeof path, "%s/two.hbjson", f->folder);
    const char *const list[] = {"project", path, "--json", "-o", f->output, NULL};
    cli_run(list, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_non_null(strstr(f->result.out, wanted));
    json_t *folder = list_project(f, f->output, "south_glass=0_south_glass");
    assert_int_equal(json_array_size(json_object_get(folder, "warnings")), 1);
    json_decref(folder);
    const char *const plan[] = {"plan", path, "--sky",
                                "{\"cie\": {\"type\": \"overcast\","
                                " \"diffuse_horizontal_lx\": 10000}}",
                                NULL};
    cli_run(plan, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_non_null(strstr(f->result.err, wanted));
}

/* A model is also recognised by its content, and a Dragonfly model is distinguished from it. */
static void test_models_are_known_by_what_they_say(void **state)
{
    struct cli_desk *f = *state;
    char path[512], *text = cli_read_file(".", model);
    assert_non_null(text);
    cli_write_file(f->folder, "model.json", text);
    free(text);
    snprintf(path, sizeof path, "%s/model.json", f->folder);
    const char *const run[] = {"run",     path,    "-o",
                               f->output, "--sky", "{\"cie\": {\"type\": \"overcast\"}, \"x\": 1}",
                               NULL};
    cli_run(run, &f->result);
    if (!strstr(f->result.err, "sky.x: there is no such member"))
        fail_msg("%s", f->result.err);
    cli_write_file(f->folder, "model.dfjson", "{\"type\": \"Model\", \"buildings\": []}");
    snprintf(path, sizeof path, "%s/model.dfjson", f->folder);
    cli_run(run, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    if (!strstr(f->result.err, "a Dragonfly model"))
        fail_msg("%s", f->result.err);
}

/* The weather file of a sky on the command line is relative to the working directory; it has no
 * rows of July. An unknown sky name of the project is refused with a remedy. */
static void test_skies_of_the_command_line(void **state)
{
    static const struct {
        const char *sky, *says;
    } cases[] = {
        {"{\"weather\": {\"file\": \"tests/fixtures/weather.epw\", \"month\": 7, \"day\": 1,"
         " \"hour\": 12}}",
         "the file has no row for month 7, day 1"},
        {"{\"weather\": {\"file\": \"none.epw\", \"month\": 7, \"day\": 1, \"hour\": 12}}",
         "cannot open 'none.epw'"},
        {"noon", "has no sky 'noon' (it has no skies. A sky can also be given as JSON: {\"cie\""}};
    struct cli_desk *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const run[] = {"run", model, "-o", f->output, "--sky", cases[i].sky, NULL};
        cli_run(run, &f->result);
        assert_int_equal(f->result.exit_code, 1);
        if (!strstr(f->result.err, cases[i].says))
            fail_msg("%s", f->result.err);
    }
}

/* Returns the sum of a grid's sensors of a run of the document. */
static double run_project(struct cli_desk *f, const char *states)
{
    char job[600], here[256];
    assert_non_null(getcwd(here, sizeof here));
    snprintf(job, sizeof job,
             "{\"kind\": \"render\", \"technique\": \"backward\", \"gather_samples\": 256,"
             " \"scene\": {\"project\": \"%s/%s\", \"states\": {%s}, \"files\": [\"sky.rad\"]},"
             " \"views\": []}",
             here, model, states);
    cli_write_file(f->folder, "job.json", job);
    cli_write_file(f->folder, "sky.rad",
                   "void glow sky_glow\n0\n0\n4 10 10 10 0\n"
                   "sky_glow source sky\n0\n0\n4 0 0 1 180\n");
    const char *const args[] = {"run", f->document, "-o", f->output, "--threads", "1", NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    char *text = cli_read_file(f->output, "results/desks.res"), *at = text;
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += strtod(at, &at);
    free(text);
    return sum;
}

static void test_states_let_in_more_or_less(void **state)
{
    struct cli_desk *f = *state;
    const double open = run_project(f, "");
    const double tinted = run_project(f, "\"south_glass\": \"1_south_glass\"");
    /* One of two windows has a transmittance of 0.27 instead of 0.64, and a louvre. */
    assert_true(open > 100 && tinted < 0.9 * open && tinted > 0.3 * open);
    json_t *info = load(f->output, "results/grids_info.json");
    assert_string_equal(json_string_value(json_object_get(json_array_get(info, 1), "full_id")),
                        "store/floor");
    json_decref(info);
}

static void test_a_model_without_grids_asks_for_nothing(void **state)
{
    struct cli_desk *f = *state;
    char path[512];
    json_t *whole = json_load_file(model, 0, NULL);
    json_t *own = json_object_get(json_object_get(whole, "properties"), "radiance");
    snprintf(path, sizeof path, "%s/bare.hbjson", f->folder);
    json_object_del(own, "sensor_grids");
    json_object_del(own, "views");
    assert_int_equal(json_dump_file(whole, path, 0), 0);
    json_decref(whole);
    const char *const args[] = {"run", path, "-o", f->output, NULL};
    cli_run(args, &f->result);
    assert_int_not_equal(f->result.exit_code, 0);
    assert_non_null(strstr(f->result.err, "no sensor grids and no views"));
}

/* ---- Annual runs ----------------------------------------------------------------------------- */

/*
 * Runs the model's year, two days of weather, with those shades and options; returns result.json.
 */
static json_t *run_year(struct cli_desk *f, const char *more, const char *chosen)
{
    char job[900], here[256];
    assert_non_null(getcwd(here, sizeof here));
    snprintf(job, sizeof job,
             "{\"kind\": \"annual\", \"weather\": \"place.epw\", \"samples\": 64, %s"
             " \"scene\": {\"project\": \"%s/%s\", \"states\": {%s}}}",
             more, here, model, chosen);
    cli_write_file(f->folder, "job.json", job);
    char *weather = cli_read_file("tests/fixtures", "weather.epw");
    assert_non_null(weather);
    cli_write_file(f->folder, "place.epw", weather);
    free(weather);
    const char *const args[] = {"annual", f->document, "-o", f->output, "--threads", "2", NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    return load(f->output, "result.json");
}

/* Returns the lit hours with the group in its second state. */
static double closed_hours(const json_t *result, const char *by)
{
    const json_t *groups = json_object_get(json_object_get(result, "shades"), "groups");
    const json_t *south = json_array_get(groups, 0);
    assert_string_equal(json_string_value(json_object_get(south, "name")), "south_glass");
    assert_string_equal(json_string_value(json_object_get(south, "by")), by);
    const json_t *second = json_array_get(json_object_get(south, "states"), 1);
    assert_string_equal(json_string_value(json_object_get(second, "name")), "1_south_glass");
    return json_number_value(json_object_get(second, "hours"));
}

/* Returns true if all figures of both grids agree, except those of direct light, which are for open
 * shades. */
static bool tell_the_same(const json_t *a, const json_t *b)
{
    for (size_t g = 0; g < 2; g++) {
        const json_t *of_a =
                         json_object_get(json_array_get(json_object_get(a, "grids"), g), "figures"),
                     *of_b =
                         json_object_get(json_array_get(json_object_get(b, "grids"), g), "figures"),
                     *figure;
        size_t i;
        assert_true(json_array_size(of_a) > 8);
        json_array_foreach(of_a, i, figure)
        {
            const char *name = json_string_value(json_object_get(figure, "name"));
            if (!strstr(name, "ASE") && !strstr(name, "direct") &&
                !json_equal(figure, json_array_get(of_b, i)))
                return false;
        }
    }
    return true;
}

static void test_states_are_the_shades_of_a_year(void **state)
{
    struct cli_desk *f = *state;
    json_t *open = run_year(f, "", "");
    assert_non_null(strstr(f->result.err, "group south_glass: in 0_south_glass all year"));
    assert_true(closed_hours(open, "none") == 0);
    json_t *closed = run_year(f,
                              "\"shades\": [{\"name\": \"south_glass\", \"rules\":"
                              " [{\"state\": \"1_south_glass\"}]}],",
                              "");
    assert_true(closed_hours(closed, "rules") > 0);
    /* Equal to a model without the other states: the same surfaces and paths. */
    json_t *fixed = run_year(f, "", "\"south_glass\": \"1_south_glass\"");
    assert_true(json_is_null(json_object_get(fixed, "shades")));
    assert_true(tell_the_same(closed, fixed));
    assert_false(tell_the_same(closed, open));
    json_decref(open);
    json_decref(closed);
    json_decref(fixed);
    json_t *drawn = run_year(f, "\"targets\": [\"sDA300/50 >= 55 %\"],", "");
    assert_non_null(strstr(f->result.err, "group south_glass: closed to 1_south_glass by LM-83"));
    closed_hours(drawn, "control");
    json_decref(drawn);
}

/* One command produces the client's page from a model and a weather file. */
static void test_a_year_without_a_document(void **state)
{
    struct cli_desk *f = *state;
    char path[512];
    const char *const bare[] = {"annual", model, "-o", f->output, NULL};
    cli_run(bare, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "--weather"));
    const char *const document[] = {"annual",  f->document, "-o", f->output,
                                    "--rules", "LEED",      NULL};
    cli_run(document, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "are only for projects"));
    const char *const year[] = {"annual",  model,       "-o",
                                f->output, "--weather", "tests/fixtures/weather.epw",
                                "--year",  "1999",      NULL};
    cli_run(year, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "the file has no rows for 1999"));
    const char *const args[] = {"annual",    model,
                                "-o",        f->output,
                                "--weather", "tests/fixtures/weather.epw",
                                "--rules",   "LEED, BREEAM offices",
                                NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    json_t *result = load(f->output, "result.json");
    assert_int_equal(json_array_size(json_object_get(result, "grids")), 2);
    assert_true(json_array_size(json_object_get(result, "rules")) >= 2);
    assert_true(closed_hours(result, "control") >= 0);
    json_decref(result);
    snprintf(path, sizeof path, "%s/desks.page.pdf", f->output);
    assert_int_equal(access(path, R_OK), 0);
}

/* Names in a document are relative to its folder, and may be above it. */
static void test_files_above_the_document(void **state)
{
    struct cli_desk *f = *state;
    char job[600], here[256], path[512];
    assert_non_null(getcwd(here, sizeof here));
    snprintf(path, sizeof path, "%s/jobs", f->folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(job, sizeof job,
             "{\"kind\": \"annual\", \"weather\": \"../place.epw\", \"year\": 1999,"
             " \"scene\": {\"project\": \"%s/%s\"}}",
             here, model);
    cli_write_file(f->folder, "jobs/job.json", job);
    char *weather = cli_read_file("tests/fixtures", "weather.epw");
    assert_non_null(weather);
    cli_write_file(f->folder, "place.epw", weather);
    free(weather);
    snprintf(path, sizeof path, "%s/jobs/job.json", f->folder);
    const char *const args[] = {"annual", path, "-o", f->output, NULL};
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    if (!strstr(f->result.err, "place.epw: the file has no rows for 1999"))
        fail_msg("%s", f->result.err);
}

/* Exported files beside the document that the user has changed are not overwritten. */
static void test_own_files_are_not_written_over(void **state)
{
    static const char mine[] = "# mine\n";
    struct cli_desk *f = *state;
    char path[512];
    snprintf(path, sizeof path, "%s/model", f->folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/model/scene", f->folder);
    assert_int_equal(mkdir(path, 0700), 0);
    cli_write_file(f->folder, "model/scene/envelope.rad", mine);
    json_decref(run_year(f, "", ""));
    char *after = cli_read_file(f->folder, "model/scene/envelope.rad");
    assert_string_equal(after, mine);
    free(after);
    snprintf(path, sizeof path, "%s/model/scene/envelope.mat", f->folder);
    assert_int_not_equal(access(path, F_OK), 0);
}

/* A model with an isotropic luminaire of 1000 cd that hangs 2 m above the first desk, by night. */
static void test_luminaires_of_a_model_shine(void **state)
{
    static const char luminaire[] =
        "{\"identifier\": \"ball\", \"light_loss_factor\": 0.5, \"ies_content\":"
        " \"IESNA:LM-63-2002\\nTILT=NONE\\n1 1000 2 2 1 1 2 0 0 0\\n1 1 40\\n0 180\\n0\\n1000 "
        "1000\\n\","
        " \"luminaire_zone\": {\"instances\": [{\"point\": {\"x\": 1, \"y\": 1, \"z\": 2.8}}]}}";
    struct cli_desk *f = *state;
    json_t *doc = load(".", model);
    json_t *radiance = json_object_get(json_object_get(doc, "properties"), "radiance");
    json_object_set_new(radiance, "luminaires", json_pack("[o]", json_loads(luminaire, 0, NULL)));
    json_array_clear(json_object_get(radiance, "views"));
    char *text = json_dumps(doc, 0), path[512];
    cli_write_file(f->folder, "lit.hbjson", text);
    free(text);
    json_decref(doc);
    snprintf(path, sizeof path, "%s/lit.hbjson", f->folder);
    const char *const args[] = {"run", path, "-o", f->output, "--threads", "1", NULL};
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    json_t *result = load(f->output, "result.json");
    const json_t *sensor = json_array_get(json_object_get(result, "sensors"), 0);
    const double lx = json_number_value(json_object_get(sensor, "illuminance_lx")),
                 error = json_number_value(json_object_get(sensor, "standard_error_lx"));
    json_decref(result);
    /* 1000 cd and half of 2: 250 lx direct; 788.5 +- 0.6 by rtrace -ab 24 -as 0 -ad 32768 -aa 0 -lw
     * 1e-8, six times. Its rays never hit so small a lamp in the window, which reflects it at 8^.5
     * m and 45 degrees with .056: 4.95 lx, and its interreflection, less than 2 lx. */
    assert_true(error < 0.03 * lx);
    const double mirrored = 1000 / 8. * sqrt(0.5) * 0.056;
    assert_true(lx - 788.5 - mirrored > -4 * (error + 0.6));
    assert_true(lx - 788.5 - mirrored < 4 * (error + 0.6) + 2);
}

static void test_what_is_no_project_is_refused(void **state)
{
    struct cli_desk *f = *state;
    const char *const folder[] = {"project", "api", NULL};
    cli_run(folder, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "is not a project"));
    const char *const document[] = {"run", f->document, "-o", f->output, "--states", "a=b", NULL};
    cli_run(document, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "--states are only for projects"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_model_is_listed_and_written, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_models_are_known_by_what_they_say, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_model_is_warned_of, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_skies_of_the_command_line, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_files_above_the_document, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_states_let_in_more_or_less, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_model_without_grids_asks_for_nothing, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_states_are_the_shades_of_a_year, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year_without_a_document, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_own_files_are_not_written_over, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_luminaires_of_a_model_shine, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_what_is_no_project_is_refused, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_grids_keep_their_names, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_names_that_are_none_are_refused, set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
