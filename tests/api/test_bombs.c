/*
 * Small uploads that would take much memory or time: refused within limits, and nothing is stored.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <curl/curl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "process/limits.h"
#include "store/files/folders.h"
#include "support/daemon.h"
#include "support/daemon_metric.h"
#include "support/patience.h"
#include "support/scene_text.h"

/* AddressSanitizer delays the release of memory: then figures are only printed. */
static bool is_within(double mb, double most_mb)
{
#ifdef __SANITIZE_ADDRESS__
    (void)mb, (void)most_mb;
    return true;
#else
    return mb < most_mb;
#endif
}

/* Returns "[{},{},...]" with that many objects. */
static char *many_objects(size_t count, size_t *ret_size)
{
    char *text = malloc(3 * count + 2);
    assert_non_null(text);
    for (size_t i = 0; i < count; i++)
        memcpy(text + 3 * i, i == 0 ? "[{}" : ",{}", 3);
    text[3 * count] = ']';
    *ret_size = 3 * count + 1;
    return text;
}

/* 33 MB that would take 2.5 GB are refused without parsing. Smaller input, such as 5 MB that take
 * 0.4 GB, is parsed in a separate process. */
static void test_mesh_import(void **state)
{
    static const struct {
        size_t count;
        long status;
        double most_mb;
    } cases[] = {{11000000, 413, 200}, {1600000, 422, 200}};
    struct daemon *daemon = *state;
    const double before_mb = daemon_memory_mb(daemon, "VmRSS");
    for (size_t i = 0; i < 2; i++) {
        struct reply reply;
        size_t size;
        char *text = many_objects(cases[i].count, &size);
        daemon_request(daemon, "POST", "/v1/jobs", "application/json", text, size, NULL, &reply);
        assert_int_equal(reply.status, cases[i].status);
        reply_done(&reply);
        free(text);
        const double peak_mb = daemon_memory_mb(daemon, "VmHWM") - before_mb;
        const double kept_mb = daemon_memory_mb(daemon, "VmRSS") - before_mb;
        print_message("# %zu objects: a peak of %.0f MB, %.0f MB stay\n", cases[i].count, peak_mb,
                      kept_mb);
        assert_true(is_within(peak_mb, cases[i].most_mb));
        assert_true(is_within(kept_mb, 100));
    }
}

/* 5 M surfaces from copies of 50, with a prefix of 450 bytes: 2 GB of names. */
static void test_names(void **state)
{
    enum { PREFIX = 450, COPIED = 50 };
    struct daemon *daemon = *state;
    char prefix[PREFIX + 1], scene[PREFIX + 200], part[COPIED * 80];
    struct reply reply;
    size_t used = 0;
    memset(prefix, 'p', PREFIX);
    prefix[PREFIX] = '\0';
    snprintf(scene, sizeof scene,
             "void plastic grey 0 0 5 .5 .5 .5 0 0\n!xform -n %s -a 100000 -t 0 0 1 part.rad\n",
             prefix);
    for (int i = 0; i < COPIED; i++)
        used += (size_t)sprintf(part + used, "grey polygon s%d 0 0 9 0 0 %d 1 0 %d 0 1 %d\n", i, i,
                                i, i);
    const struct upload_file files[] = {{"scene.rad", scene, strlen(scene), false},
                                        {"part.rad", part, used, true}};
    daemon_upload(daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 413);
    assert_non_null(strstr(reply_text(&reply, "detail"), "names"));
    assert_string_equal(reply_text(&reply, "file"), "part.rad");
    reply_done(&reply);
    const double peak_mb = daemon_memory_mb(daemon, "VmHWM");
    print_message("# names: a peak of %.0f MB\n", peak_mb);
    assert_true(is_within(peak_mb, 150));
}

/* Takes longer than --check-timeout on any machine: refused soon after that time. */
#define SLOW                                                                                       \
    "void plastic grey 0 0 5 .5 .5 .5 0 0\n!xform -a 50000 -t 0 0 1 part.rad\n"                    \
    "!xform -a 50000 -t 1 0 1 part.rad\n"

static const char thing[] = "grey sphere s 0 0 4 0 0 0 .1\n";

static void make_slow_part(char ret_part[40 * sizeof thing])
{
    ret_part[0] = '\0';
    for (int i = 0; i < 40; i++)
        strcat(ret_part, thing);
}

static void test_time(void **state)
{
    static const char *const hasty[] = {"--check-timeout", "1", NULL};
    char part[40 * sizeof thing];
    struct daemon daemon;
    struct reply reply;
    (void)state;
    make_slow_part(part);
    const struct upload_file files[] = {{"scene.rad", SLOW, strlen(SLOW), false},
                                        {"part.rad", part, strlen(part), true}};
    daemon_start(&daemon, hasty);
    daemon_upload(&daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 413);
    /* The message has the limit, the time that the check took, and the remedy. */
    const char *after = strstr(reply_text(&reply, "detail"), "stopped after ");
    assert_non_null(after);
    assert_true(atof(after + strlen("stopped after ")) >= 1);
    assert_non_null(strstr(after, "the limit is 1 (--check-timeout)"));
    assert_non_null(strstr(reply_text(&reply, "hint"), "larger --check-timeout"));
    print_message("# %s, by the client's clock after %.1f s\n", reply_text(&reply, "detail"),
                  reply.seconds);
    reply_done(&reply);
    daemon_remove(&daemon);
}

/* More slow checks than may run at once: jobs and other requests continue beside them; SIGTERM ends
 * all. */
static void test_many_at_once(void **state)
{
    enum { BOMBS = 6 };
    char part[40 * sizeof thing];
    struct daemon daemon;
    pid_t pids[BOMBS];
    struct reply reply;
    (void)state;
    make_slow_part(part);
    daemon_start(&daemon, NULL);
    for (int i = 0; i < BOMBS; i++) {
        pids[i] = fork();
        assert_true(pids[i] >= 0);
        if (pids[i] == 0) {
            char scene[sizeof SLOW + 40];
            snprintf(scene, sizeof scene, "# %d\n%s", i, SLOW);
            const struct upload_file files[] = {{"scene.rad", scene, strlen(scene), false},
                                                {"part.rad", part, strlen(part), true}};
            daemon.curl = curl_easy_init(); /* a separate connection */
            daemon_upload(&daemon, files, 2, NULL, &reply);
            _exit(0);
        }
    }
    daemon_metric_wait(&daemon, "oriel_http_connections", BOMBS + 1);
    daemon_metric_wait(&daemon, "oriel_memory_checks_bytes", 1);
    double longest_s = 0;
    for (int i = 0; i < 10; i++) {
        daemon_post_json(&daemon, "/v1/jobs", "{}", &reply);
        assert_int_equal(reply.status, 422);
        longest_s = reply.seconds > longest_s ? reply.seconds : longest_s;
        reply_done(&reply);
    }
    print_message("# the longest POST of a job: %.2f s\n", longest_s);
    for (int i = 0; i < BOMBS; i++) /* no POST waited for a check to end */
        assert_int_equal(waitpid(pids[i], NULL, WNOHANG), 0);
    const double from_s = patience_now_s();
    assert_int_equal(daemon_end(&daemon, SIGTERM), 0);
    print_message("# stopped in %.1f s\n", patience_now_s() - from_s);
    assert_true(patience_now_s() - from_s < 60); /* half of what one check may take */
    for (int i = 0; i < BOMBS; i++)
        kill(pids[i], SIGKILL);
    daemon_remove(&daemon);
}

/* ---- Damage, and equal jobs ------------------------------------------------------------------ */

/* A byte of a stored file changes; uploading the file again returns 200, and repairs it. */
static void test_uploads_mend(void **state)
{
    struct daemon_room *f = *state;
    char sha[ORL_SHA_HEX], path[256], again[65], *kept = NULL;
    size_t size = 0;
    orl_sha256_hex(room_scene, strlen(room_scene), sha);
    snprintf(path, sizeof path, "%s/blobs/%.2s/%s", f->daemon.root, sha, sha);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fputc('#', file);
    fclose(file);
    daemon_upload_room(&f->daemon, again);
    assert_string_equal(again, f->scene);
    kept = (char *)scene_read_bytes(path, &size);
    assert_int_equal(size, strlen(room_scene));
    assert_memory_equal(kept, room_scene, size);
    free(kept);
}

/* The number of jobs that share a computation is limited; the next one starts its own. */
static void test_sharing_is_bounded(void **state)
{
    struct daemon_room *f = *state;
    struct reply reply;
    char path[80], first[80];
    daemon_submit(&f->daemon, f->scene, 100000000, 1, NULL, first);
    for (unsigned i = 0; i < ORL_SERVER_DEDUP_FOLLOWERS + 1; i++)
        daemon_submit(&f->daemon, f->scene, 100000000, 1, NULL, path);
    daemon_get(&f->daemon, path, &reply);
    assert_string_equal(reply_text(&reply, "state"), "queued");
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/jobs?limit=3", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), 3);
    assert_true(json_is_true(reply_at(&reply, "more")));
    reply_done(&reply);
    daemon_get(&f->daemon, "/v1/jobs?limit=1000", &reply);
    assert_int_equal(json_array_size(reply_at(&reply, "jobs")), ORL_SERVER_DEDUP_FOLLOWERS + 2);
    assert_true(json_is_false(reply_at(&reply, "more")));
    reply_done(&reply);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_mesh_import, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_names, daemon_set_up, daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_uploads_mend, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_sharing_is_bounded, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test(test_time),
        cmocka_unit_test(test_many_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
