/* `oriel` and `orield` together: submit, wait, fetch, and a second job that reuses the maps. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include "support/cli.h"
#include "support/patience.h"

/* A room that is open to the south, where another file adds the pane. */
static const char scene_text[] = "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\n"
                                 "void glass pane\n0\n0\n3 0.96 0.96 0.96\n"
                                 "void glow sky_glow\n0\n0\n4 10 10 10 0\n"
                                 "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                                 "grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0\n"
                                 "grey polygon top\n0\n0\n12 0 0 3  0 4 3  3 4 3  3 0 3\n"
                                 "grey polygon west\n0\n0\n12 0 0 0  0 4 0  0 4 3  0 0 3\n"
                                 "grey polygon east\n0\n0\n12 3 0 0  3 0 3  3 4 3  3 4 0\n"
                                 "grey polygon north\n0\n0\n12 0 4 0  3 4 0  3 4 3  0 4 3\n"
                                 "!xform -t 0 0 0 window.rad\n";
static const char window_text[] = "pane polygon window\n0\n0\n12 3 0 0  0 0 0  0 0 3  3 0 3\n";

#define JOB(seed, what)                                                                            \
    "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]}, \"seed\": " seed               \
    ", \"technique\": \"gather\", \"photons\": {\"global\": 20000, \"caustic\": 1000}, "           \
    "\"gather_samples\": 64, " what "}"
#define SENSORS "\"sensors\": {\"file\": \"sensors.txt\"}"
#define VIEWS                                                                                      \
    "\"views\": [{\"name\": \"north\", \"view\": \"-vtv -vp 1.5 0.5 1.5 -vd 0 1 0\","              \
    " \"width\": 16, \"height\": 12}]"

struct fixture {
    struct cli_child daemon;
    char url[128], folder[64];
    struct cli_result result;
};

static void wait_until_listening(struct fixture *f)
{
    char *text = malloc(CLI_OUTPUT_MAX);

    for (double until = patience_until();;) {
        cli_peek(&f->daemon, text);
        if (sscanf(text, "listening on %100s", f->url) == 1 && strchr(text, '\n'))
            break;
        if (!patience_nap(until))
            break;
    }
    free(text);
    assert_true(strncmp(f->url, "http://127.0.0.1:", 17) == 0);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    char data[96];
    const char *const args[] = {"--port", "0", "--data", data, "--threads", "2", NULL};

    cli_make_folder(f->folder);
    snprintf(data, sizeof data, "%s/data", f->folder);
    cli_write_file(f->folder, "room.rad", scene_text);
    cli_write_file(f->folder, "window.rad", window_text);
    cli_write_file(f->folder, "sensors.txt", "1.5 1 0.8 0 0 1\n1.5 3 0.8 0 0 1\n");
    cli_write_file(f->folder, "sensors.json", JOB("1", SENSORS));
    cli_write_file(f->folder, "views.json", JOB("1", VIEWS));
    cli_write_file(f->folder, "both.json", JOB("1", SENSORS ", " VIEWS));
    f->daemon = cli_start_program("orield", args);
    wait_until_listening(f);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;

    kill(f->daemon.pid, SIGTERM);
    cli_finish(&f->daemon, &f->result);
    cli_remove_folder(f->folder);
    free(f);
    return 0;
}

static void run_oriel(struct fixture *f, int exit_code, const char *command, const char *operand,
                      const char *option, const char *value)
{
    const char *args[8] = {command, "--server", f->url};
    int n = 3;

    if (operand)
        args[n++] = operand;
    if (option)
        args[n++] = option;
    if (value)
        args[n++] = value;
    cli_run(args, &f->result);
    if (f->result.exit_code != exit_code)
        fail_msg("oriel %s: exit %d, not %d:\n%s", command, f->result.exit_code, exit_code,
                 f->result.err);
}

/* Submits a document of the folder and follows it; returns its id in ret_id[64]. */
static void submit(struct fixture *f, const char *document, int exit_code, char *ret_id)
{
    char path[160];

    snprintf(path, sizeof path, "%s/%s", f->folder, document);
    run_oriel(f, exit_code, "submit", path, "--wait", NULL);
    assert_int_equal(sscanf(f->result.out, "%63s", ret_id), 1);
}

static void assert_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

static json_t *fetch_sensors(struct fixture *f, const char *id)
{
    char output[160], *text;
    json_t *result, *sensors;

    snprintf(output, sizeof output, "%s/%s", f->folder, id);
    run_oriel(f, 0, "fetch", id, "-o", output);
    text = cli_read_file(output, "result.json");
    assert_non_null(text);
    result = json_loads(text, 0, NULL);
    free(text);
    sensors = json_incref(json_object_get(result, "sensors"));
    json_decref(result);
    return sensors;
}

static void test_a_second_job_finds_the_maps(void **state)
{
    struct fixture *f = *state;
    char first[64], second[64], output[160], *hdr;

    submit(f, "sensors.json", 0, first);
    assert_says(f->result.err, "uploaded");
    assert_says(f->result.err, "global map: built in");
    assert_says(f->result.err, "succeeded");
    submit(f, "views.json", 0, second);
    assert_says(f->result.err, "already known");
    assert_says(f->result.err, "global map: found in the cache");
    assert_null(strstr(f->result.err, "built in"));
    run_oriel(f, 0, "maps", NULL, NULL, NULL);
    assert_says(f->result.out, "global");
    run_oriel(f, 0, "status", second, NULL, NULL);
    assert_says(f->result.out, "succeeded");
    run_oriel(f, 0, "status", NULL, NULL, NULL);
    first[8] = second[8] = '\0'; /* as many digits as the table shows, enough for fetch */
    assert_says(f->result.out, first);
    assert_says(f->result.out, second);
    snprintf(output, sizeof output, "%s/out", f->folder);
    run_oriel(f, 0, "fetch", second, "-o", output);
    hdr = cli_read_file(output, "north.hdr");
    assert_non_null(hdr);
    assert_memory_equal(hdr, "#?RADIANCE\n", 11);
    free(hdr);
    hdr = cli_read_file(output, "north.error.hdr");
    assert_non_null(hdr);
    assert_memory_equal(hdr, "#?RADIANCE\n", 11);
    free(hdr);
}

/* A document gives equal numbers in the command and in the daemon: one code path. */
static void test_run_and_submit_agree(void **state)
{
    struct fixture *f = *state;
    char id[64], path[160], output[160], *text;
    const char *const args[] = {"run", path, "-o", output, "--threads", "1", NULL};
    json_t *remote, *local;

    submit(f, "both.json", 0, id);
    remote = fetch_sensors(f, id);
    snprintf(path, sizeof path, "%s/both.json", f->folder);
    snprintf(output, sizeof output, "%s/local", f->folder);
    cli_run(args, &f->result);
    assert_int_equal(f->result.exit_code, 0);
    text = cli_read_file(output, "result.json");
    assert_non_null(text);
    local = json_loads(text, 0, NULL);
    free(text);
    assert_int_equal(json_array_size(remote), 2);
    for (size_t i = 0; i < 2; i++) {
        const json_t *here = json_array_get(json_object_get(local, "sensors"), i);
        const json_t *there = json_array_get(remote, i);

        assert_true(json_number_value(json_object_get(here, "illuminance_lx")) > 0);
        assert_true(json_equal(here, there));
    }
    json_decref(local);
    json_decref(remote);
}

static void test_cancel_ends_a_long_job(void **state)
{
    struct fixture *f = *state;
    char path[160], id[64];

    cli_write_file(f->folder, "long.json",
                   "{\"kind\": \"render\", \"scene\": {\"files\": [\"room.rad\"]},"
                   " \"technique\": \"gather\", \"photons\":"
                   " {\"global\": 100000000, \"caustic\": 0}, " SENSORS "}");
    snprintf(path, sizeof path, "%s/long.json", f->folder);
    run_oriel(f, 0, "submit", path, NULL, NULL);
    assert_int_equal(sscanf(f->result.out, "%63s", id), 1);
    run_oriel(f, 1, "fetch", id, "-o", f->folder);
    run_oriel(f, 0, "cancel", id, NULL, NULL);
    run_oriel(f, 1, "wait", id, NULL, NULL);
    assert_says(f->result.err, "cancelled");
}

/* Scheduling uses client names: the user's, or a chosen one. */
static void test_clients_have_names(void **state)
{
    struct fixture *f = *state;
    char id[64];

    assert_int_equal(setenv("ORIEL_CLIENT", "studio", 1), 0);
    submit(f, "sensors.json", 0, id);
    unsetenv("ORIEL_CLIENT");
    run_oriel(f, 0, "status", id, NULL, NULL);
    assert_says(f->result.out, "name:studio");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_a_second_job_finds_the_maps),
        TEST(test_run_and_submit_agree),
        TEST(test_cancel_ends_a_long_job),
        TEST(test_clients_have_names),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
