/* Warnings and darkness errors reach every client: the job's document, its events, `oriel submit
 * --wait`. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/daemon.h"

/* One sensor is inside a ball, without light; the other above the roof. */
#define WITHIN "[20,20,1,0,0,1]"
#define ABOVE "[2,2,50,0,0,1]"
static const char dark_sensor[] = "1 of 2 sensors is at 0 lx, the first is sensors[1]";

static int set_up(void **state)
{
    static const char ball[] = "void plastic red\n0\n0\n5 .5 .1 .1 0 0\n"
                               "red sphere ball\n0\n0\n4 20 20 1 .5\n";
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"sky.rad", room_sky, strlen(room_sky), false},
                                        {"ball.rad", ball, strlen(ball), false}};
    struct reply reply;
    if (daemon_room_set_up(state))
        return -1;
    struct daemon_room *f = *state;
    daemon_upload(&f->daemon, files, 3, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(f->scene, sizeof f->scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    return 0;
}

static void post(struct daemon_room *f, const char *sensors, const char *more, char ret_path[80])
{
    char text[512];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"gather\",\"gather_samples\":64,\"photons\":"
             "{\"global\":2000,\"caustic\":0},\"sensors\":[%s]%s}",
             f->scene, sensors, more);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void test_in_the_document(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], events[96];
    post(f, ABOVE "," WITHIN, "", job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_non_null(strstr(reply.body, dark_sensor));
    assert_true(json_array_size(reply_at(&reply, "warnings")) >= 1);
    reply_done(&reply);
    snprintf(events, sizeof events, "%s/events", job);
    daemon_get(&f->daemon, events, &reply);
    assert_int_equal(reply.status, 200);
    assert_non_null(strstr(reply.body, dark_sensor));
    reply_done(&reply);
}

/* Sensors are numbered, in the document and in the events. */
static void test_misplaced_sensors(void **state)
{
    static const char wanted[] = "1 of 4 sensors lies in closed spaces without windows, such as "
                                 "a solid or a wall, and the others do not: number 3 (from 1)";
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], events[96];
    post(f, ABOVE "," ABOVE "," WITHIN "," ABOVE, "", job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_non_null(strstr(reply.body, wanted));
    reply_done(&reply);
    snprintf(events, sizeof events, "%s/events", job);
    daemon_get(&f->daemon, events, &reply);
    assert_non_null(strstr(reply.body, wanted));
    reply_done(&reply);
}

static void test_all_dark(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    post(f, WITHIN, "", job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "failed");
    assert_string_equal(reply_text(&reply, "error.type"), "urn:oriel:error:unlit");
    reply_done(&reply);
    post(f, WITHIN, ",\"dark\":\"expected\"", job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

/* The command prints each warning once, although every polled document contains it. */
static void test_on_the_command_line(void **state)
{
    static const char job[] = "{\"scene\":\"%s\",\"technique\":\"gather\",\"gather_samples\":64,"
                              "\"photons\":{\"global\":2000,\"caustic\":0},\"sensors\":[%s]}";
    struct daemon_room *f = *state;
    struct cli_result result = {0};
    char folder[64], text[512], path[96];
    const char *const args[] = {"submit", "--server", f->daemon.url, path, "--wait", NULL};
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/job.json", folder);
    snprintf(text, sizeof text, job, f->scene, ABOVE "," WITHIN);
    cli_write_file(folder, "job.json", text);
    cli_run(args, &result);
    assert_int_equal(result.exit_code, 0);
    const char *first = strstr(result.err, dark_sensor);
    assert_non_null(first);
    assert_null(strstr(first + 1, dark_sensor));
    snprintf(text, sizeof text, job, f->scene, WITHIN);
    cli_write_file(folder, "job.json", text);
    cli_run(args, &result);
    assert_int_equal(result.exit_code, 1);
    assert_non_null(strstr(result.err, "the only sensor is at 0 lx"));
    cli_remove_folder(folder);
}

static void test_types_are_told(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    daemon_request(&f->daemon, "POST", "/v1/scenes", "text/plain", "x", 1, NULL, &reply);
    assert_int_equal(reply.status, 415);
    assert_non_null(strstr(reply.body, "application/zip"));
    reply_done(&reply);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_in_the_document), cmocka_unit_test(test_misplaced_sensors),
        cmocka_unit_test(test_all_dark),        cmocka_unit_test(test_on_the_command_line),
        cmocka_unit_test(test_types_are_told),
    };
    return cmocka_run_group_tests(tests, set_up, daemon_room_tear_down);
}
