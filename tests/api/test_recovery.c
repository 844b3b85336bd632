/* Recovery: kill -9 during a job, repeatedly; orderly stops; and the state after a restart. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "health/crash.h"
#include "support/daemon.h"

enum { PHOTONS = 20000, MANY_PHOTONS = 100000000, SOME_PHOTONS = 2000000 };

static void expect_state(struct daemon *daemon, const char *job, const char *state, int attempts)
{
    struct reply reply;
    daemon_wait(daemon, job, 120, &reply);
    if (strcmp(reply_text(&reply, "state"), state) != 0 ||
        reply_number(&reply, "attempts") != attempts)
        fail_msg("%s: %s", job, reply.body);
    reply_done(&reply);
}

static void expect_file(struct daemon *daemon, const char *job, const char *name)
{
    struct reply reply;
    char path[160];
    snprintf(path, sizeof path, "%s/files/%s", job, name);
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, 200);
    assert_true(reply.size > 0);
    reply_done(&reply);
}

static void test_killed_in_the_middle(void **state)
{
    struct daemon_room *f = *state;
    char done[80], running[80], waiting[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, "kept", done);
    expect_state(&f->daemon, done, "succeeded", 1);
    daemon_submit(&f->daemon, f->scene, SOME_PHOTONS, 2, "torn", running);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 1, "later", waiting);
    daemon_wait_running(&f->daemon, running, 0);
    assert_int_equal(daemon_end(&f->daemon, SIGKILL), -1);

    daemon_restart(&f->daemon, NULL);
    expect_file(&f->daemon, done, "kept.hdr");
    expect_state(&f->daemon, done, "succeeded", 1);
    expect_state(&f->daemon, running, "succeeded", 2);
    expect_file(&f->daemon, running, "torn.png");
    expect_state(&f->daemon, waiting, "succeeded", 1);
    daemon_expect_no_files(&f->daemon, "tmp");
    /* The map built before the kill is still a hit. */
    daemon_get(&f->daemon, waiting, &reply);
    assert_true(json_is_true(reply_at(&reply, "maps.0.cached")));
    reply_done(&reply);
}

/* Changes the daemon's record for the next start: that many fewer earlier OOM kills, as if more had
 * happened since. */
static void forget_oom_kills(const struct daemon *daemon, uint64_t kills)
{
    struct orl_previous_exit previous_exit;
    char path[96];
    snprintf(path, sizeof path, "%s/oriel.running", daemon->root);
    FILE *page = fopen(path, "r+");
    assert_non_null(page);
    assert_int_equal(fread(&previous_exit, sizeof previous_exit, 1, page), 1);
    assert_true(previous_exit.oom_kills != UINT64_MAX);
    previous_exit.oom_kills -= kills;
    rewind(page);
    assert_int_equal(fwrite(&previous_exit, sizeof previous_exit, 1, page), 1);
    fclose(page);
}

static void kill_thrice(struct daemon_room *f, const char *job, uint64_t oom_kills)
{
    for (int i = 0; i < 3; i++) {
        daemon_wait_running(&f->daemon, job, -1);
        daemon_end(&f->daemon, SIGKILL);
        forget_oom_kills(&f->daemon, oom_kills);
        daemon_restart(&f->daemon, NULL);
    }
}

/* A job that (apparently) kills the daemon is not retried for ever; the queue continues. */
static void test_third_kill_fails_the_job(void **state)
{
    struct daemon_room *f = *state;
    char killer[80], next[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 3, NULL, killer);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 3, NULL, next);
    kill_thrice(f, killer, 1);
    expect_state(&f->daemon, killer, "failed", 3);
    daemon_get(&f->daemon, killer, &reply);
    assert_non_null(strstr(reply_text(&reply, "error.detail"), "3 times"));
    assert_true(strlen(reply_text(&reply, "error.hint")) > 0);
    reply_done(&reply);
    expect_state(&f->daemon, next, "succeeded", 1);
}

/* A daemon killed from outside, with free memory, blames no job. */
static void test_kills_from_outside_fail_no_job(void **state)
{
    struct daemon_room *f = *state;
    char job[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 3, NULL, job);
    kill_thrice(f, job, 0);
    daemon_wait_running(&f->daemon, job, -1);
    daemon_cancel(&f->daemon, job, &reply);
    reply_done(&reply);
    expect_state(&f->daemon, job, "cancelled", 4);
}

/* SIGTERM: the job is queued again, and that does not count as an attempt. */
static void test_orderly_stop_requeues(void **state)
{
    struct daemon_room *f = *state;
    char running[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 4, NULL, running);
    for (int i = 0; i < 4; i++) {
        daemon_wait_running(&f->daemon, running, -1);
        assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
        daemon_restart(&f->daemon, NULL);
    }
    daemon_wait_running(&f->daemon, running, -1);
    daemon_get(&f->daemon, running, &reply);
    assert_true(reply_number(&reply, "attempts") == 1);
    reply_done(&reply);
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    expect_state(&f->daemon, running, "cancelled", 1);
}

static void submit_for_seconds(struct daemon_room *f, int seconds, char ret_path[80])
{
    char text[512];
    struct reply reply;
    snprintf(text, sizeof text,
             "{\"scene\":\"%s\",\"technique\":\"backward\",\"accuracy\":{\"deadline_s\":%d},"
             "\"sensors\":[[2,1,0.8,0,0,1]]}",
             f->scene, seconds);
    daemon_post_json(&f->daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 202);
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

/* While draining, requests about jobs are answered, and new jobs are refused. */
static void check_draining(struct daemon_room *f, const char *running)
{
    struct reply reply;
    daemon_wait_status(&f->daemon, "/readyz", 503);
    daemon_get(&f->daemon, running, &reply);
    assert_int_equal(reply.status, 200);
    assert_string_equal(reply_text(&reply, "state"), "running");
    reply_done(&reply);
    daemon_post_json(&f->daemon, "/v1/jobs", "{}", &reply);
    assert_int_equal(reply.status, 503);
    assert_non_null(reply_header(&reply, "Retry-After"));
    reply_done(&reply);
}

/*
 * Two jobs run at once, and the daemon is killed whenever the first one runs. It fails in the end,
 * and the other succeeds, since from the second start on each runs alone. The first end counts
 * against neither.
 */
static void test_bystanders_go_on(void **state)
{
    static const char *const two[] = {"--jobs", "2", "--threads", "2", NULL};
    struct daemon_room *f = *state;
    char killer[80], bystander[80];
    struct reply reply;
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, two);
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 7, NULL, killer);
    submit_for_seconds(f, 1, bystander);
    daemon_wait_running(&f->daemon, bystander, -1);
    for (int i = 0; i < 4; i++) {
        daemon_wait_running(&f->daemon, killer, -1);
        daemon_get(&f->daemon, bystander, &reply);
        assert_string_equal(reply_text(&reply, "state"), i == 0 ? "running" : "queued");
        reply_done(&reply);
        daemon_end(&f->daemon, SIGKILL);
        forget_oom_kills(&f->daemon, 1);
        daemon_restart(&f->daemon, two);
    }
    expect_state(&f->daemon, killer, "failed", 4);
    expect_state(&f->daemon, bystander, "succeeded", 2);
}

/* SIGTERM with a drain time: running jobs finish, waiting jobs remain for the next start. */
static void test_drain(void **state)
{
    static const char *const patient[] = {"--drain-timeout", "60", NULL};
    struct daemon_room *f = *state;
    char running[80], waiting[80];
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, patient);
    submit_for_seconds(f, 3, running);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 8, NULL, waiting);
    daemon_wait_running(&f->daemon, running, -1);
    kill(f->daemon.pid, SIGTERM);
    check_draining(f, running);
    assert_int_equal(daemon_wait_end(&f->daemon), 0);
    daemon_restart(&f->daemon, NULL);
    expect_state(&f->daemon, running, "succeeded", 1);
    expect_state(&f->daemon, waiting, "succeeded", 1);
}

/* When the time is over, or a second signal comes, the job is queued again. */
static void test_drain_is_bounded(void **state)
{
    static const char *const extra[2][3] = {{"--drain-timeout", "1", NULL},
                                            {"--drain-timeout", "600", NULL}};
    struct daemon_room *f = *state;
    char running[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 9, NULL, running);
    for (int i = 0; i < 2; i++) {
        daemon_end(&f->daemon, SIGTERM);
        daemon_restart(&f->daemon, extra[i]);
        daemon_wait_running(&f->daemon, running, -1);
    }
    kill(f->daemon.pid, SIGTERM);
    check_draining(f, running);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
    daemon_wait_running(&f->daemon, running, -1);
    daemon_cancel(&f->daemon, running, &reply);
    reply_done(&reply);
    expect_state(&f->daemon, running, "cancelled", 1);
}

/* An acknowledged cancellation holds, even if the daemon is killed right after. */
static void test_cancelled_stays_cancelled(void **state)
{
    struct daemon_room *f = *state;
    char running[80];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, MANY_PHOTONS, 6, NULL, running);
    daemon_wait_running(&f->daemon, running, -1);
    daemon_cancel(&f->daemon, running, &reply);
    assert_int_equal(reply.status, 202);
    reply_done(&reply);
    daemon_end(&f->daemon, SIGKILL);
    daemon_restart(&f->daemon, NULL);
    expect_state(&f->daemon, running, "cancelled", 1);
}

/* Files that a crash may leave: half-written ones, and a map without a row. */
static void test_leftovers_go_at_start(void **state)
{
    struct daemon_room *f = *state;
    char path[160];
    static const char *const leftovers[] = {"tmp/abc", "maps/global-00ff.opm"};
    daemon_end(&f->daemon, SIGKILL);
    for (size_t i = 0; i < sizeof leftovers / sizeof *leftovers; i++) {
        snprintf(path, sizeof path, "%s/%s", f->daemon.root, leftovers[i]);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs("half", file);
        fclose(file);
    }
    daemon_restart(&f->daemon, NULL);
    for (size_t i = 0; i < sizeof leftovers / sizeof *leftovers; i++) {
        snprintf(path, sizeof path, "%s/%s", f->daemon.root, leftovers[i]);
        assert_true(access(path, F_OK) != 0);
    }
}

/*
 * The maps' bytes are damaged on the disk: the daemon detects this, builds them again, and warns.
 */
static void test_damaged_map_is_built_again(void **state)
{
    struct daemon_room *f = *state;
    char job[80], path[160], command[400];
    struct reply reply;
    daemon_submit(&f->daemon, f->scene, PHOTONS, 5, NULL, job);
    expect_state(&f->daemon, job, "succeeded", 1);
    snprintf(command, sizeof command,
             "for f in %s/maps/*.opm; do printf spoilt | dd of=$f bs=1 seek=1000 conv=notrunc "
             "2>/dev/null || exit 1; done",
             f->daemon.root);
    assert_int_equal(system(command), 0);
    daemon_submit(&f->daemon, f->scene, PHOTONS, 5, NULL, job);
    expect_state(&f->daemon, job, "succeeded", 1);
    snprintf(path, sizeof path, "%s/result", job);
    daemon_get(&f->daemon, path, &reply);
    assert_true(json_is_false(reply_at(&reply, "maps.0.cached")));
    assert_non_null(strstr(reply_text(&reply, "warnings.0"), "damaged"));
    reply_done(&reply);
}

/* A limit on the size of files ends the job that reaches it, not the daemon. */
static void test_file_size_limit(void **state)
{
    struct daemon_room *f = *state;
    struct rlimit before, tight;
    struct reply reply;
    char job[80];
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    tight = before;
    tight.rlim_cur = 1 << 20;
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    daemon_restart(&f->daemon, NULL);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    daemon_submit(&f->daemon, f->scene, 200000, 6, NULL, job);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "failed");
    assert_non_null(strstr(reply_text(&reply, "error.detail"), "File too large"));
    reply_done(&reply);
    daemon_expect_no_files(&f->daemon, "tmp");
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    daemon_restart(&f->daemon, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_killed_in_the_middle),
        cmocka_unit_test(test_third_kill_fails_the_job),
        cmocka_unit_test(test_kills_from_outside_fail_no_job),
        cmocka_unit_test(test_orderly_stop_requeues),
        cmocka_unit_test(test_bystanders_go_on),
        cmocka_unit_test(test_drain),
        cmocka_unit_test(test_drain_is_bounded),
        cmocka_unit_test(test_cancelled_stays_cancelled),
        cmocka_unit_test(test_leftovers_go_at_start),
        cmocka_unit_test(test_damaged_map_is_built_again),
        cmocka_unit_test(test_file_size_limit),
    };
    return cmocka_run_group_tests(tests, daemon_room_set_up, daemon_room_tear_down);
}
