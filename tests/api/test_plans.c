/* Plans of jobs over HTTP: equal to the job's own, not stored, limited, refused with reasons. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/extent.h"

static void document(const struct daemon_room *room, const char *members, char ret_text[700])
{
    snprintf(ret_text, 700,
             "{\"scene\":\"%s\",\"seed\":3,\"sensors\":[[2,1,0.8,0,0,1],[2,4,0.8,0,0,1]],%s}",
             room->scene, members);
}

/*
 * The plan has the technique and every decision of the later job; and the request creates no job.
 */
static void test_as_the_job_has_it(void **state)
{
    static const char *const members[] = {
        ("\"technique\":\"gather\",\"photons\":{\"global\":5000,\"caustic\":500},"
         "\"gather_samples\":16"),
        "\"technique\":\"backward\",\"gather_samples\":16",
        "\"photons\":{\"global\":5000},\"effects\":{\"caustics\":\"skip\"}"};
    struct daemon_room *room = *state;
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        struct reply plan, reply;
        char text[700], path[100];
        document(room, members[i], text);
        daemon_post_json(&room->daemon, "/v1/plans", text, &plan);
        if (plan.status != 200)
            fail_msg("%s: %ld %s", text, plan.status, plan.body);
        assert_int_equal(json_array_size(reply_at(&plan, "plans")), 1);
        assert_true(json_is_null(reply_at(&plan, "plans.0.sky")));
        daemon_get(&room->daemon, "/v1/jobs?limit=1000", &reply);
        assert_int_equal(json_array_size(reply_at(&reply, "jobs")), i);
        reply_done(&reply);
        daemon_post_json(&room->daemon, "/v1/jobs", text, &reply);
        assert_int_equal(reply.status, 202);
        snprintf(path, sizeof path, "%.50s", reply_header(&reply, "Location"));
        reply_done(&reply);
        daemon_wait(&room->daemon, path, 60, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        reply_done(&reply);
        strcat(path, "/result");
        daemon_get(&room->daemon, path, &reply);
        assert_string_equal(reply_text(&plan, "plans.0.plan.technique"),
                            reply_text(&reply, "plan.technique"));
        const json_t *wanted = reply_at(&reply, "plan.effects");
        const json_t *found = reply_at(&plan, "plans.0.plan.effects");
        assert_true(json_array_size(wanted) > 10);
        assert_int_equal(json_array_size(found), json_array_size(wanted));
        for (size_t k = 0; k < json_array_size(wanted); k++) {
            const json_t *a = json_array_get(found, k), *b = json_array_get(wanted, k);
            assert_true(json_equal(json_object_get(a, "effect"), json_object_get(b, "effect")));
            assert_true(json_equal(json_object_get(a, "bound"), json_object_get(b, "bound")));
            assert_true(
                json_equal(json_object_get(a, "simulated"), json_object_get(b, "simulated")));
        }
        reply_done(&reply);
        reply_done(&plan);
    }
    daemon_expect_no_files(&room->daemon, "tmp");
}

/* The accuracy curve does not depend on the job's goal: decreasing errors, increasing times. */
static void test_curve(void **state)
{
    static const char *const members[] = {
        "\"gather_samples\":16", "\"accuracy\":{\"deadline_s\":20,\"at\":0.5}",
        "\"accuracy\":{\"relative_error\":0.02}", "\"technique\":\"gather\"",
        ("\"views\":[{\"name\":\"v\",\"view\":\"-vp 2 1 1.5 -vd "
         "0 1 0\",\"width\":64,\"height\":48}]")};
    struct daemon_room *room = *state;
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        const char *technique = i < 3 ? "backward" : "gather";
        struct reply plan;
        char text[700];
        document(room, members[i], text);
        daemon_post_json(&room->daemon, "/v1/plans", text, &plan);
        assert_int_equal(plan.status, 200);
        const json_t *points = reply_at(&plan, "plans.0.curve.points");
        assert_string_equal(reply_text(&plan, "plans.0.plan.technique"), technique);
        assert_string_equal(reply_text(&plan, "plans.0.curve.technique"), technique);
        assert_true(reply_number(&plan, "plans.0.curve.threads") == 1);
        assert_true(json_array_size(points) >= 2);
        for (size_t k = 1; k < json_array_size(points); k++) {
            const json_t *a = json_array_get(points, k - 1), *b = json_array_get(points, k);
            assert_true(json_number_value(json_object_get(a, "error")) >
                        json_number_value(json_object_get(b, "error")));
            assert_true(json_number_value(json_object_get(a, "seconds")) <=
                        json_number_value(json_object_get(b, "seconds")));
        }
        reply_done(&plan);
    }
}

/* One plan for each sky by its name; also for a job that renders a sequence of them. */
static void test_skies(void **state)
{
    static const char members[] =
        "\"skies\":{\"weather\":{\"file\":\"place.wea\"},\"from\":{\"month\":3,\"day\":22,"
        "\"hour\":9.5},\"to\":{\"month\":3,\"day\":22,\"hour\":10.5}},\"sequence\":{},"
        "\"views\":[{\"name\":\"v\",\"view\":\"-vp 2 4 1.6 -vd 0 -1 0\",\"width\":16,"
        "\"height\":16}]";
    struct daemon_room *room = *state;
    struct reply plan;
    char text[700];
    document(room, members, text);
    daemon_post_json(&room->daemon, "/v1/plans", text, &plan);
    if (plan.status != 200)
        fail_msg("%s: %ld %s", text, plan.status, plan.body);
    assert_int_equal(json_array_size(reply_at(&plan, "plans")), 2);
    assert_string_equal(reply_text(&plan, "plans.0.sky"), "0322-0930");
    assert_string_equal(reply_text(&plan, "plans.1.sky"), "0322-1030");
    assert_true(json_is_object(reply_at(&plan, "plans.0.curve")));
    assert_true(json_is_null(reply_at(&plan, "plans.1.curve")));
    assert_true(json_is_false(reply_at(&plan, "more")));
    reply_done(&plan);
}

/* Opens a connection from another address than the test's other requests, so that both take turns
 * in checks. */
static int dial_from_another(const struct daemon *daemon)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1);
    assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons((uint16_t)strtoul(strrchr(daemon->url, ':') + 1, NULL, 10));
    assert_int_equal(connect(fd, (struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

/* While others remove and upload the scene, a plan is made of it or refused, and the daemon never
 * fails. Removals and uploads alternate while plans and outlines are requested. */
static void test_removed_and_sent_again(void **state)
{
    enum { AT_ONCE = 12 };
    const int turns = (int)extent(2, 6);
    struct daemon_room *f = *state;
    char post[1024], body[512], look[256], removal[160], id[65], answer[4096];
    snprintf(removal, sizeof removal, "/v1/scenes/%s", f->scene);
    const int size =
        snprintf(body, sizeof body, "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]]}", f->scene);
    snprintf(post, sizeof post,
             "POST /v1/plans HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
             "Content-Type: application/json\r\nContent-Length: %d\r\n\r\n%s",
             size, body);
    snprintf(look, sizeof look,
             "GET /v1/scenes/%s/outline HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
             f->scene);
    for (int turn = 0; turn < turns; turn++) {
        int fds[AT_ONCE];
        struct reply reply;
        for (int i = 0; i < AT_ONCE; i++) {
            const char *text = i % 2 ? look : post;
            fds[i] = dial_from_another(&f->daemon);
            assert_int_equal(write(fds[i], text, strlen(text)), strlen(text));
        }
        for (int i = 0; i < 5; i++) { /* by then most of them have found the scene, and wait */
            daemon_get(&f->daemon, "/readyz", &reply);
            reply_done(&reply);
        }
        daemon_request(&f->daemon, "DELETE", removal, NULL, NULL, 0, NULL, &reply);
        assert_int_equal(reply.status, 204);
        reply_done(&reply);
        daemon_upload_room(&f->daemon, id);
        for (int i = 0; i < AT_ONCE; i++) {
            const ssize_t n = read(fds[i], answer, sizeof answer - 1);
            assert_true(n > 12);
            answer[n] = '\0';
            const char *status =
                answer + 9; /* 422: the document names a scene that does not exist */
            if (strncmp(status, "200", 3) != 0 && strncmp(status, "404", 3) != 0 &&
                strncmp(status, "422", 3) != 0)
                fail_msg("turn %d: %s", turn, answer);
            close(fds[i]);
        }
    }
}

static void test_refused(void **state)
{
    struct daemon_room *room = *state;
    struct reply reply;
    char text[700];
    static const struct {
        const char *members;
        long status;
    } cases[] = {
        {"\"kind\":\"annual\"", 422},
        {"\"technique\":\"none\"", 422},
        {"\"other\":1", 422},
        {"\"sky\":{\"weather\":{\"file\":\"absent.epw\",\"month\":3,\"day\":1,\"hour\":12}}", 422},
        {"\"sky\":{\"cie\":{\"type\":\"overcast\",\"diffuse_horizontal_lx\":10000}}", 422}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        document(room, cases[i].members, text);
        daemon_post_json(&room->daemon, "/v1/plans", text, &reply);
        if (reply.status != cases[i].status)
            fail_msg("%s: %ld %s", text, reply.status, reply.body);
        assert_true(strlen(reply_text(&reply, "detail")) > 0);
        reply_done(&reply);
    }
    memset(room->scene, '0', 64);
    document(room, "\"seed\":1", text);
    daemon_post_json(&room->daemon, "/v1/plans", text, &reply);
    assert_int_equal(reply.status, 400); /* a duplicate member */
    reply_done(&reply);
    document(room, "\"dark\":\"expected\"", text);
    daemon_post_json(&room->daemon, "/v1/plans", text, &reply);
    assert_int_equal(reply.status, 422);
    assert_string_equal(reply_text(&reply, "primitive"), "scene");
    reply_done(&reply);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_as_the_job_has_it), EACH(test_curve), EACH(test_refused),
        EACH(test_removed_and_sent_again),
        cmocka_unit_test_setup_teardown(test_skies, daemon_weather_set_up, daemon_room_tear_down)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
