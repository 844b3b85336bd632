/* Jobs of several views: each is available as soon as it is done, and is not rendered again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/patience.h"

#define VIEW(name, side)                                                                           \
    "{\"name\":\"" name "\",\"view\":\"-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv "        \
    "55\",\"width\":" side ",\"height\":" side "}"
/* The last view takes minutes, or is as quick as the others. */
#define VIEWS(last) "\"views\":[" VIEW("a", "24") "," VIEW("b", "48") "," VIEW("c", last) "]"

static void submit(struct daemon_room *f, const char *technique, const char *views,
                   char ret_path[80])
{
    char text[2048];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"%s\",\"photons\":{\"global\":20000,\"caustic\":0},"
             "\"gather_samples\":64,\"pixel_samples\":16,\"sensors\":[[2,1,0.8,0,0,1]],%s}",
             f->scene, technique, views);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

/* Waits until that many files are available. Returns true if the job still runs. */
static bool wait_for_files(struct daemon_room *f, const char *job, size_t count)
{
    for (double until = patience_now_s() + 300; patience_nap(until);) {
        struct reply reply;
        daemon_get(&f->daemon, job, &reply);
        const bool there = json_array_size(reply_at(&reply, "links.files")) >= count;
        const bool runs = strcmp(reply_text(&reply, "state"), "running") == 0;
        assert_true(!runs || !reply_at(&reply, "links.result"));
        reply_done(&reply);
        if (there)
            return runs;
    }
    fail_msg("no view in five minutes");
    return false;
}

static void get_below(struct daemon_room *f, const char *job, const char *what,
                      struct reply *ret_reply)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", job, what);
    daemon_get(&f->daemon, path, ret_reply);
}

static void expect_status(struct daemon_room *f, const char *job, const char *what, long status)
{
    struct reply reply;
    get_below(f, job, what, &reply);
    assert_int_equal(reply.status, status);
    reply_done(&reply);
}

/* Returns the time at which a job's file was written, in nanoseconds. */
static int64_t written(const struct daemon_room *f, const char *folder, const char *job,
                       const char *file)
{
    char path[256];
    struct stat st;
    snprintf(path, sizeof path, "%s/%s/%s/%s", f->daemon.root, folder, strrchr(job, '/') + 1, file);
    assert_int_equal(stat(path, &st), 0);
    return (int64_t)st.st_mtim.tv_sec * 1000000000 + st.st_mtim.tv_nsec;
}

static void cancel(struct daemon_room *f, const char *job)
{
    struct reply reply;
    daemon_cancel(&f->daemon, job, &reply);
    assert_int_equal(reply.status / 100, 2);
    reply_done(&reply);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
}

/* Finished views are available while the last one is rendered, over kills and stops; removed when
 * the job is cancelled. */
static void test_views_before_the_end(void **state)
{
    struct daemon_room *f = *state;
    char job[80];
    submit(f, "backward", VIEWS("4000"), job);
    assert_true(wait_for_files(f, job, 8));
    expect_status(f, job, "files/a.hdr", 200);
    expect_status(f, job, "files/b.error.png", 200);
    expect_status(f, job, "files/c.hdr", 404);
    expect_status(f, job, "result", 409);
    const int64_t first = written(f, "partial", job, "a.hdr");
    for (int i = 0; i < 2; i++) {
        daemon_end(&f->daemon, i ? SIGTERM : SIGKILL);
        daemon_restart(&f->daemon, NULL);
        assert_true(wait_for_files(f, job, 8));
        expect_status(f, job, "files/b.hdr", 200);
        assert_true(written(f, "partial", job, "a.hdr") == first);
    }
    cancel(f, job);
    expect_status(f, job, "files/a.hdr", 409);
    daemon_expect_no_files(&f->daemon, "partial");
}

static void expect_same(struct daemon_room *f, const char *one, const char *other, const char *file)
{
    struct reply a, b;
    get_below(f, one, file, &a);
    get_below(f, other, file, &b);
    assert_int_equal(a.status, 200);
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.body, b.body, a.size);
    reply_done(&a);
    reply_done(&b);
}

/* A job interrupted between views gives the bytes of an uninterrupted one, and keeps its finished
 * views. */
static void test_torn_job_ends_the_same(void **state)
{
    /* Sizes of the last view that leave time to interrupt the job. */
    static const struct {
        const char *technique, *views;
    } cases[] = {{"backward", VIEWS("64")}, {"gather", VIEWS("64")}, {"direct", VIEWS("200")}};
    struct daemon_room *f = *state;
    int n_torn = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char torn[80], whole[80];
        struct reply reply;
        submit(f, cases[i].technique, cases[i].views, torn);
        const bool in_time = wait_for_files(f, torn, 4);
        daemon_end(&f->daemon, SIGKILL);
        char path[256];
        snprintf(path, sizeof path, "%s/partial/%s/a.hdr", f->daemon.root, strrchr(torn, '/') + 1);
        const bool is_torn = in_time && access(path, F_OK) == 0;
        const int64_t first = is_torn ? written(f, "partial", torn, "a.hdr") : 0;
        n_torn += is_torn;
        daemon_restart(&f->daemon, NULL);
        daemon_wait(&f->daemon, torn, 120, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        assert_true(json_array_size(reply_at(&reply, "links.files")) >= 7);
        reply_done(&reply);
        assert_true(!is_torn || written(f, "results", torn, "a.hdr") == first);
        submit(f, cases[i].technique, cases[i].views, whole);
        daemon_wait(&f->daemon, whole, 120, &reply);
        assert_string_equal(reply_text(&reply, "state"), "succeeded");
        reply_done(&reply);
        expect_same(f, torn, whole, "files/a.hdr");
        expect_same(f, torn, whole, "files/b.hdr");
        expect_same(f, torn, whole, "files/c.hdr");
        daemon_expect_no_files(&f->daemon, "partial");
    }
    print_message("# %d of 3 jobs were torn in time\n", n_torn);
    assert_true(n_torn > 0);
}

/* Submits two jobs that share a computation, with two of three views done. Returns the time at
 * which the first view was written. */
static int64_t submit_both(struct daemon_room *f, char ret_leader[80], char ret_follower[80])
{
    submit(f, "backward", VIEWS("4000"), ret_leader);
    submit(f, "backward", "\"name\":\"other\"," VIEWS("4000"), ret_follower);
    assert_true(wait_for_files(f, ret_leader, 8));
    return written(f, "partial", ret_leader, "a.hdr");
}

/* The first of the two is cancelled and the daemon ends: the other continues with the finished
 * views. */
static void test_leader_is_cancelled(void **state)
{
    struct daemon_room *f = *state;
    char leader[80], follower[80];
    for (int i = 0; i < 2; i++) {
        const int64_t first = submit_both(f, leader, follower);
        cancel(f, leader);
        daemon_end(&f->daemon, i ? SIGTERM : SIGKILL);
        daemon_restart(&f->daemon, NULL);
        assert_true(wait_for_files(f, follower, 8));
        assert_true(written(f, "partial", follower, "a.hdr") == first);
        cancel(f, follower);
        daemon_expect_no_files(&f->daemon, "partial");
    }
}

/* The leader is cancelled while both wait, after the daemon has ended. */
static void test_waiting_leader_is_cancelled(void **state)
{
    struct daemon_room *f = *state;
    char leader[80], follower[80], blocker[80];
    const int64_t first = submit_both(f, leader, follower);
    submit(f, "direct", "\"priority\":9," VIEWS("4000"), blocker);
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, NULL);
    daemon_wait_running(&f->daemon, blocker, -1);
    cancel(f, leader);
    assert_true(written(f, "partial", follower, "a.hdr") == first);
    cancel(f, blocker);
    assert_true(wait_for_files(f, follower, 8));
    assert_true(written(f, "partial", follower, "a.hdr") == first);
    cancel(f, follower);
    daemon_expect_no_files(&f->daemon, "partial");
}

/* Files that a killed daemon left of jobs without waiting clients are removed at the start. */
static void test_leftovers_go(void **state)
{
    struct daemon_room *f = *state;
    char path[160];
    daemon_end(&f->daemon, SIGTERM);
    snprintf(path, sizeof path, "%s/partial/0123", f->daemon.root);
    assert_int_equal(mkdir(path, 0777), 0);
    daemon_restart(&f->daemon, NULL);
    assert_true(access(path, F_OK) != 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_views_before_the_end),
        cmocka_unit_test(test_torn_job_ends_the_same),
        cmocka_unit_test(test_leader_is_cancelled),
        cmocka_unit_test(test_waiting_leader_is_cancelled),
        cmocka_unit_test(test_leftovers_go),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}
