/* `oriel` from a script's view, without a daemon: usage, exit codes, and complete runs of `oriel
 * run`. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"
#include "support/patience.h"

/* A room with one window, a sky without a sun outside, and a wall in view. */
static const char scene_text[] = "# closed but for the window\n"
                                 "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void glass pane\n0\n0\n3 0.96 0.96 0.96\n"
                                 "void glow sky_glow\n0\n0\n4 10 10 10 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0\n"
                                 "grey polygon ceiling\n0\n0\n12 0 0 3  0 4 3  3 4 3  3 0 3\n"
                                 "grey polygon west\n0\n0\n12 0 0 0  0 4 0  0 4 3  0 0 3\n"
                                 "grey polygon east\n0\n0\n12 3 0 0  3 0 3  3 4 3  3 4 0\n"
                                 "grey polygon north\n0\n0\n12 0 4 0  3 4 0  3 4 3  0 4 3\n"
                                 "pane polygon window\n0\n0\n12 3 0 0  0 0 0  0 0 3  3 0 3\n";

static const char job_text[] =
    "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]}, \"technique\": \"gather\",\n"
    " \"seed\": 7, \"photons\": {\"global\": 20000, \"caustic\": 20000}, \"gather_samples\": 64,\n"
    " \"sensors\": {\"file\": \"sensors.txt\"},\n"
    " \"views\": [{\"name\": \"north\", \"view\": \"-vtv -vp 1.5 0.5 1.5 -vd 0 1 0 -vh 60 -vv "
    "47\",\n"
    "            \"width\": 32, \"height\": 24}]}\n";

static const char sensors_text[] = "# x y z dx dy dz\n1.5 1 0.8 0 0 1\n1.5 3 0.8 0 0 1\n";

static int set_up(void **state)
{
    static const struct cli_file files[] = {{"job.json", job_text},
                                            {"room.rad", scene_text},
                                            {"sensors.txt", sensors_text},
                                            {NULL, NULL}};
    return cli_desk_set_up(state, files);
}

static void run_job(struct cli_desk *f, const char *output, const char *threads)
{
    const char *const args[] = {"run", f->document, "-o", output, "--threads", threads, NULL};

    cli_run(args, &f->result);
}

static json_t *load_result(const char *output)
{
    char *text = cli_read_file(output, "result.json");
    json_t *json;

    assert_non_null(text);
    json = json_loads(text, 0, NULL);
    free(text);
    assert_non_null(json);
    return json;
}

static const char *text_of(const json_t *json, const char *key)
{
    const char *text = json_string_value(json_object_get(json, key));

    return text ? text : "";
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

static void test_wrong_command_lines_exit_with_2(void **state)
{
    static const struct {
        const char *args[8];
        const char *says;
    } cases[] = {
        {{NULL}, "usage: oriel COMMAND"},
        {{"frobnicate"}, "no command \"frobnicate\""},
        {{"run", "job.json"}, "-o DIR is missing"},
        {{"run", "-o", "out"}, "missing operands"},
        {{"run", "a.json", "b.json", "-o", "out"}, "too many operands"},
        {{"run", "a.json", "-o"}, "--output needs a value"},
        {{"run", "a.json", "-o", "out", "--threads", "0"}, "from 1 to 1024"},
        {{"run", "a.json", "-o", "out", "--threads", "2x"}, "from 1 to 1024"},
        {{"status", "--sevrer", "http://x"}, "unknown option \"--sevrer\""},
        {{"submit", "a.json", "--wait=yes"}, "--wait takes no value"},
        {{"upload", "picture", "a.hdr"}, "neither scene nor bsdf"},
        {{"fetch", "1"}, "-o DIR is missing"},
    };
    struct cli_desk *f = *state;

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cli_run(cases[i].args, &f->result);
        assert_int_equal(f->result.exit_code, 2);
        assert_string_equal(f->result.out, "");
        assert_says(f->result.err, cases[i].says);
    }
}

static void test_every_command_has_help(void **state)
{
    static const char *const names[] = {"run",    "plan",   "project", "annual", "verify", "part",
                                        "study",  "submit", "status",  "watch",  "wait",   "fetch",
                                        "cancel", "remove", "list",    "link",   "maps",   "upload",
                                        "bsdf",   "glare",  "health",  "version"};
    struct cli_desk *f = *state;
    const char *const overview[] = {"--help", NULL};

    cli_run(overview, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *const args[] = {names[i], "--help", NULL};
        struct cli_result *help = malloc(sizeof *help);
        char usage[64];

        assert_non_null(help);
        assert_says(f->result.out, names[i]);
        cli_run(args, help);
        assert_int_equal(help->exit_code, 0);
        snprintf(usage, sizeof usage, "usage: oriel %s", names[i]);
        assert_says(help->out, usage);
        free(help);
    }
}

static void test_mistakes_are_named_and_recorded(void **state)
{
    static const struct {
        const char *file, *text; /* text written over the good file; NULL removes it */
        const char *says, *type;
    } cases[] = {
        {"job.json", "{\"kind\": \"render\",\n \"scene\": }\n", "job.json:2: ", "syntax"},
        {"job.json", "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]}, \"sede\": 1}",
         "job.json: sede: ", "invalid"},
        {"job.json", "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]}}",
         "job.json: ", "invalid"},
        {"job.json", NULL, "job.json", "not-found"},
        {"job.json", "void plastic grey\n0\n0\n5 .5 .5 .5 0 0\n",
         "the file must be a JSON job document that lists the scene's files, or a project",
         "syntax"},
        {"job.json", "{\"kind\": \"annual\"}",
         "not \"annual\" (use `oriel annual` for such a document)", "invalid"},
        {"room.rad", NULL, "room.rad", "not-found"},
        {"room.rad", "", "room.rad", "syntax"},
        {"room.rad", "void plastic grey\n0\n0\n5 0.5 nan 0.5 0 0\n",
         "room.rad:4: ", "out-of-range"},
        {"room.rad",
         "void BRTDfunc veil\n10 0 0 0 Px Px Px 0 0 0 .\n0\n9 0 0 0 0 0 0 0 0 0\nveil sphere "
         "s\n0\n0\n4 0 0 0 1\n",
         "BRTDfunc veil", "unsupported"},
        {"room.rad", "void BRTDfunc veil\n10 0 0 0 Px Px Px 0 0 0 .\n0\n9 0 0 0 0 0 0 0 0 0\n",
         "warning: BRTDfunc veil at room.rad:1 is ignored", "unlit"},
        {"sensors.txt", "1 2 3 0 0 1\n1 2 3\n", "sensors.txt:2: ", "syntax"},
        {"sensors.txt", "1 2 3 0 0 1\n\n1e20 2 3 0 0 1\n", "sensors.txt:3: ", "out-of-range"},
        {"job.json",
         "{\"scene\": {\"files\": [\"room.rad\"]}, \"sensors\": [[0, -1e300, 0, 0, 0, 1]]}",
         "sensors[0]: a position needs finite coordinates of at most 1e+12", "out-of-range"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct cli_desk *f;
        json_t *result;
        char type[64];

        cli_desk_tear_down(state);
        set_up(state);
        f = *state;
        cli_write_file(f->folder, cases[i].file, cases[i].text ? cases[i].text : "");
        if (!cases[i].text) {
            char path[160];

            snprintf(path, sizeof path, "%s/%s", f->folder, cases[i].file);
            unlink(path);
        }
        run_job(f, f->output, "1");
        assert_int_equal(f->result.exit_code, 1);
        assert_says(f->result.err, cases[i].says);
        result = load_result(f->output);
        assert_string_equal(text_of(result, "state"), "failed");
        snprintf(type, sizeof type, "urn:oriel:error:%s", cases[i].type);
        assert_string_equal(text_of(json_object_get(result, "error"), "type"), type);
        json_decref(result);
    }
}

static void test_an_older_result_does_not_survive_a_failure(void **state)
{
    struct cli_desk *f = *state;
    json_t *result;

    assert_int_equal(mkdir(f->output, 0777), 0);
    cli_write_file(f->output, "result.json", "{\"state\": \"succeeded\"}");
    cli_write_file(f->folder, "job.json", "[]");
    run_job(f, f->output, "1");
    assert_int_equal(f->result.exit_code, 1);
    result = load_result(f->output);
    assert_string_equal(text_of(result, "state"), "failed");
    json_decref(result);
}

static void assert_images(const char *output, const json_t *result)
{
    const json_t *view = json_array_get(json_object_get(result, "views"), 0);
    char *hdr = cli_read_file(output, text_of(view, "hdr"));
    char *png = cli_read_file(output, text_of(view, "png"));

    assert_string_equal(text_of(view, "name"), "north");
    assert_non_null(hdr);
    assert_non_null(png);
    assert_memory_equal(hdr, "#?RADIANCE\n", 11);
    assert_memory_equal(png, "\x89PNG", 4);
    free(hdr);
    free(png);
}

static double lux(const json_t *result, size_t index)
{
    const json_t *sensor = json_array_get(json_object_get(result, "sensors"), index);

    return json_number_value(json_object_get(sensor, "illuminance_lx"));
}

static int all_cached(const json_t *result)
{
    const json_t *maps = json_object_get(result, "maps"), *map;
    size_t i, cached = 0;

    json_array_foreach(maps, i, map)
    {
        cached += json_is_true(json_object_get(map, "cached"));
    }
    return cached > 0 && cached == json_array_size(maps);
}

static void test_a_run_leaves_numbers_images_and_maps(void **state)
{
    struct cli_desk *f = *state;
    json_t *first, *second;

    run_job(f, f->output, "1");
    assert_int_equal(f->result.exit_code, 0);
    first = load_result(f->output);
    assert_string_equal(text_of(first, "state"), "succeeded");
    assert_int_equal(json_integer_value(json_object_get(first, "threads")), 1);
    assert_int_equal(json_integer_value(json_object_get(first, "seed")), 7);
    assert_int_equal(json_array_size(json_object_get(first, "sensors")), 2);
    /* The window lights both sensors, the nearer one more. */
    assert_true(lux(first, 0) > lux(first, 1) && lux(first, 1) > 0);
    assert_images(f->output, first);
    assert_false(all_cached(first));
    /* A second run with the maps cached gives equal numbers. */
    run_job(f, f->output, "1");
    assert_int_equal(f->result.exit_code, 0);
    second = load_result(f->output);
    assert_true(all_cached(second));
    assert_true(lux(first, 0) == lux(second, 0) && lux(first, 1) == lux(second, 1));
    json_decref(first);
    json_decref(second);
}

static void assert_same_bytes(const char *folder, const char *other, const char *name)
{
    char a_path[192], b_path[192];
    FILE *a, *b;
    int byte;
    long count = 0;

    snprintf(a_path, sizeof a_path, "%s/%s", folder, name);
    snprintf(b_path, sizeof b_path, "%s/%s", other, name);
    a = fopen(a_path, "rb");
    b = fopen(b_path, "rb");
    assert_true(a && b);
    do {
        byte = getc(a);
        assert_int_equal(byte, getc(b));
        count++;
    } while (byte != EOF);
    assert_true(count > 100); /* neither is empty */
    fclose(a);
    fclose(b);
}

static void test_threads_change_no_byte(void **state)
{
    struct cli_desk *f = *state;
    char other[96];
    json_t *a, *b;

    snprintf(other, sizeof other, "%s/other", f->folder);
    run_job(f, f->output, "1");
    assert_int_equal(f->result.exit_code, 0);
    run_job(f, other, "3");
    assert_int_equal(f->result.exit_code, 0);
    a = load_result(f->output);
    b = load_result(other);
    assert_true(json_equal(json_object_get(a, "sensors"), json_object_get(b, "sensors")));
    assert_same_bytes(f->output, other, "north.hdr");
    assert_same_bytes(f->output, other, "north.png");
    assert_same_bytes(f->output, other, "north.error.hdr");
    assert_same_bytes(f->output, other, "north.error.png");
    json_decref(a);
    json_decref(b);
}

/* Waits until the child has a handler for SIGINT, by "SigCgt" of its status in /proc. */
static void await_handler(const struct cli_child *child)
{
    char folder[32];
    bool catches = false;

    snprintf(folder, sizeof folder, "/proc/%d", (int)child->pid);
    for (double until = patience_until(); !catches && patience_nap(until);) {
        char *status = cli_read_file(folder, "status");
        const char *line = status ? strstr(status, "SigCgt:") : NULL;

        catches = line && strtoull(line + strlen("SigCgt:"), NULL, 16) >> (SIGINT - 1) & 1;
        free(status);
    }
    assert_true(catches);
}

/* Asserts that text is in err exactly once, before `later`. */
static void assert_told_before(const char *err, const char *text, const char *later)
{
    const char *first = strstr(err, text), *then = strstr(err, later);
    if (!first || strstr(first + 1, text) || !then || then < first)
        fail_msg("not once '%s' before '%s': %s", text, later, err);
}

/* An eye and a sensor in the plane of a wall: one warning each, before anything is rendered. A
 * sensor on the floor that faces up, and one in the wall's plane that faces away from it, cause
 * none. */
static void test_warnings_come_before_rendering(void **state)
{
    struct cli_desk *f = *state;
    const char *const plan[] = {"plan", f->document, NULL};
    cli_write_file(f->folder, "sensors.txt",
                   "1.5 1 0.8 0 0 1\n1.5 1 0 0 0 1\n0 1 0.8 1 0 0\n0 1 0.8 0 0 1\n0 2 0 0 0 1\n");
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]},\n"
                   " \"technique\": \"gather\", \"photons\": {\"global\": 2000, \"caustic\": 0},\n"
                   " \"gather_samples\": 64, \"sensors\": {\"file\": \"sensors.txt\"},\n"
                   " \"views\": [{\"name\": \"wall\", \"view\": \"-vtv -vp 3 2 1 -vd -1 0 0\","
                   " \"width\": 16, \"height\": 16}]}");
    run_job(f, f->output, "1");
    assert_int_equal(f->result.exit_code, 0);
    assert_told_before(f->result.err, "warning: view 'wall': the viewpoint lies on a surface",
                       "render");
    assert_told_before(f->result.err,
                       "warning: 2 of 5 sensors: the sensor lies in the plane of a surface; the "
                       "first, number 4 at (0, 1, 0.8), ",
                       "render");
    assert_non_null(strstr(f->result.err, " m from 'west' ("));
    cli_run(plan, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    assert_non_null(strstr(f->result.err, "2 of 5 sensors"));
}

static void test_an_interrupt_cancels(void **state)
{
    struct cli_desk *f = *state;
    const char *const args[] = {"run", f->document, "-o", f->output, NULL};
    struct cli_child child;
    json_t *result;

    /* Far more photons than are traced before the signal arrives. */
    cli_write_file(f->folder, "job.json",
                   "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]},\n"
                   " \"technique\": \"gather\",\n"
                   " \"photons\": {\"global\": 100000000, \"caustic\": 0},\n"
                   " \"sensors\": {\"file\": \"sensors.txt\"}}");
    child = cli_start(args);
    await_handler(&child);
    kill(child.pid, SIGINT);
    cli_finish(&child, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    result = load_result(f->output);
    assert_string_equal(text_of(result, "state"), "cancelled");
    json_decref(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_wrong_command_lines_exit_with_2, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_every_command_has_help, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_mistakes_are_named_and_recorded, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_an_older_result_does_not_survive_a_failure, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_run_leaves_numbers_images_and_maps, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_threads_change_no_byte, set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_warnings_come_before_rendering, set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_an_interrupt_cancels, set_up, cli_desk_tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
