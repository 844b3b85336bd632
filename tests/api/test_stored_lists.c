/* Lists of scenes and BSDFs: pages, sizes, times of last use, and access. */
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

#include "support/daemon.h"
#include "support/scene_text.h"

static void nap(void)
{
    const struct timespec moment = {0, 5000000}; /* so that times of milliseconds differ */
    nanosleep(&moment, NULL);
}

static void upload(struct daemon *daemon, const char *text, char ret_id[65])
{
    const struct upload_file file = {"room.rad", text, strlen(text), false};
    struct reply reply;
    daemon_upload(daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(ret_id, 65, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    nap();
}

/* Reads the list's ids with that page size; returns the number of pages. */
static int pages(struct daemon *daemon, const char *name, int limit, char (*ret_ids)[65],
                 size_t most, size_t *ret_count)
{
    char next[300];
    int count = 0;
    *ret_count = 0;
    snprintf(next, sizeof next, "/v1/%s?limit=%d", name, limit);
    while (*next) {
        struct reply reply;
        daemon_get(daemon, next, &reply);
        assert_int_equal(reply.status, 200);
        const json_t *items = reply_at(&reply, name);
        assert_true(json_array_size(items) <= (size_t)limit);
        for (size_t i = 0; i < json_array_size(items) && *ret_count < most; i++)
            snprintf(ret_ids[(*ret_count)++], 65, "%s",
                     json_string_value(json_object_get(json_array_get(items, i), "id")));
        const char *link = reply_header(&reply, "Link");
        assert_true((link != NULL) == json_is_true(reply_at(&reply, "more")));
        next[0] = '\0';
        if (link)
            snprintf(next, sizeof next, "%.*s", (int)strcspn(link + 1, ">"), link + 1);
        reply_done(&reply);
        assert_true(++count < 20);
    }
    return count;
}

static void test_scenes(void **state)
{
    struct daemon *daemon = *state;
    struct reply reply;
    char ids[5][65], found[8][65], path[80], before[40];
    size_t count = 0;
    daemon_get(daemon, "/v1/scenes", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "scenes")), 0);
    assert_true(json_is_false(reply_at(&reply, "more")));
    reply_done(&reply);
    for (int i = 0; i < 4; i++) {
        char text[8000];
        snprintf(text, sizeof text, "%s%s# %d\n", room_scene, room_sky, i);
        upload(daemon, text, ids[i]);
    }
    for (int limit = 1; limit < 5; limit++) {
        assert_int_equal(pages(daemon, "scenes", limit, found, 8, &count), (4 + limit - 1) / limit);
        assert_int_equal(count, 4);
        for (int i = 0; i < 4; i++)
            assert_string_equal(found[i], ids[3 - i]);
    }
    daemon_get(daemon, "/v1/scenes?limit=1", &reply);
    assert_true(reply_number(&reply, "scenes.0.bytes") >
                (double)(strlen(room_scene) + strlen(room_sky)));
    assert_true(reply_number(&reply, "scenes.0.jobs") == 0);
    snprintf(before, sizeof before, "%s", reply_text(&reply, "scenes.0.last_used"));
    assert_string_equal(before, reply_text(&reply, "scenes.0.created_at"));
    reply_done(&reply);
    /* A scene is in use while a job waits or runs, and that time is kept as its last use, also over
     * a restart. */
    daemon_submit(daemon, ids[3], 100000000, 1, NULL, path);
    daemon_get(daemon, "/v1/scenes?limit=1", &reply);
    assert_true(reply_number(&reply, "scenes.0.jobs_under_way") == 1);
    assert_true(strcmp(reply_text(&reply, "scenes.0.last_used"), before) > 0);
    reply_done(&reply);
    daemon_cancel(daemon, path, &reply);
    reply_done(&reply);
    daemon_wait(daemon, path, 30, &reply);
    reply_done(&reply);
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    daemon_restart(daemon, NULL);
    daemon_get(daemon, "/v1/scenes?limit=1", &reply);
    assert_true(reply_number(&reply, "scenes.0.jobs_under_way") == 0);
    assert_true(reply_number(&reply, "scenes.0.jobs") == 1);
    assert_true(strcmp(reply_text(&reply, "scenes.0.last_used"), before) > 0);
    reply_done(&reply);
}

static void test_bsdfs(void **state)
{
    struct daemon *daemon = *state;
    static const char *const files[] = {"bsdf_klems41.xml", "bsdf_lcp8.xml"};
    struct reply reply;
    char ids[2][65], found[4][65], scene[9000], text[9500];
    size_t count = 0, sizes[2];
    for (int i = 0; i < 2; i++) {
        char path[120];
        snprintf(path, sizeof path, "tests/fixtures/%s", files[i]);
        char *xml = (char *)scene_read_bytes(path, &sizes[i]);
        snprintf(path, sizeof path, "/v1/bsdfs?name=%s", files[i]);
        daemon_request(daemon, "POST", path, "application/xml", xml, sizes[i], NULL, &reply);
        assert_int_equal(reply.status, 201);
        snprintf(ids[i], 65, "%s", reply_text(&reply, "id"));
        reply_done(&reply);
        free(xml);
        nap();
    }
    assert_int_equal(pages(daemon, "bsdfs", 1, found, 4, &count), 2);
    assert_int_equal(count, 2);
    assert_string_equal(found[0], ids[1]);
    assert_string_equal(found[1], ids[0]);
    snprintf(scene, sizeof scene,
             "{\"files\":[{\"name\":\"r.rad\",\"text\":\"void BSDF pane 6 0 k.xml 0 0 1 . 0 0\\n"
             "pane polygon p 0 0 12 0 0 0 1 0 0 1 0 1 0 0 1\\n\"}],\"bsdfs\":{\"k.xml\":\"%s\"}}",
             ids[0]);
    daemon_post_json(daemon, "/v1/scenes", scene, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(text, sizeof text, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    daemon_get(daemon, "/v1/bsdfs", &reply);
    assert_string_equal(reply_text(&reply, "bsdfs.1.name"), files[0]);
    assert_true(reply_number(&reply, "bsdfs.1.bytes") == (double)sizes[0]);
    assert_true(reply_number(&reply, "bsdfs.1.scene_count") == 1);
    assert_string_equal(reply_text(&reply, "bsdfs.1.scenes.0"), text);
    char used[40];
    snprintf(used, sizeof used, "%s", reply_text(&reply, "bsdfs.1.last_used"));
    assert_true(strcmp(used, reply_text(&reply, "bsdfs.1.created_at")) > 0);
    assert_true(reply_number(&reply, "bsdfs.0.scene_count") == 0);
    assert_int_equal(json_array_size(reply_at(&reply, "bsdfs.0.scenes")), 0);
    reply_done(&reply);
}

static void test_refusals(void **state)
{
    static const char *const wrong[] = {
        "limit=0",  "limit=1001",  "limit=x",   "cursor=",
        "cursor=1", "cursor=1-00", "cursor=-1", "cursor=9999999999999999-x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        for (int k = 0; k < 2; k++) {
            char path[100];
            struct reply reply;
            snprintf(path, sizeof path, "/v1/%s?%s", k ? "bsdfs" : "scenes", wrong[i]);
            daemon_get(*state, path, &reply);
            if (reply.status != 400)
                fail_msg("%s: %ld", path, reply.status);
            reply_done(&reply);
        }
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_set_up, daemon_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {EACH(test_scenes), EACH(test_bsdfs), EACH(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
