/* Identical jobs share one computation, and nothing else. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/daemon.h"

enum { PHOTONS = 20000, MANY_PHOTONS = 100000000 };

static void expect_state(struct daemon_room *f, const char *job, const char *state, int attempts)
{
    struct reply reply;
    daemon_wait(&f->daemon, job, 60, &reply);
    if (strcmp(reply_text(&reply, "state"), state) != 0 ||
        reply_number(&reply, "attempts") != attempts)
        fail_msg("%s: %s", job, reply.body);
    reply_done(&reply);
}

static void cancel(struct daemon_room *f, const char *job)
{
    struct reply reply;
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status / 100, 2);
    reply_done(&reply);
}

static void submit_text(struct daemon_room *f, const char *format, char ret_path[80])
{
    char text[512];
    struct reply reply;
    snprintf(text, sizeof text, "{%s,\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]]}", format,
             f->scene);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    if (reply.status != 202)
        fail_msg("refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

static void expect_same_result(struct daemon_room *f, const char *one, const char *other)
{
    struct reply replies[2];
    for (int i = 0; i < 2; i++) {
        char path[128];
        snprintf(path, sizeof path, "%s/result", i ? other : one);
        daemon_get(&f->daemon, path, &replies[i]);
        assert_int_equal(replies[i].status, 200);
    }
    assert_string_equal(replies[0].body, replies[1].body);
    for (int i = 0; i < 2; i++)
        reply_done(&replies[i]);
}

static bool is_shared(struct daemon_room *f, const char *job)
{
    struct reply reply;
    daemon_get(&f->daemon, job, &reply);
    const bool shared = json_is_true(reply_at(&reply, "shared"));
    assert_string_equal(reply_text(&reply, "state"), "running");
    reply_done(&reply);
    return shared;
}

/* Members in another order and another priority still share; another seed does not. */
static void test_one_computation(void **state)
{
    struct daemon_room *f = *state;
    char blocker[80], jobs[3][80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 1, NULL, blocker);
    daemon_wait_running(&f->daemon, blocker, -1);
    submit_text(f, "\"technique\":\"gather\",\"seed\":2,\"priority\":3", jobs[0]);
    submit_text(f, "\"technique\":\"gather\",\"seed\":3,\"priority\":4", jobs[1]);
    submit_text(f, "\"priority\":9,\"seed\":2,\"technique\":\"gather\"", jobs[2]);
    static const int expected[] = {1, 2, 1};
    for (int i = 0; i < 3; i++) {
        daemon_get(&f->daemon, jobs[i], &reply);
        assert_true(reply_number(&reply, "queue_position") == expected[i]);
        reply_done(&reply);
    }
    cancel(f, blocker);
    cancel(f, jobs[1]);
    expect_state(f, jobs[0], "succeeded", 1);
    expect_state(f, jobs[2], "succeeded", 1);
    expect_same_result(f, jobs[0], jobs[2]);
    daemon_get(&f->daemon, "/v1/maps", &reply);
    assert_true(reply_number(&reply, "maps.0.hits") == 0);
    reply_done(&reply);
}

/* One of two is cancelled while both run: the other continues; cancelling it ends the work. */
static void test_cancelling(void **state)
{
    struct daemon_room *f = *state;
    char jobs[3][80];
    for (int first = 0; first < 2; first++) {
        for (int i = 0; i < 2; i++)
            daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 4, NULL, jobs[i]);
        daemon_wait_running(&f->daemon, jobs[1], 0);
        assert_true(is_shared(f, jobs[0]) && is_shared(f, jobs[1]));
        cancel(f, jobs[first]);
        expect_state(f, jobs[first], "cancelled", 1);
        daemon_wait_running(&f->daemon, jobs[1 - first], 0);
        cancel(f, jobs[1 - first]);
        expect_state(f, jobs[1 - first], "cancelled", 1);
        daemon_submit(&f->daemon, f->scene, PHOTONS, 4, NULL, jobs[2]);
        expect_state(f, jobs[2], "succeeded", 1);
    }
}

/* The first is cancelled; the second gets the results. */
static void test_leader_is_cancelled(void **state)
{
    static const char text[] = "\"technique\":\"backward\",\"accuracy\":{\"deadline_s\":2}";
    struct daemon_room *f = *state;
    char leader[80], follower[80], path[128];
    struct reply reply;
    submit_text(f, text, leader);
    submit_text(f, text, follower);
    daemon_wait_running(&f->daemon, follower, -1);
    cancel(f, leader);
    expect_state(f, leader, "cancelled", 1);
    expect_state(f, follower, "succeeded", 1);
    snprintf(path, sizeof path, "%s/result", follower);
    daemon_get(&f->daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_true(reply_number(&reply, "sensors.0.illuminance_lx") > 0);
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/results/%s", f->daemon.root, strrchr(leader, '/') + 1);
    assert_true(access(path, F_OK) != 0);
    daemon_expect_no_files(&f->daemon, "tmp");
}

/* The job that leads others is cancelled while it waits. */
static void test_waiting_leader_is_cancelled(void **state)
{
    struct daemon_room *f = *state;
    char blocker[80], jobs[3][80];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 1, NULL, blocker);
    daemon_wait_running(&f->daemon, blocker, -1);
    for (int i = 0; i < 3; i++)
        daemon_submit(&f->daemon, f->scene, PHOTONS, 6, NULL, jobs[i]);
    cancel(f, jobs[0]);
    cancel(f, blocker);
    expect_state(f, jobs[0], "cancelled", 0);
    expect_state(f, jobs[1], "succeeded", 1);
    expect_state(f, jobs[2], "succeeded", 1);
    expect_same_result(f, jobs[1], jobs[2]);
}

/* After a stop and a crash both exist again, and share again. */
static void test_restarts(void **state)
{
    struct daemon_room *f = *state;
    char jobs[2][80];
    for (int i = 0; i < 2; i++)
        daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 7, NULL, jobs[i]);
    for (int round = 0; round < 2; round++) {
        daemon_wait_running(&f->daemon, jobs[0], -1);
        assert_int_equal(daemon_end(&f->daemon, round ? SIGKILL : SIGTERM), round ? -1 : 0);
        daemon_restart(&f->daemon, NULL);
    }
    daemon_wait_running(&f->daemon, jobs[0], -1);
    assert_true(is_shared(f, jobs[1]));
    for (int i = 0; i < 2; i++)
        cancel(f, jobs[i]);
    for (int i = 0; i < 2; i++)
        expect_state(f, jobs[i], "cancelled", 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_computation),
        cmocka_unit_test(test_cancelling),
        cmocka_unit_test(test_leader_is_cancelled),
        cmocka_unit_test(test_waiting_leader_is_cancelled),
        cmocka_unit_test(test_restarts),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}
