/* `oriel annual` from a script's view: usage, mistakes, and a complete run of two days. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"
#include "support/room.h"

static const char scene_text[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;

static const char year_text[] =
    "{\"kind\": \"annual\", \"title\": \"A room\", \"scene\": {\"files\": [\"room.rad\"]},\n"
    " \"weather\": \"place.epw\", \"samples\": 64, \"seed\": 3,\n"
    " \"grids\": [{\"name\": \"the desks\", \"sensors\": {\"file\": \"desks.pts\"}},\n"
    "             {\"sensors\": [[2, 2, 1.2, 0, -1, 0], [4, 2, 0.8, 0, 0, 1]]}],\n"
    " \"targets\": [\"sDA300/50 of the desks >= 1 %\", \"ASE <= 10 %\"], \"rules\": [\"EN 17037 "
    "minimum\"]}\n";

static int set_up(void **state)
{
    static char desks[2048];
    size_t at = 0;
    for (int i = 0; i < 24; i++)
        at += (size_t)snprintf(desks + at, sizeof desks - at, "%g %g 0.8 0 0 1\n",
                               0.5 + 0.5 * (i % 6), 0.5 + 0.75 * (double)(i / 6));
    const struct cli_file files[] = {
        {"year.json", year_text}, {"room.rad", scene_text}, {"desks.pts", desks}, {NULL, NULL}};
    const int code = cli_desk_set_up(state, files);
    char *weather = cli_read_file("tests/fixtures", "weather.epw");
    assert_non_null(weather);
    cli_write_file(((struct cli_desk *)*state)->folder, "place.epw", weather);
    free(weather);
    return code;
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

static void test_wrong_command_lines_exit_with_2(void **state)
{
    struct cli_desk *f = *state;
    const char *const no_output[] = {"annual", f->document, NULL};
    const char *const no_document[] = {"annual", "-o", f->output, NULL};
    const char *const help[] = {"annual", "--help", NULL};

    cli_run(no_output, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    assert_says(f->result.err, "-o DIR is missing");
    cli_run(no_document, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    cli_run(help, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_says(f->result.out, "--honeybee");
}

static void test_mistakes_name_file_and_place(void **state)
{
    static const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"\"ASE <= 10 %\"", "\"ASE <= lots\"", "year.json: targets[1]: "},
        {"of the desks", "of the moon", "there is no grid named 'the moon'"},
        {"place.epw", "nowhere.epw", "nowhere.epw"},
        {"desks.pts", "chairs.pts", "chairs.pts"},
        {"\"samples\": 64", "\"occupancy\": {\"file\": \"desks.pts\"}", "desks.pts:1: "},
    };
    struct cli_desk *f = *state;
    const char *const args[] = {"annual", f->document, "-o", f->output, NULL};

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *at = strstr(year_text, cases[i].from);
        char text[2048];

        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - year_text), year_text, cases[i].to,
                 at + strlen(cases[i].from));
        cli_write_file(f->folder, "year.json", text);
        cli_run(args, &f->result);
        assert_int_equal(f->result.exit_code, 1);
        assert_says(f->result.err, cases[i].says);
        char *result = cli_read_file(f->output, "result.json");
        assert_non_null(result);
        assert_says(result, "\"failed\"");
        free(result);
    }
}

static json_t *run_annual(struct cli_desk *f, const char *threads)
{
    const char *const args[] = {"annual", f->document,  "-o",    f->output, "-j",
                                threads,  "--honeybee", "--ill", NULL};
    char path[256];
    cli_run(args, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    snprintf(path, sizeof path, "%s/result.json", f->output);
    json_t *result = json_load_file(path, 0, NULL);
    assert_non_null(result);
    return result;
}

/* With 64 paths per sensor the command and the result warn of large errors, with files of hours and
 * without. */
static void assert_warns_of_errors(const struct cli_desk *f, const json_t *result)
{
    static const char wanted[] = "the standard error is above 25 % of the illuminance in ";
    const json_t *warnings = json_object_get(result, "warnings"), *warning;
    size_t i, found = 0;
    assert_says(f->result.err, wanted);
    json_array_foreach(warnings, i, warning)
    {
        found += strncmp(json_string_value(warning), wanted, sizeof wanted - 1) == 0;
    }
    assert_int_equal(found, 1);
}

static const char *text_at(const json_t *list, size_t i, const char *member)
{
    const char *text = json_string_value(json_object_get(json_array_get(list, i), member));
    return text ? text : "(none)";
}

static void assert_files_are_there(const struct cli_desk *f, const json_t *result)
{
    const json_t *files = json_object_get(result, "files"), *name;
    size_t i;
    bool page = false, carpet = false, pdf = false;

    json_array_foreach(files, i, name)
    {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", f->output, json_string_value(name));
        if (access(path, R_OK) != 0)
            fail_msg("%s is not there", path);
        page = page || strcmp(json_string_value(name), "the_desks.page.svg") == 0;
        pdf = pdf || strcmp(json_string_value(name), "the_desks.page.pdf") == 0;
        carpet = carpet || strcmp(json_string_value(name), "grid2.year300.png") == 0;
    }
    assert_true(page && carpet && pdf);
}

/* Errors of both grids are stored as matrices and in Honeybee's folder. */
static void assert_errors_are_listed(const json_t *result)
{
    const json_t *files = json_object_get(result, "files"), *name;
    size_t i, found = 0;
    json_array_foreach(files, i, name)
    {
        found += strstr(json_string_value(name), ".se.ill") != NULL;
        found += strstr(json_string_value(name), "__static_apertures__/default/se/") != NULL;
    }
    assert_int_equal(found, 4);
}

/* ---- Years of the weather file --------------------------------------------------------------- */

enum { HEADER_LINES = 8, DAY_LINES = 24 };

/* Copies that many lines with another year; 0: unchanged. Returns the rest. */
static const char *copy_lines(FILE *to, const char *from, int lines, int year)
{
    for (int i = 0; i < lines; i++) {
        const char *const end = strchr(from, '\n') + 1;
        if (year > 0) {
            from = strchr(from, ',');
            fprintf(to, "%d", year);
        }
        fwrite(from, 1, (size_t)(end - from), to);
        from = end;
    }
    return from;
}

/* Writes place.epw with its days in either order, or in two years. */
static void write_weather(const struct cli_desk *f, bool second_first, bool two_years)
{
    char *epw = cli_read_file("tests/fixtures", "weather.epw"), *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    assert_true(epw && stream);
    const char *const first = copy_lines(stream, epw, HEADER_LINES, 0);
    const char *second = first;
    for (int i = 0; i < DAY_LINES; i++)
        second = strchr(second, '\n') + 1;
    copy_lines(stream, second_first ? second : first, DAY_LINES, 2019);
    copy_lines(stream, second_first ? first : second, DAY_LINES, 2019);
    if (two_years)
        copy_lines(stream, first, 2 * DAY_LINES, 2023);
    assert_int_equal(fclose(stream), 0);
    cli_write_file(f->folder, "place.epw", text);
    free(text);
    free(epw);
}

static char *hours_of_year(struct cli_desk *f, const char *member)
{
    const char *const args[] = {"annual", f->document, "-o", f->output, "-j", "2", NULL};
    char text[2048];
    snprintf(text, sizeof text, "{%s%s", member, year_text + 1);
    cli_write_file(f->folder, "year.json", text);
    cli_run(args, &f->result);
    return f->result.exit_code == 0 ? cli_read_file(f->output, "hours.csv") : NULL;
}

/* Rotates the lines of a table after the header: the last n come first. */
static char *turn_lines(char *table, int n)
{
    char *const first = strchr(table, '\n') + 1, *at = table + strlen(table), *text = NULL;
    for (int i = 0; i < n; i++)
        do
            at--;
        while (at[-1] != '\n');
    assert_true(asprintf(&text, "%s%.*s", at, (int)(at - first), first) > 0);
    free(table);
    return text;
}

/* A file that continues over 31 December gives the hours of one that does not, in the order of its
 * rows. A file of two years needs a year in the request, and gives the hours of that one. */
static void test_years_of_the_weather_file(void **state)
{
    struct cli_desk *f = *state;
    write_weather(f, false, false);
    char *const plain = hours_of_year(f, "");
    assert_says(f->result.err, "the standard error is above 25 % of the illuminance in ");
    write_weather(f, true, false);
    char *const moved = hours_of_year(f, "");
    if (!plain || !moved)
        fail_msg("%s", f->result.err);
    char *const turned = turn_lines(moved, DAY_LINES);
    assert_string_equal(turned, strchr(plain, '\n') + 1);
    write_weather(f, false, true);
    assert_null(hours_of_year(f, ""));
    assert_says(f->result.err, "rows of 2019 and of 2023");
    assert_says(f->result.err, "\"year\": 2019");
    char *const chosen = hours_of_year(f, "\"year\": 2019, ");
    assert_non_null(chosen);
    assert_string_equal(chosen, plain);
    assert_null(hours_of_year(f, "\"year\": 2021, "));
    assert_says(f->result.err, "no rows for 2021: its years are 2019 to 2023");
    free(plain);
    free(turned);
    free(chosen);
}

/* The columns of the matrices are hours of 22 March, the 81st day, and of 21 December. */
static void assert_columns_are_listed(const struct cli_desk *f, double hours)
{
    char *const list = cli_read_file(f->output, "columns.csv"), wanted[64];
    char *const ill = cli_read_file(f->output, "the_desks.ill");
    char *const errors = cli_read_file(f->output, "the_desks.se.ill");
    int lines = 0;
    assert_true(list && ill && errors);
    for (const char *at = list; *at; at++)
        lines += *at == '\n';
    assert_true(lines > 10 && lines == 1 + (int)hours);
    snprintf(wanted, sizeof wanted, "NCOLS=%d\n", lines - 1);
    assert_says(ill, wanted);
    assert_says(errors, wanted);
    free(errors);
    assert_int_equal(strncmp(list, "column,month,day,hour,hour_of_year\n0,3,22,", 42), 0);
    assert_says(list, ",3,22,11.5,1931.5\n");
    free(list);
    free(ill);
}

/* Two days of the year: the other days never count, and a warning states this. */
static void test_a_year_to_its_end(void **state)
{
    struct cli_desk *f = *state;
    json_t *result = run_annual(f, "1");
    const json_t *verdicts = json_object_get(result, "verdicts");
    const json_t *hours = json_object_get(result, "hours");
    const json_t *provenance = json_object_get(result, "provenance");
    const json_t *inputs = json_object_get(provenance, "inputs");

    assert_string_equal(json_string_value(json_object_get(result, "state")), "succeeded");
    assert_int_equal(json_array_size(json_object_get(result, "grids")), 2);
    assert_true(json_number_value(json_object_get(hours, "year")) < 300);
    assert_true(json_number_value(json_object_get(hours, "missing")) > 8000);
    /* One grid by name; all grids, and each grid, for the other target and two of the rule. */
    assert_int_equal(json_array_size(verdicts), 1 + 3 + 3 * 2);
    assert_string_equal(text_at(verdicts, 0, "grid"), "the desks");
    assert_string_equal(text_at(verdicts, 1, "grid"), "(none)");
    assert_string_equal(text_at(verdicts, 9, "rule"), "EN 17037 minimum");
    assert_int_equal(json_array_size(json_object_get(result, "rules")), 3);
    assert_int_equal(json_integer_value(json_object_get(provenance, "samples")), 64);
    assert_int_equal(json_array_size(inputs), 3);
    assert_string_equal(text_at(inputs, 0, "name"), "desks.pts");
    assert_int_equal(strlen(text_at(inputs, 0, "sha256")), 64);
    assert_says(f->result.err, "steps of the year are not in the weather file");
    assert_says(f->result.err, "warning: grid 'grid2': 1 of 2 sensors: the sensor lies in the "
                               "plane of a surface; the first, number 2 ");
    assert_says(f->result.err, " at (4, 2, 0.8), ");
    assert_says(f->result.out, "result.json");
    assert_files_are_there(f, result);
    assert_warns_of_errors(f, result);
    assert_errors_are_listed(result);
    char *page = cli_read_file(f->output, "the_desks.page.svg");
    assert_non_null(page);
    assert_says(page, ">A room</text>");
    assert_says(page, "EN 17037 minimum: ");
    assert_says(page, ">Warnings<");
    assert_null(strstr(page, "in the plane of a surface")); /* belongs to the other grid */
    free(page);
    page = cli_read_file(f->output, "grid2.page.svg");
    assert_non_null(page);
    assert_says(page, ">grid 'grid2': 1 of 2 sensors: the sensor lies in the plane of a surface; ");
    assert_says(page, "True north is +Y of the model, which is up in plans.");
    free(page);
    assert_columns_are_listed(f, json_number_value(json_object_get(hours, "sun_up")));
    json_decref(result);
}

static void test_threads_change_nothing(void **state)
{
    static const char *const names[] = {"sensors.csv",         "hours.csv",
                                        "the_desks.page.svg",  "the_desks.page.pdf",
                                        "the_desks.da300.svg", "the_desks.year.svg"};
    enum { NAMES = sizeof names / sizeof *names };
    struct cli_desk *f = *state;
    char *first[NAMES];

    json_decref(run_annual(f, "1"));
    for (int i = 0; i < NAMES; i++)
        assert_non_null(first[i] = cli_read_file(f->output, names[i]));
    json_decref(run_annual(f, "3"));
    for (int i = 0; i < NAMES; i++) {
        char *again = cli_read_file(f->output, names[i]);
        assert_non_null(again);
        assert_string_equal(first[i], again);
        free(again);
        free(first[i]);
    }
}

/* Returns the position of the text in the log, at the beginning of a line; NULL if it is absent. */
static const char *find_line(const char *log, const char *text)
{
    for (const char *at = strstr(log, text); at; at = strstr(at + 1, text))
        if (at == log || at[-1] == '\n')
            return at;
    fail_msg("no line begins with \"%s\" in:\n%s", text, log);
    return NULL;
}

/* Lines of a common log (`> log 2>&1`) are whole and in the order in which they were written:
 * verdicts, seconds, the path of the result. */
static void test_both_outputs_in_one_log(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"annual", f->document, "-o", f->output, NULL};
    cli_run_merged(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    const char *const seconds = find_line(f->result.out, "seconds: ");
    const char *const path = find_line(f->result.out, f->output);
    assert_true(strstr(f->result.out, "sDA300/50 of the desks") < seconds);
    assert_true(strstr(f->result.out, "EN 17037 minimum: ") < seconds);
    assert_true(seconds < path);
}

/* A bound in the middle of the first paths' interval: only some sensors get more paths. */
static void test_until_a_verdict_is_sure(void **state)
{
    struct cli_desk *f = *state;
    const char *end = strrchr(year_text, '}');
    char text[2048];

    snprintf(text, sizeof text,
             "%.*s, \"accuracy\": {\"verdict\": \"sDA1000/40 of the desks >= 20 %%\"}}",
             (int)(end - year_text), year_text);
    cli_write_file(f->folder, "year.json", text);
    json_t *result = run_annual(f, "2");
    const json_t *accuracy = json_object_get(result, "accuracy");
    const double low =
        json_number_value(json_array_get(json_object_get(accuracy, "interval_95"), 0));
    const double high =
        json_number_value(json_array_get(json_object_get(accuracy, "interval_95"), 1));
    const json_int_t refined = json_integer_value(json_object_get(accuracy, "refined_sensors"));
    assert_true(json_is_true(json_object_get(accuracy, "settled")));
    assert_true(low >= 20 || high < 20 || (low >= 19.5 && high <= 20.5));
    assert_true(refined < 24);
    assert_true(json_integer_value(json_object_get(accuracy, "rounds")) >= 1);
    assert_says(f->result.err, "round 1: sDA1000/40 of the desks");
    json_decref(result);
}

/* The page states the assumption about shades: none move, or the time in each state. */
static void test_the_page_tells_of_shades(void **state)
{
    struct cli_desk *f = *state;
    const char *end = strrchr(year_text, '}');
    char text[2048];

    snprintf(text, sizeof text,
             "%.*s, \"shades\": [{\"name\": \"south\", \"windows\": [\"pane\"], \"states\": "
             "[{\"name\": \"up\"}, {\"name\": \"down\", \"dark\": true}], \"rules\": "
             "[{\"from\": 12, \"state\": \"down\"}]}]}",
             (int)(end - year_text), year_text);
    for (int i = 0; i < 2; i++) {
        json_t *result = run_annual(f, "2");
        const json_t *groups = json_object_get(json_object_get(result, "shades"), "groups");
        const json_t *states = json_object_get(json_array_get(groups, 0), "states");
        char *page = cli_read_file(f->output, "the_desks.page.svg"), wanted[96];
        assert_non_null(page);
        snprintf(wanted, sizeof wanted, "south: up %.0f h, down %.0f h<",
                 json_number_value(json_object_get(json_array_get(states, 0), "occupied_hours")),
                 json_number_value(json_object_get(json_array_get(states, 1), "occupied_hours")));
        assert_says(page, i == 0 ? "No movable blinds or shades. " : wanted);
        assert_true(i == 0 || !strstr(page, "No movable blinds or shades"));
        cli_write_file(f->folder, "year.json", text);
        json_decref(result);
        free(page);
    }
}

/* The cache of a run serves another weather file of the place. */
static void test_a_cache_is_used_again(void **state)
{
    struct cli_desk *f = *state;
    char cache[96], *first, *again;
    snprintf(cache, sizeof cache, "%s/cache/years", f->folder);
    const char *const plain[] = {"annual", f->document, "-o", f->output, NULL};
    const char *const keeping[] = {"annual", f->document, "-o", f->output, "--cache", cache, NULL};

    cli_run(plain, &f->result);
    assert_null(strstr(f->result.err, "cache:"));
    assert_non_null(first = cli_read_file(f->output, "sensors.csv"));
    for (int i = 0; i < 2; i++) {
        cli_run(keeping, &f->result);
        assert_int_equal(f->result.exit_code, 0);
        assert_says(f->result.err, i == 0 ? "paths: 0 found, 1 made" : "paths: 1 found, 0 made");
        assert_non_null(again = cli_read_file(f->output, "sensors.csv"));
        assert_string_equal(first, again);
        free(again);
    }
    char *result = cli_read_file(f->output, "result.json");
    assert_non_null(result);
    assert_says(result, "\"rays\": 0");
    free(result);
    free(first);
}

static int verify(struct cli_desk *f, const char *result)
{
    const char *const args[] = {"verify", result, "--files", f->folder, "-j", "3", NULL};
    cli_run(args, &f->result);
    return f->result.exit_code;
}

/* Verifies an equal result, another result, another input, a missing one, and a result that is not
 * annual. */
static void test_verify(void **state)
{
    struct cli_desk *f = *state;
    const char *const nowhere[] = {"verify", f->output, NULL};
    char path[128], *text;

    json_decref(run_annual(f, "1"));
    snprintf(path, sizeof path, "%s/result.json", f->output);
    assert_int_equal(verify(f, f->output), 0);
    assert_says(f->result.out, "the same: ");
    assert_int_equal(verify(f, path), 0);
    cli_write_file(f->output, "hours.csv", "1\n");
    assert_int_equal(verify(f, path), 1);
    assert_string_equal(f->result.out, "differs: hours.csv\n");
    assert_non_null(text = cli_read_file(f->output, "result.json"));
    char *at = strstr(text, "\"interval_95\": [");
    assert_non_null(at);
    at = strpbrk(at, "123456789");
    *at = *at == '1' ? '2' : '1';
    cli_write_file(f->output, "result.json", text);
    free(text);
    assert_int_equal(verify(f, path), 1);
    assert_says(f->result.out, "differs: result.json: \"grids\"\n");
    cli_write_file(f->folder, "desks.pts", "2 2 0.8 0 0 1\n");
    assert_int_equal(verify(f, path), 2);
    assert_says(f->result.err, "desks.pts: the file has changed: its SHA-256 is ");
    assert_says(f->result.err, "1 of 3 inputs differs from those of the result");
    cli_run(nowhere, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    assert_says(f->result.err, "3 of 3 inputs");
    cli_write_file(f->output, "result.json", "{\"kind\": \"render\"}");
    assert_int_equal(verify(f, path), 2);
    assert_says(f->result.err, "only results of years (\"annual\") can be verified");
}

/* The warning reaches the command line and result.json, by grid. */
static void test_misplaced_sensors(void **state)
{
    static const char wanted[] = "grid 'the desks': 1 of 5 sensors lies outdoors, and the others "
                                 "in a closed space: number 5 (from 1), the first at (1, 1, -0.1)";
    struct cli_desk *f = *state;
    cli_write_file(f->folder, "desks.pts",
                   "1 1 .8 0 0 1\n2 1 .8 0 0 1\n1 2 .8 0 0 1\n2 2 .8 0 0 1\n1 1 -.1 0 0 1\n");
    json_t *result = run_annual(f, "1");
    char *told = json_dumps(json_object_get(result, "warnings"), 0);
    assert_non_null(told);
    assert_says(told, wanted);
    assert_says(f->result.err, wanted);
    free(told);
    json_decref(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_wrong_command_lines_exit_with_2, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes_name_file_and_place, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_years_of_the_weather_file, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year_to_its_end, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_threads_change_nothing, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_both_outputs_in_one_log, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_until_a_verdict_is_sure, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_the_page_tells_of_shades, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_cache_is_used_again, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_verify, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_misplaced_sensors, set_up, cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
