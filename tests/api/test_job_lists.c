/* Names and look-up of jobs: names, tags, prefixes of ids, lists. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "process/times.h"
#include "support/daemon.h"

/* Submits a job of the scene with those additional members; expects that status. */
static void submit(struct daemon_room *room, const char *members, int seed, long wanted,
                   struct reply *ret_reply)
{
    char text[9000];
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"backward\",\"gather_samples\":4,\"seed\":%d,"
             "\"sensors\":[[2,1,0.8,0,0,1]]%s%s}",
             room->scene, seed, *members ? "," : "", members);
    daemon_post_json(&room->daemon, "/v1/jobs", text, ret_reply);
    if (ret_reply->status != wanted)
        fail_msg("%.300s: %ld: %s", members, ret_reply->status, ret_reply->body);
}

static void submitted(struct daemon_room *room, const char *members, int seed, char ret_path[80])
{
    struct reply reply;
    submit(room, members, seed, 202, &reply);
    snprintf(ret_path, 80, "%s", reply_header(&reply, "Location"));
    reply_done(&reply);
    daemon_wait(&room->daemon, ret_path, 30, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
}

static void test_names_and_tags_stay(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char path[80], bare[80];
    submitted(room, "\"name\":\"B\xc3\xbcro \\\"2\\\" <b>\",\"tags\":[\"client x\",\"v1\"]", 1,
              path);
    submitted(room, "", 2, bare);
    for (int round = 0; round < 2; round++) {
        daemon_get(&room->daemon, path, &reply);
        assert_string_equal(reply_text(&reply, "name"), "B\xc3\xbcro \"2\" <b>");
        assert_int_equal(json_array_size(reply_at(&reply, "tags")), 2);
        assert_string_equal(reply_text(&reply, "tags.0"), "client x");
        assert_string_equal(reply_text(&reply, "tags.1"), "v1");
        reply_done(&reply);
        daemon_get(&room->daemon, bare, &reply);
        assert_true(json_is_null(reply_at(&reply, "name")));
        assert_int_equal(json_array_size(reply_at(&reply, "tags")), 0);
        reply_done(&reply);
        assert_int_equal(daemon_end(&room->daemon, SIGTERM), 0);
        daemon_restart(&room->daemon, NULL);
    }
}

/* A large document, which a child parses, keeps its labels. */
static void test_large_document(void **state)
{
    struct daemon_room *room = *state;
    enum { SENSORS = 9000, ROW = 24 };
    char *text = malloc(SENSORS * ROW + 400);
    struct reply reply;
    assert_non_null(text);
    int at = sprintf(text,
                     "{\"scene\":\"%s\",\"technique\":\"backward\",\"gather_samples\":1,\"name\":"
                     "\"large\",\"tags\":[\"l\",\"m\"],\"sensors\":[",
                     room->scene);
    for (int i = 0; i < SENSORS; i++)
        at += sprintf(text + at, "%s[2,1,0.8,0,0,1]", i ? "," : "");
    sprintf(text + at, "]}");
    daemon_post_json(&room->daemon, "/v1/jobs", text, &reply);
    free(text);
    assert_int_equal(reply.status, 202);
    assert_string_equal(reply_text(&reply, "name"), "large");
    assert_string_equal(reply_text(&reply, "tags.1"), "m");
    reply_done(&reply);
}

/* Labels do not affect the computation. */
static void test_labels_share(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char path[80], first[80], second[80];
    daemon_submit(&room->daemon, room->scene, 100000000, 77, NULL, path);
    submit(room, "\"name\":\"one\"", 5, 202, &reply);
    snprintf(first, sizeof first, "%s", reply_header(&reply, "Location"));
    reply_done(&reply);
    submit(room, "\"name\":\"two\",\"tags\":[\"t\"]", 5, 202, &reply);
    snprintf(second, sizeof second, "%s", reply_header(&reply, "Location"));
    reply_done(&reply);
    /* Both wait at the same position. */
    daemon_get(&room->daemon, first, &reply);
    const double place = reply_number(&reply, "queue_position");
    reply_done(&reply);
    daemon_get(&room->daemon, second, &reply);
    assert_true(reply_number(&reply, "queue_position") == place);
    assert_string_equal(reply_text(&reply, "name"), "two");
    reply_done(&reply);
    daemon_cancel(&room->daemon, path, &reply);
    reply_done(&reply);
    daemon_wait(&room->daemon, second, 30, &reply);
    reply_done(&reply);
}

static void repeat(char *text, const char *unit, int times)
{
    *text = '\0';
    for (int i = 0; i < times; i++)
        text += sprintf(text, "%s", unit);
}

static void test_bounds(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char members[4000], many[3000];
    static const char *const wrong[] = {
        "\"name\":\"\"",
        "\"name\":1",
        "\"name\":null",
        "\"name\":\"a\\nb\"",
        "\"name\":\"\\u001b[2J\"",
        "\"name\":\"a\\u007f\"",
        "\"name\":\"a\\u009bm\"",
        "\"tags\":\"a\"",
        "\"tags\":[\"\"]",
        "\"tags\":[1]",
        "\"tags\":[\"a\",\"a\"]",
        "\"tags\":[\"a,b\"]",
        "\"tags\":[\"a\\\"b\"]",
        "\"tags\":[\"a\\\\b\"]",
        "\"tags\":[\"a\\tb\"]",
        "\"tags\":{}",
        ("\"tags\":[\"1\",\"2\",\"3\",\"4\",\"5\",\"6\",\"7\",\"8\",\"9\",\"10\",\"11\",\"12\","
         "\"13\",\"14\",\"15\",\"16\",\"17\"]")};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(members, sizeof members, "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]],%s}",
                 room->scene, wrong[i]);
        daemon_post_json(&room->daemon, "/v1/jobs", members, &reply);
        if (reply.status != 422 && reply.status != 413)
            fail_msg("%s: %ld: %s", wrong[i], reply.status, reply.body);
        reply_done(&reply);
    }
    repeat(many, "\xc3\xa4", 100);
    snprintf(members, sizeof members, "\"name\":\"%s\"", many);
    submit(room, members, 31, 202, &reply);
    reply_done(&reply);
    repeat(many, "\xc3\xa4", 101);
    snprintf(members, sizeof members, "\"name\":\"%s\"", many);
    submit(room, members, 31, 422, &reply);
    reply_done(&reply);
    repeat(many, "\xf0\x9f\x8c\x9e", 64);
    snprintf(members, sizeof members, "\"tags\":[\"%s\"]", many);
    submit(room, members, 32, 202, &reply);
    reply_done(&reply);
    repeat(many, "x", 65);
    snprintf(members, sizeof members, "\"tags\":[\"%s\"]", many);
    submit(room, members, 32, 422, &reply);
    reply_done(&reply);
}

/* Prefixes have as few digits as distinguish the job, but at least four. */
static void test_prefixes(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char path[80], cut[80];
    submitted(room, "\"name\":\"cut\"", 41, path);
    const size_t head = strlen("/v1/jobs/");
    for (int digits = 32; digits >= 10; digits -= 11) {
        snprintf(cut, sizeof cut, "%.*s", (int)head + digits, path);
        daemon_get(&room->daemon, cut, &reply);
        assert_int_equal(reply.status, 200);
        assert_string_equal(reply_text(&reply, "name"), "cut");
        reply_done(&reply);
    }
    static const char *const below[] = {"/result", "/events", "/files/result.json"};
    for (size_t i = 0; i < 3; i++) {
        char whole[120];
        snprintf(whole, sizeof whole, "%s%s", cut, below[i]);
        daemon_get(&room->daemon, whole, &reply);
        assert_int_equal(reply.status, 200);
        reply_done(&reply);
    }
    daemon_request(&room->daemon, "DELETE", cut, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 404); /* only the whole id works */
    reply_done(&reply);
    static const char *const none[] = {"/v1/jobs/0", "/v1/jobs/012", "/v1/jobs/zzzz",
                                       "/v1/jobs/%00%00%00%00"};
    for (size_t i = 0; i < 4; i++) {
        daemon_get(&room->daemon, none[i], &reply);
        assert_int_equal(reply.status, 404);
        reply_done(&reply);
    }
}

/* Ids are random: adds jobs until two share four digits. Cancelled ones count as well, and leave
 * room in the queue. 3000 of 65 536 have no pair with a probability of 1e-30. */
static void test_ambiguous_prefix(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    enum { JOBS = 3000 };
    char blocker[80], text[256], (*seen)[5] = calloc(JOBS, sizeof *seen);
    int twice = -1;
    assert_non_null(seen);
    daemon_submit(&room->daemon, room->scene, 100000000, 78, NULL, blocker);
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"backward\",\"sensors\":[[2,1,0.8,0,0,1]]}",
             room->scene);
    for (int i = 0; i < JOBS && twice < 0; i++) {
        char cancel[120];
        daemon_post_json(&room->daemon, "/v1/jobs", text, &reply);
        assert_int_equal(reply.status, 202);
        snprintf(seen[i], sizeof *seen, "%.4s", reply_text(&reply, "id"));
        snprintf(cancel, sizeof cancel, "/v1/jobs/%s/cancel", reply_text(&reply, "id"));
        reply_done(&reply);
        daemon_post_json(&room->daemon, cancel, "", &reply);
        assert_int_equal(reply.status, 200);
        reply_done(&reply);
        for (int k = 0; k < i && twice < 0; k++)
            if (strcmp(seen[k], seen[i]) == 0)
                twice = i;
    }
    assert_true(twice >= 0);
    snprintf(text, sizeof text, "/v1/jobs/%s", seen[twice]);
    daemon_get(&room->daemon, text, &reply);
    assert_int_equal(reply.status, 404);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:ambiguous");
    reply_done(&reply);
    free(seen);
}

/* Reads all jobs of the list, page by page; returns the number of pages and the names, in order. */
static int read_pages(struct daemon *daemon, const char *path, char *names, size_t size)
{
    char next[600];
    int pages = 0;
    *names = '\0';
    snprintf(next, sizeof next, "%s", path);
    while (*next) {
        struct reply reply;
        daemon_get(daemon, next, &reply);
        if (reply.status != 200)
            fail_msg("%s: %ld %s", next, reply.status, reply.body);
        const json_t *jobs = reply_at(&reply, "jobs");
        for (size_t i = 0; i < json_array_size(jobs); i++) {
            const char *name = json_string_value(json_object_get(json_array_get(jobs, i), "name"));
            snprintf(names + strlen(names), size - strlen(names), "%s ", name ? name : "-");
        }
        const char *link = reply_header(&reply, "Link");
        assert_true((link != NULL) == json_is_true(reply_at(&reply, "more")));
        next[0] = '\0';
        if (link) {
            assert_non_null(strstr(link, ">; rel=\"next\""));
            snprintf(next, sizeof next, "%.*s", (int)strcspn(link + 1, ">"), link + 1);
        }
        reply_done(&reply);
        assert_true(++pages < 50);
    }
    return pages;
}

static void test_pages_and_filters(void **state)
{
    struct daemon_room *room = *state;
    struct daemon *daemon = &room->daemon;
    struct reply reply;
    char path[80], names[600], query[400], when[ORL_TIME_TEXT];
    submitted(room, "\"name\":\"a\",\"tags\":[\"p q\",\"v1\"]", 61, path);
    submitted(room, "\"name\":\"b\",\"tags\":[\"p\"]", 62, path);
    const struct timespec moment = {0, 5000000};
    nanosleep(&moment, NULL);
    orl_time_format(orl_time_now_ms(), when);
    submitted(room, "\"name\":\"c\",\"tags\":[\"p q\"]", 63, path);
    submitted(room, "\"name\":\"d\",\"tags\":[\"v1\",\"p q\",\"\xc3\xa4/&=?\"]", 64, path);
    assert_int_equal(read_pages(daemon, "/v1/jobs?limit=1", names, sizeof names), 4);
    assert_string_equal(names, "d c b a ");
    assert_int_equal(read_pages(daemon, "/v1/jobs?limit=3&fields=summary", names, sizeof names), 2);
    assert_string_equal(names, "d c b a ");
    assert_int_equal(read_pages(daemon, "/v1/jobs?limit=2&tag=p%20q", names, sizeof names), 2);
    assert_string_equal(names, "d c a ");
    assert_int_equal(
        read_pages(daemon, "/v1/jobs?limit=1&tag=p+q&tag=v1&fields=summary", names, sizeof names),
        2);
    assert_string_equal(names, "d a ");
    read_pages(daemon, "/v1/jobs?tag=%C3%A4%2F%26%3D%3F", names, sizeof names);
    assert_string_equal(names, "d ");
    read_pages(daemon, "/v1/jobs?tag=q", names, sizeof names); /* part of a tag does not match */
    assert_string_equal(names, "");
    snprintf(query, sizeof query, "/v1/jobs?limit=1&since=%s", when);
    read_pages(daemon, query, names, sizeof names);
    assert_string_equal(names, "d c ");
    snprintf(query, sizeof query, "/v1/jobs?limit=3&scene=%s&state=succeeded", room->scene);
    assert_int_equal(read_pages(daemon, query, names, sizeof names), 2);
    assert_string_equal(names, "d c b a ");
    memset(query + strlen("/v1/jobs?limit=3&scene="), '0', 64);
    read_pages(daemon, query, names, sizeof names);
    assert_string_equal(names, "");
    read_pages(daemon, "/v1/jobs?state=failed", names, sizeof names);
    assert_string_equal(names, "");
    static const char *const wrong[] = {"cursor=",
                                        "cursor=-1",
                                        "cursor=1x",
                                        "cursor=99999999999999999999",
                                        "since=",
                                        "since=x",
                                        "since=2024-02-30T00:00:00Z",
                                        "since=2024-01-01T00:00:00",
                                        "since=2024-01-01",
                                        "since=1969-01-01T00:00:00Z",
                                        "scene=",
                                        "scene=zz",
                                        "tag=",
                                        "tag=a%22b",
                                        "tag=a%0Ab",
                                        "tag=1&tag=2&tag=3&tag=4&tag=5",
                                        "fields=",
                                        "fields=none",
                                        "limit=1001"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        snprintf(query, sizeof query, "/v1/jobs?%s", wrong[i]);
        daemon_get(daemon, query, &reply);
        if (reply.status != 400)
            fail_msg("%s: %ld", wrong[i], reply.status);
        reply_done(&reply);
    }
}

/* The job of a cursor may be removed: the list continues after its position. */
static void test_cursor_outlives_its_job(void **state)
{
    struct daemon_room *room = *state;
    struct daemon *daemon = &room->daemon;
    struct reply reply;
    char path[80], next[200], names[100];
    submitted(room, "\"name\":\"a\"", 71, path);
    submitted(room, "\"name\":\"b\"", 72, path);
    submitted(room, "\"name\":\"c\"", 73, path);
    daemon_get(daemon, "/v1/jobs?limit=1", &reply);
    const char *link = reply_header(&reply, "Link");
    assert_non_null(link);
    snprintf(next, sizeof next, "%.*s", (int)strcspn(link + 1, ">"), link + 1);
    reply_done(&reply);
    daemon_request(daemon, "DELETE", path, NULL, NULL, 0, NULL, &reply);
    assert_int_equal(reply.status, 204);
    reply_done(&reply);
    read_pages(daemon, next, names, sizeof names);
    assert_string_equal(names, "b a ");
}

/* The short form has an unchanged text while nothing has changed, and then gives a 304. */
static void test_summary(void **state)
{
    struct daemon_room *room = *state;
    struct daemon *daemon = &room->daemon;
    struct reply reply;
    char path[80], header[200];
    submitted(room, "\"name\":\"goal\",\"tags\":[\"g\"]", 81, path);
    daemon_get(daemon, "/v1/jobs?fields=summary&limit=1", &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "jobs.0.name"), "goal");
    assert_string_equal(reply_text(&reply, "jobs.0.state"), "succeeded");
    assert_true(reply_number(&reply, "jobs.0.percent") == 100);
    assert_true(json_is_null(reply_at(&reply, "jobs.0.error")));
    assert_null(reply_at(&reply, "jobs.0.links"));
    assert_null(reply_at(&reply, "jobs.0.files"));
    assert_true(reply.size < 600);
    snprintf(header, sizeof header, "If-None-Match: %s", reply_header(&reply, "ETag"));
    reply_done(&reply);
    daemon_request(daemon, "GET", "/v1/jobs?fields=summary&limit=1", NULL, NULL, 0, header, &reply);
    assert_int_equal(reply.status, 304);
    assert_int_equal(reply.size, 0);
    reply_done(&reply);
    submitted(room, "", 82, path);
    daemon_request(daemon, "GET", "/v1/jobs?fields=summary&limit=1", NULL, NULL, 0, header, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    /* With a goal: the final error, also after a restart. */
    char text[300];
    snprintf(
        text, sizeof text,
        "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]],\"accuracy\":{\"relative_error\":0.3}}",
        room->scene);
    daemon_post_json(daemon, "/v1/jobs", text, &reply);
    snprintf(path, sizeof path, "%s", reply_header(&reply, "Location"));
    reply_done(&reply);
    daemon_wait(daemon, path, 60, &reply);
    const double achieved = reply_number(&reply, "accuracy.achieved");
    reply_done(&reply);
    assert_true(achieved > 0);
    for (int round = 0; round < 2; round++) {
        daemon_get(daemon, "/v1/jobs?fields=summary&limit=1", &reply);
        const double error = reply_number(&reply, "jobs.0.error");
        reply_done(&reply);
        assert_true(error > achieved * (1 - 1e-8) && error < achieved * (1 + 1e-8));
        assert_int_equal(daemon_end(daemon, SIGTERM), 0);
        daemon_restart(daemon, NULL);
    }
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_names_and_tags_stay),
        EACH(test_large_document),
        EACH(test_labels_share),
        EACH(test_bounds),
        EACH(test_prefixes),
        EACH(test_ambiguous_prefix),
        EACH(test_pages_and_filters),
        EACH(test_cursor_outlives_its_job),
        EACH(test_summary),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
