/* A large BSDF through a real daemon: parsed by the first job, reused by others, stored with the
 * maps. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"
#include "support/daemon.h"
#include "support/room.h"

enum { LARGE = 1 << 20, JOBS = 3 };

static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE;

/* Padded with white space to the minimum size of stored BSDFs. */
static void upload(struct daemon *daemon, char ret_id[65])
{
    struct text t = make_tree_file(3);
    const size_t size = t.size + LARGE;
    char *xml = realloc(t.data, size);
    struct reply reply;
    assert_non_null(xml);
    memset(xml + t.size, ' ', LARGE);
    const struct upload_file files[] = {{"room.rad", scene, strlen(scene), false},
                                        {"pane.xml", xml, size, true}};
    daemon_upload(daemon, files, 2, NULL, &reply);
    if (reply.status != 201)
        fail_msg("the scene was refused: %s", reply.body);
    snprintf(ret_id, 65, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(xml);
}

/* Jobs differ in their second sensor; otherwise they would share one computation. */
static void submit(struct daemon *daemon, const char *id, int which, char ret_path[80])
{
    char text[512];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"technique\":\"backward\","
             "\"gather_samples\":64,\"sensors\":[[2,1,0.8,0,0,1],[2,1,0.%d,0,0,1]]}",
             id, which);
    daemon_post_json(daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

/* Waits for a job and returns its one sensor's lux. */
static double wait_for_lux(struct daemon *daemon, const char *job)
{
    struct reply reply;
    char path[96];
    daemon_wait(daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(daemon, path, &reply);
    const double lux = reply_number(&reply, "sensors.0.illuminance_lx");
    reply_done(&reply);
    assert_true(lux > 0);
    return lux;
}

static void expect_kept(struct daemon *daemon, double hits)
{
    struct reply reply;
    daemon_get(daemon, "/v1/maps", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "maps")), 1);
    assert_string_equal(reply_text(&reply, "maps.0.kind"), "bsdf");
    assert_true(reply_number(&reply, "maps.0.hits") == hits);
    assert_true(reply_number(&reply, "maps.0.bytes") > 1000);
    assert_true(reply_number(&reply, "maps.0.stored") > 100);
    reply_done(&reply);
    assert_int_equal(daemon_count_files(daemon, "maps"), 1);
}

/* Several jobs at once, of which one parses the file; then one more after a restart. The memory
 * cache is off, since it would hold the scene with its BSDFs. */
static void test_kept(void **state)
{
    static const char *const two_at_once[] = {"--threads", "2", "--jobs", "2",
                                              "--shelf",   "0", NULL};
    struct daemon daemon;
    char id[65], jobs[JOBS][80];
    double lux[JOBS];
    (void)state;
    daemon_start(&daemon, two_at_once);
    upload(&daemon, id);
    for (int i = 0; i < JOBS; i++)
        submit(&daemon, id, i, jobs[i]);
    for (int i = 0; i < JOBS; i++) {
        lux[i] = wait_for_lux(&daemon, jobs[i]);
        assert_true(lux[i] == lux[0]);
    }
    expect_kept(&daemon, JOBS - 1);
    assert_int_equal(daemon_end(&daemon, SIGTERM), 0);
    daemon_restart(&daemon, two_at_once);
    submit(&daemon, id, JOBS, jobs[0]);
    assert_true(wait_for_lux(&daemon, jobs[0]) == lux[0]);
    expect_kept(&daemon, JOBS);
    daemon_remove(&daemon);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test(test_kept)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
