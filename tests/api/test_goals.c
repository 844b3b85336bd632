/* Jobs with an accuracy or a deadline, through a real daemon: intermediate and final results. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "support/cli.h"
#include "support/daemon.h"
#include "support/patience.h"

#define SENSORS "\"technique\":\"backward\",\"sensors\":[[2,1,0.8,0,0,1],[2,4,0.8,0,0,1]]"
#define VIEW                                                                                       \
    ",\"views\":[{\"name\":\"room\",\"view\":\"-vtv -vp 2 4 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 "      \
    "-vv 45\",\"width\":8,\"height\":6}]"
/* Takes minutes in many rounds; the test cancels it. */
#define LONG SENSORS VIEW ",\"accuracy\":{\"deadline_s\":600}"

static void post(struct daemon_room *f, const char *rest, struct reply *ret_reply)
{
    char text[2048];
    snprintf(text, sizeof text, "{\"scene\":\"%s\",%s}", f->scene, rest);
    daemon_post_json(&f->daemon, "/v1/jobs", text, ret_reply);
}

static void submit(struct daemon_room *f, const char *rest, char ret_path[80])
{
    struct reply reply;
    post(f, rest, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void get_below(struct daemon_room *f, const char *job, const char *what,
                      struct reply *ret_reply)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", job, what);
    daemon_get(&f->daemon, path, ret_reply);
}

/* Waits until a round is done, and its results are available. */
static void wait_for_round(struct daemon_room *f, const char *job)
{
    for (double until = patience_now_s() + 300; patience_nap(until);) {
        struct reply reply;
        daemon_get(&f->daemon, job, &reply);
        const bool there = reply_at(&reply, "links.result") != NULL;
        if (there) {
            assert_string_equal(reply_text(&reply, "state"), "running");
            assert_true(reply_number(&reply, "accuracy.rounds") >= 1);
            assert_true(reply_number(&reply, "accuracy.achieved") > 0);
            assert_true(reply_number(&reply, "accuracy.asked.deadline_s") == 600);
            assert_true(reply_number(&reply, "percent") < 100);
            assert_true(reply_at(&reply, "links.files.4") != NULL);
        }
        reply_done(&reply);
        if (there)
            return;
    }
    fail_msg("no round in five minutes");
}

static void cancel(struct daemon_room *f, const char *job)
{
    struct reply reply;
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
}

/* Intermediate results of a running job can be fetched, and are removed with the job. */
static void test_results_before_the_end(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    submit(f, LONG, job);
    wait_for_round(f, job);
    get_below(f, job, "result", &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "state"), "running");
    assert_true(reply_number(&reply, "sensors.0.illuminance_lx") > 0);
    assert_true(reply_number(&reply, "sensors.1.standard_error_lx") > 0);
    assert_true(reply_number(&reply, "accuracy.rounds") >= 1);
    assert_true(reply_number(&reply, "cost.next.halve_s") > 0);
    assert_string_equal(reply_header(&reply, "Cache-Control"), "no-store");
    assert_null(reply_header(&reply, "ETag"));
    reply_done(&reply);
    get_below(f, job, "files/room.hdr", &reply);
    assert_int_equal(reply.status, 200);
    assert_memory_equal(reply.body, "#?RADIANCE", 10);
    reply_done(&reply);
    get_below(f, job, "files/other.hdr", &reply);
    assert_int_equal(reply.status, 404);
    reply_done(&reply);
    cancel(f, job);
    get_below(f, job, "result", &reply);
    assert_int_equal(reply.status, 409);
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "tmp");
}

/* A cancelled job's files are removed a moment before its state changes. */
static void test_files_that_go_with_the_job(void **state)
{
    static const char *const files[] = {"result", "files/room.hdr"};
    struct daemon_room *f = *state;
    char job[80], folder[80];
    submit(f, LONG, job);
    wait_for_round(f, job);
    snprintf(folder, sizeof folder, "%s/partial", f->daemon.root);
    cli_remove_folder(folder);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct reply reply;
        get_below(f, job, files[i], &reply);
        assert_int_equal(reply.status, 409);
        assert_non_null(reply_header(&reply, "Retry-After"));
        reply_done(&reply);
    }
}

/* A killed daemon starts the job again from its first round. */
static void test_killed_between_rounds(void **state)
{
    struct daemon_room *f = *state;
    char job[80];
    submit(f, LONG, job);
    wait_for_round(f, job);
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);
    daemon_restart(&f->daemon, NULL);
    wait_for_round(f, job);
    cancel(f, job);
}

/* Expects one point per round, few here, in order of time; the last is the job's final error. */
static void expect_course(struct reply *reply)
{
    const json_t *course = reply_at(reply, "accuracy.course"), *point;
    const double total_s = reply_number(reply, "timings_s.total");
    double before_s = 0, error = 0;
    size_t i;
    assert_int_equal(json_array_size(course), (size_t)reply_number(reply, "accuracy.rounds"));
    json_array_foreach(course, i, point)
    {
        const double seconds = json_number_value(json_object_get(point, "seconds"));
        error = json_number_value(json_object_get(point, "error"));
        assert_true(seconds > before_s && seconds <= total_s && error > 0);
        before_s = seconds;
    }
    assert_true(i >= 1 && error == reply_number(reply, "accuracy.achieved"));
}

static void test_accuracy_is_met(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80];
    submit(f, SENSORS ",\"accuracy\":{\"relative_error\":0.1,\"at\":0.5}", job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_true(json_is_true(reply_at(&reply, "accuracy.met")));
    expect_course(&reply);
    assert_true(reply_number(&reply, "accuracy.achieved") <= 0.1);
    reply_done(&reply);
    get_below(f, job, "result", &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_true(reply_number(&reply, "accuracy.asked.relative_error") == 0.1);
    assert_true(reply_number(&reply, "accuracy.asked.at") == 0.5);
    assert_non_null(reply_header(&reply, "ETag"));
    reply_done(&reply);
}

static void test_refusals(void **state)
{
    static const struct {
        const char *goal, *told;
    } cases[] = {
        {"{}", "one of \"relative_error\", \"dgp_error\" and \"deadline_s\""},
        {"{\"relative_error\":0.1,\"deadline_s\":3}", "one of \"relative_error\""},
        {"{\"relative_error\":0}", "accuracy.relative_error"},
        {"{\"dgp_error\":2}", "accuracy.dgp_error"},
        {"{\"dgp_error\":0.01}", "no view asks for metrics"},
        {"{\"deadline_s\":-1}", "accuracy.deadline_s"},
        {"{\"deadline_s\":3,\"at\":1.5}", "accuracy.at"},
        {"{\"relative_error\":0.1,\"by\":3}", "by"},
        {"{\"relative_error\":0.1},\"gather_samples\":64", "gather_samples"},
        {"{\"relative_error\":0.1},\"photons\":{\"global\":1000}", "photons"},
    };
    struct daemon_room *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct reply reply;
        char rest[512];
        snprintf(rest, sizeof rest, SENSORS ",\"accuracy\":%s", cases[i].goal);
        post(f, rest, &reply);
        assert_int_equal(reply.status / 100, 4);
        if (!strstr(reply_text(&reply, "detail"), cases[i].told))
            fail_msg("%s: %s", cases[i].goal, reply.body);
        reply_done(&reply);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_results_before_the_end, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_files_that_go_with_the_job, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_killed_between_rounds, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_accuracy_is_met, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_refusals, daemon_room_set_up, daemon_room_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
