/* Scheduling: the queue's order alone, and through a real daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "jobs/job_queue.h"
#include "support/storage.h"

enum { PHOTONS = 2000, MANY_PHOTONS = 100000000 };

/* ---- The queue alone ------------------------------------------------------------------------ */

struct waiting {
    struct orl_queue_entry entry;
    const char *name, *client;
};

static void add_waiting(struct orl_queue *queue, struct waiting *waiting, size_t count)
{
    struct orl_error err;
    for (size_t i = 0; i < count; i++) {
        waiting[i].entry.order = (int64_t)i;
        assert_int_equal(orl_queue_add(queue, &waiting[i].entry, waiting[i].client, &err), 0);
    }
}

/* Takes all items, and expects the names in that order; each position was predicted. */
static void expect_order(struct orl_queue *queue, struct waiting *waiting, size_t count,
                         const char *expected)
{
    char taken[128] = "", told[128];
    for (size_t place = 1; place <= count; place++)
        for (size_t i = 0; i < count; i++)
            if (orl_queue_position(queue, &waiting[i].entry) == place)
                strcat(taken, waiting[i].name);
    strcpy(told, taken);
    taken[0] = '\0';
    for (struct orl_queue_entry *entry; (entry = orl_queue_pop(queue));)
        strcat(taken, ((struct waiting *)entry)->name);
    assert_string_equal(taken, expected);
    assert_string_equal(told, expected);
}

static void test_clients_take_turns(void **state)
{
    (void)state;
    struct waiting waiting[] = {
        {{.priority = 5}, "a", "A"}, {{.priority = 5}, "b", "A"}, {{.priority = 5}, "c", "A"},
        {{.priority = 5}, "d", "B"}, {{.priority = 5}, "e", "C"}, {{.priority = 5}, "f", "C"},
    };
    struct orl_queue *queue = orl_queue_new();
    add_waiting(queue, waiting, 6);
    expect_order(queue, waiting, 6, "adebfc");
    /* C was served before A. */
    add_waiting(queue, waiting, 6);
    expect_order(queue, waiting, 6, "deafbc");
    orl_queue_free(queue);
}

static void test_priority_goes_before_turns(void **state)
{
    (void)state;
    struct waiting waiting[] = {
        {{.priority = 5}, "a", "A"},
        {{.priority = 0}, "b", "B"},
        {{.priority = 9}, "c", "A"},
        {{.priority = 9}, "d", "A"},
    };
    struct orl_queue *queue = orl_queue_new();
    add_waiting(queue, waiting, 4);
    expect_order(queue, waiting, 4, "cdab");
    orl_queue_free(queue);
}

static void test_removal(void **state)
{
    (void)state;
    struct waiting waiting[] = {
        {{.priority = 5}, "a", "A"}, {{.priority = 5}, "b", "A"}, {{.priority = 5}, "c", "B"}};
    struct orl_queue *queue = orl_queue_new();
    add_waiting(queue, waiting, 3);
    orl_queue_remove(queue, &waiting[0].entry);
    orl_queue_remove(queue, &waiting[0].entry);
    assert_int_equal(orl_queue_position(queue, &waiting[0].entry), 0);
    expect_order(queue, waiting, 3, "bc");
    orl_queue_free(queue);
}

/* A client that returns again and again does not overtake one that waits. */
static void test_coming_back_is_no_advantage(void **state)
{
    (void)state;
    struct waiting many[3] = {
        {{.priority = 5}, "a", "A"}, {{.priority = 5}, "b", "A"}, {{.priority = 5}, "c", "A"}};
    struct waiting single = {{.priority = 5, .order = 10}, "z", "B"};
    struct orl_error err;
    char taken[16] = "";
    struct orl_queue *queue = orl_queue_new();
    add_waiting(queue, many, 3);
    for (int i = 0; i < 6; i++) {
        if (!single.entry.client)
            orl_queue_add(queue, &single.entry, single.client, &err);
        strcat(taken, ((struct waiting *)orl_queue_pop(queue))->name);
    }
    assert_string_equal(taken, "azbzcz");
    orl_queue_free(queue);
}

/* Thousands of clients with one job each leave almost no memory in use, and all are served. */
static void test_many_clients(void **state)
{
    (void)state;
    struct orl_queue *queue = orl_queue_new();
    for (int i = 0; i < 5000; i++) {
        struct orl_queue_entry entry = {.priority = i % 10};
        struct orl_error err;
        char name[32];
        snprintf(name, sizeof name, "client %d", i);
        assert_int_equal(orl_queue_add(queue, &entry, name, &err), 0);
        assert_ptr_equal(orl_queue_pop(queue), &entry);
    }
    assert_null(orl_queue_pop(queue));
    orl_queue_free(queue);
}

/* ---- Through the daemon --------------------------------------------------------------------- */

static void post(struct daemon_room *f, int seed, const char *more, const char *header,
                 struct reply *ret_reply)
{
    char text[512];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"seed\":%d,\"technique\":\"gather\",\"photons\":{\"global\":%d,"
             "\"caustic\":0},\"gather_samples\":16,\"sensors\":[[2,1,0.8,0,0,1]]%s}",
             f->scene, seed, PHOTONS, more);
    daemon_request(&f->daemon, "POST", "/v1/jobs", "application/json", text, strlen(text), header,
                   ret_reply);
}

static void submit(struct daemon_room *f, int seed, const char *more, const char *header,
                   char ret_path[80])
{
    struct reply reply;
    post(f, seed, more, header, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

/* Expects the jobs in the order of their positions. */
static void expect_positions(struct daemon_room *f, char (*jobs)[80], size_t count,
                             const int *expected)
{
    for (size_t i = 0; i < count; i++) {
        struct reply reply;
        daemon_get(&f->daemon, jobs[i], &reply);
        if (reply_number(&reply, "queue_position") != expected[i])
            fail_msg("not at %d: %s", expected[i], reply.body);
        reply_done(&reply);
    }
}

/* Two clients, one with an urgent job; after a restart they run in the predicted order. */
static void test_order_of_jobs(void **state)
{
    static const char rhino[] = "X-Oriel-Client: rhino", qgis[] = "X-Oriel-Client: qgis";
    static const int expected[] = {2, 4, 5, 3, 1};
    struct daemon_room *f = *state;
    struct reply reply;
    char blocker[80], jobs[5][80], started[5][40];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 1, NULL, blocker);
    daemon_wait_running(&f->daemon, blocker, -1);
    submit(f, 2, "", rhino, jobs[0]);
    submit(f, 3, "", rhino, jobs[1]);
    submit(f, 4, "", rhino, jobs[2]);
    submit(f, 5, "", qgis, jobs[3]);
    submit(f, 6, ",\"priority\":9", NULL, jobs[4]);
    expect_positions(f, jobs, 5, expected);
    daemon_get(&f->daemon, jobs[3], &reply);
    assert_string_equal(reply_text(&reply, "client"), "name:qgis");
    assert_true(reply_number(&reply, "priority") == 5);
    reply_done(&reply);
    daemon_get(&f->daemon, jobs[4], &reply);
    assert_string_equal(reply_text(&reply, "client"), "address:127.0.0.1");
    assert_true(reply_number(&reply, "priority") == 9);
    reply_done(&reply);

    daemon_cancel(&f->daemon, blocker, &reply);
    reply_done(&reply);
    for (int i = 0; i < 5; i++) {
        daemon_wait(&f->daemon, jobs[i], 60, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        snprintf(started[i], sizeof started[i], "%s", reply_text(&reply, "started"));
        reply_done(&reply);
    }
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 5; k++)
            assert_true(expected[i] >= expected[k] || strcmp(started[i], started[k]) < 0);
}

/* Priorities and clients survive a kill. */
static void test_order_survives(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char blocker[80], jobs[2][80];
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 1, NULL, blocker);
    daemon_wait_running(&f->daemon, blocker, -1);
    submit(f, 7, ",\"priority\":6", NULL, jobs[0]);
    submit(f, 8, ",\"priority\":7", NULL, jobs[1]);
    daemon_end(&f->daemon, SIGKILL);
    daemon_restart(&f->daemon, NULL);
    for (int i = 0; i < 2; i++) {
        daemon_wait(&f->daemon, jobs[i], 60, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        assert_true(reply_number(&reply, "priority") == 6 + i);
        reply_done(&reply);
    }
    daemon_cancel(&f->daemon, blocker, &reply);
    assert_int_equal(reply.status / 100, 2);
    reply_done(&reply);
}

/* ---- Repeated requests ---------------------------------------------------------------------- */

static void expect_again(struct daemon_room *f, const char *header, const char *id)
{
    struct reply reply;
    post(f, 20, "", header, &reply);
    assert_int_equal(reply.status, 202);
    assert_string_equal(reply_text(&reply, "id"), id);
    reply_done(&reply);
}

static void test_idempotency_key(void **state)
{
    static const char first[] = "Idempotency-Key: \"7b6c\"", bare[] = "Idempotency-Key: 7b6c";
    struct daemon_room *f = *state;
    struct reply reply;
    char id[64], job[80];
    post(f, 20, "", first, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    snprintf(job, sizeof job, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
    expect_again(f, first, id);
    expect_again(f, bare, id);
    post(f, 21, "", first, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:idempotency-key");
    reply_done(&reply);
    /* Without the key, with another key, or from another client it is a different job. */
    static const char *const others[] = {NULL, "Idempotency-Key: 7b6d",
                                         "X-Oriel-Client: x\r\nIdempotency-Key: 7b6c"};
    for (int i = 0; i < 3; i++) {
        post(f, 20, "", others[i], &reply);
        assert_int_equal(reply.status, 202);
        assert_string_not_equal(reply_text(&reply, "id"), id);
        reply_done(&reply);
    }
    daemon_wait(&f->daemon, job, 60, &reply);
    reply_done(&reply);
    daemon_end(&f->daemon, SIGKILL);
    daemon_restart(&f->daemon, NULL);
    expect_again(f, first, id);
}

/* Moves all jobs into the past, in place of waiting. */
static void test_keys_last_a_day(void **state)
{
    static const char key[] = "Idempotency-Key: of a day";
    struct daemon_room *f = *state;
    struct reply reply;
    char id[64];
    post(f, 20, "", key, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(id, sizeof id, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    storage_run_sql(&f->daemon, "UPDATE jobs SET created_ms = created_ms - 23 * 3600000");
    expect_again(f, key, id);
    storage_run_sql(&f->daemon, "UPDATE jobs SET created_ms = created_ms - 2 * 3600000");
    post(f, 20, "", key, &reply);
    assert_int_equal(reply.status, 202);
    assert_string_not_equal(reply_text(&reply, "id"), id);
    reply_done(&reply);
}

static void test_bad_keys(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char header[320];
    snprintf(header, sizeof header, "Idempotency-Key: %0256d", 1);
    post(f, 20, "", header, &reply);
    assert_int_equal(reply.status, 400);
    reply_done(&reply);
    post(f, 20, "", "Idempotency-Key: \"\"", &reply);
    assert_int_equal(reply.status, 400);
    reply_done(&reply);
    /* A refused document does not use up its key. */
    post(f, 20, ",\"x\":1", "Idempotency-Key: mended", &reply);
    assert_int_equal(reply.status, 422);
    reply_done(&reply);
    post(f, 20, "", "Idempotency-Key: mended", &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
}

static void test_refusals(void **state)
{
    static const char *const bad[] = {",\"priority\":10", ",\"priority\":-1", ",\"priority\":1.5",
                                      ",\"priority\":\"high\"", ",\"priority\":null"};
    struct daemon_room *f = *state;
    struct reply reply;
    char header[128];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        post(f, 1, bad[i], NULL, &reply);
        assert_int_equal(reply.status, 422);
        assert_string_equal(reply_text(&reply, "primitive"), "priority");
        reply_done(&reply);
    }
    snprintf(header, sizeof header, "X-Oriel-Client: %065d", 1);
    post(f, 1, "", header, &reply);
    assert_int_equal(reply.status, 400);
    reply_done(&reply);
}

int main(void)
{
    const struct CMUnitTest alone[] = {
        cmocka_unit_test(test_clients_take_turns),
        cmocka_unit_test(test_priority_goes_before_turns),
        cmocka_unit_test(test_removal),
        cmocka_unit_test(test_coming_back_is_no_advantage),
        cmocka_unit_test(test_many_clients),
    };
    const struct CMUnitTest served[] = {
        cmocka_unit_test(test_order_of_jobs),   cmocka_unit_test(test_order_survives),
        cmocka_unit_test(test_refusals),        cmocka_unit_test(test_idempotency_key),
        cmocka_unit_test(test_keys_last_a_day), cmocka_unit_test(test_bad_keys),
    };
    const int failed = cmocka_run_group_tests(alone, NULL, NULL);
    return failed + cmocka_run_group_tests(served, daemon_room_set_up, daemon_room_tear_down);
}
