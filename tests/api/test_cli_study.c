/* `oriel study` from a script's view: usage, mistakes, and a complete small study. */
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

static const char scene_text[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_SKY;

static const char study_text[] =
    "{\"kind\": \"study\", \"title\": \"A room\", \"scene\": {\"files\": [\"room.rad\"]},\n"
    " \"sensors\": {\"file\": \"sensors.txt\"}, \"techniques\": [\"gather\", \"direct\"],\n"
    " \"photons\": [5000, 20000], \"gather_samples\": [64], \"repeats\": 2,\n"
    " \"reference\": {\"samples\": 16384},\n"
    " \"points\": [{\"name\": \"By hand\", \"seconds\": 3600, \"rms\": 0.5}]}\n";

static const char sensors_text[] = "# x y z dx dy dz\n2 1 0.8 0 0 1\n2 3 0.8 0 0 1\n";

static int set_up(void **state)
{
    static const struct cli_file files[] = {{"study.json", study_text},
                                            {"room.rad", scene_text},
                                            {"sensors.txt", sensors_text},
                                            {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

static void run_study(struct cli_desk *f)
{
    const char *const args[] = {"study", f->document, "--output", f->output, NULL};

    cli_run(args, &f->result);
}

static void test_wrong_command_lines_exit_with_2(void **state)
{
    struct cli_desk *f = *state;
    const char *const no_output[] = {"study", f->document, NULL};
    const char *const threads[] = {"study", f->document, "-o", f->output, "-j", "none", NULL};

    cli_run(no_output, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    assert_says(f->result.err, "-o DIR is missing");
    cli_run(threads, &f->result);
    assert_int_equal(f->result.exit_code, 2);
    assert_says(f->result.err, "from 1 to 1024");
}

static void test_mistakes_name_file_and_place(void **state)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"{\"kind\": \"study\",\n \"scene\": }\n", "study.json:2: "},
        {"{\"kind\": \"study\", \"scenes\": 1}", "study.json: scenes: "},
        {"{\"kind\": \"study\", \"scene\": {\"files\": [\"room.rad\"]}, \"sensors\": {\"file\":"
         " \"sensors.txt\"}, \"techniques\": [\"direct\"], \"reference\": {\"samples\": 1}}",
         "study.json: photons: technique \"direct\" needs a list of photons"},
        {"{\"kind\": \"study\", \"scene\": {\"files\": [\"rum.rad\"]}, \"sensors\": {\"file\":"
         " \"sensors.txt\"}, \"techniques\": [\"direct\"], \"photons\": [9], \"reference\":"
         " {\"samples\": 1}}",
         "rum.rad"},
    };
    struct cli_desk *f = *state;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cli_write_file(f->folder, "study.json", cases[i].text);
        run_study(f);
        assert_int_equal(f->result.exit_code, 1);
        assert_string_equal(f->result.out, "");
        assert_says(f->result.err, cases[i].says);
        assert_null(cli_read_file(f->output, "study.json"));
    }
}

static void assert_json(const char *output)
{
    char *text = cli_read_file(output, "study.json");
    json_t *json = text ? json_loads(text, 0, NULL) : NULL;
    const json_t *points = json_object_get(json, "points");

    assert_non_null(json);
    assert_string_equal(json_string_value(json_object_get(json, "kind")), "study");
    assert_int_equal(json_integer_value(json_object_get(json, "threads")), 1);
    assert_int_equal(json_array_size(points), 4);
    for (size_t i = 0; i < 4; i++) {
        const json_t *p = json_array_get(points, i);

        assert_string_equal(json_string_value(json_object_get(p, "technique")),
                            i < 2 ? "gather" : "direct");
        assert_int_equal(json_integer_value(json_object_get(p, "photons")), i % 2 ? 20000 : 5000);
        assert_true(json_number_value(json_object_get(p, "rms")) > 0);
    }
    json_decref(json);
    free(text);
}

static void test_a_study_leaves_four_files_and_a_table(void **state)
{
    static const struct {
        const char *name, *begins;
    } files[] = {
        {"study.csv", "technique,photons,"}, {"study.svg", "<svg "}, {"study.png", "\x89PNG"}};
    struct cli_desk *f = *state;

    run_study(f);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_says(f->result.out, "reference: backward, 16384 samples in 8 runs");
    assert_says(f->result.out, " 5.0 k ");
    assert_says(f->result.out, "rms^2 =");
    assert_json(f->output);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char *text = cli_read_file(f->output, files[i].name);

        assert_non_null(text);
        assert_memory_equal(text, files[i].begins, strlen(files[i].begins));
        assert_says(f->result.out, files[i].name);
        free(text);
    }
    /* A header line and one line for each point, all with equally many columns. */
    char *csv = cli_read_file(f->output, "study.csv");
    size_t lines = 0, commas = 0, first = 0;
    for (const char *c = csv; *c; c++) {
        commas += *c == ',';
        if (*c != '\n')
            continue;
        first = lines == 0 ? commas : first;
        assert_int_equal(commas, first);
        commas = 0;
        lines++;
    }
    assert_int_equal(lines, 5);
    free(csv);
}

/* An older study's files are removed when a new one starts, even if that fails. */
static void test_older_files_do_not_survive_a_failure(void **state)
{
    struct cli_desk *f = *state;

    run_study(f);
    assert_int_equal(f->result.exit_code, 0);
    cli_write_file(f->folder, "study.json", "[]");
    run_study(f);
    assert_int_equal(f->result.exit_code, 1);
    assert_null(cli_read_file(f->output, "study.json"));
    assert_null(cli_read_file(f->output, "study.svg"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_wrong_command_lines_exit_with_2, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes_name_file_and_place, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_study_leaves_four_files_and_a_table, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_older_files_do_not_survive_a_failure, set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
