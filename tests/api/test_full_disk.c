/* A data folder on a small separate file system that is full, with a real daemon: it starts,
 * answers, refuses new data, and removes; then it continues. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <unistd.h>

#include "support/daemon.h"
#include "support/storage.h"

static void write_line(const char *path, const char *line)
{
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, line, strlen(line)), strlen(line));
    close(fd);
}

/* Creates mounts visible only to this program and its children. Without that permission the test is
 * skipped. */
static bool own_mounts(void)
{
    char map[64];
    const unsigned uid = geteuid(), gid = getegid();
    if (uid == 0 && unshare(CLONE_NEWNS) == 0)
        return mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0;
    if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
        return false;
    write_line("/proc/self/setgroups", "deny");
    snprintf(map, sizeof map, "0 %u 1", uid);
    write_line("/proc/self/uid_map", map);
    snprintf(map, sizeof map, "0 %u 1", gid);
    write_line("/proc/self/gid_map", map);
    return mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0;
}

static bool mounts;

static void skip_without_mounts(void)
{
    if (!mounts)
        skip();
}

/* Writes a file of the data folder that fills the disk. */
static void fill_disk(const struct daemon *daemon)
{
    static char zeros[4096];
    char path[96];
    snprintf(path, sizeof path, "%s/filler", daemon->root);
    const int fd = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    assert_true(fd >= 0);
    while (write(fd, zeros, sizeof zeros) > 0)
        continue;
    assert_int_equal(errno, ENOSPC);
    close(fd);
}

static void expect_status(struct daemon *daemon, const char *path, long status, const char *member,
                          const char *value)
{
    struct reply reply;
    daemon_get(daemon, path, &reply);
    assert_int_equal(reply.status, status);
    assert_string_equal(reply_text(&reply, member), value);
    reply_done(&reply);
}

static void expect_refusals(struct daemon *daemon, const char *scene)
{
    static const char ball[] = "void plastic x 0 0 5 .5 .5 .5 0 0\nx sphere s 0 0 4 0 0 0 1\n";
    const struct upload_file file = {"ball.rad", ball, strlen(ball), false};
    struct reply reply;
    char text[200];
    daemon_upload(daemon, &file, 1, NULL, &reply);
    assert_int_equal(reply.status, 507);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:disk-full");
    reply_done(&reply);
    snprintf(text, sizeof text, "{\"scene\":\"%s\",\"sensors\":[[2,1,0.8,0,0,1]]}", scene);
    daemon_post_json(daemon, "/v1/jobs", text, &reply);
    assert_int_equal(reply.status, 507);
    assert_string_equal(reply_text(&reply, "type"), "urn:oriel:error:disk-full");
    reply_done(&reply);
}

/* The daemon checks its disk once a second. */
static void wait_for_room(struct daemon *daemon)
{
    daemon_wait_status(daemon, "/readyz", 200);
    expect_status(daemon, "/healthz", 200, "disk", "ok");
}

/* One job waits, another has ended; the daemon is stopped or killed, and the disk is filled. */
static void fill_and_start(struct daemon_room *f, int signum, char ret_ended[80],
                           char ret_waiting[80])
{
    storage_run_job(&f->daemon, f->scene, 1, "v", ret_ended);
    daemon_submit(&f->daemon, f->scene, 100000000, 2, NULL, ret_waiting);
    daemon_wait_running(&f->daemon, ret_waiting, -1);
    daemon_end(&f->daemon, signum);
    fill_disk(&f->daemon);
    daemon_restart(&f->daemon, NULL);
}

static void start_on_full_disk(struct daemon_room *f, int signum)
{
    char ended[80], waiting[80], path[96];
    struct reply reply;
    skip_without_mounts();
    fill_and_start(f, signum, ended, waiting);
    expect_status(&f->daemon, "/healthz", 200, "disk", "full");
    expect_status(&f->daemon, "/readyz", 503, "status", "disk full");
    expect_status(&f->daemon, waiting, 200, "state", "queued");
    storage_fetch(&f->daemon, ended, 200);
    expect_refusals(&f->daemon, f->scene);
    /* Repeated: each start has space for the database. */
    for (int i = 0; i < 2; i++) {
        daemon_end(&f->daemon, i == 0 ? SIGTERM : SIGKILL);
        fill_disk(&f->daemon);
        daemon_restart(&f->daemon, NULL);
        expect_status(&f->daemon, "/healthz", 200, "disk", "full");
    }
    storage_expect(&f->daemon, "DELETE", ended, 204, NULL);
    storage_expect(&f->daemon, "GET", ended, 404, NULL);
    daemon_cancel(&f->daemon, waiting, &reply);
    assert_int_equal(reply.status, 200);
    reply_done(&reply);
    storage_expect(&f->daemon, "DELETE", waiting, 204, NULL);
    snprintf(path, sizeof path, "%s/filler", f->daemon.root);
    assert_int_equal(unlink(path), 0);
    wait_for_room(&f->daemon);
    storage_run_job(&f->daemon, f->scene, 3, "w", ended);
}

static void test_start_after_stop(void **state)
{
    start_on_full_disk(*state, SIGTERM);
}

static void test_start_after_kill(void **state)
{
    start_on_full_disk(*state, SIGKILL);
}

/* A held job starts by itself. */
static void test_held_job_starts(void **state)
{
    struct daemon_room *f = *state;
    char ended[80], waiting[80], path[96];
    struct reply reply;
    skip_without_mounts();
    fill_and_start(f, SIGTERM, ended, waiting);
    expect_status(&f->daemon, waiting, 200, "state", "queued");
    snprintf(path, sizeof path, "%s/filler", f->daemon.root);
    assert_int_equal(unlink(path), 0);
    daemon_wait_running(&f->daemon, waiting, -1);
    daemon_cancel(&f->daemon, waiting, &reply);
    reply_done(&reply);
}

/* The disk fills up while the daemon runs. */
static void test_full_while_running(void **state)
{
    struct daemon_room *f = *state;
    char job[80], path[96];
    skip_without_mounts();
    storage_run_job(&f->daemon, f->scene, 1, "v", job);
    fill_disk(&f->daemon);
    storage_expect(&f->daemon, "DELETE", job, 204, NULL);
    fill_disk(&f->daemon);
    daemon_wait_status(&f->daemon, "/readyz", 503);
    expect_status(&f->daemon, "/readyz", 503, "status", "disk full");
    expect_refusals(&f->daemon, f->scene);
    snprintf(path, sizeof path, "%s/filler", f->daemon.root);
    assert_int_equal(unlink(path), 0);
    wait_for_room(&f->daemon);
}

static int set_up(void **state)
{
    static struct daemon_room f;
    struct daemon *daemon = &f.daemon;
    memset(&f, 0, sizeof f);
    *state = &f;
    if (!mounts)
        return 0;
    snprintf(daemon->root, sizeof daemon->root, "/tmp/oriel-test-XXXXXX");
    if (!mkdtemp(daemon->root) || mount("none", daemon->root, "tmpfs", 0, "size=32m,mode=0700"))
        return -1;
    daemon_restart(daemon, NULL);
    daemon_upload_room(daemon, f.scene);
    return 0;
}

static int tear_down(void **state)
{
    struct daemon_room *f = *state;
    char root[64];
    if (!mounts)
        return 0;
    snprintf(root, sizeof root, "%s", f->daemon.root);
    if (f->daemon.pid > 0)
        daemon_end(&f->daemon, SIGTERM);
    if (umount(root) != 0)
        return -1;
    daemon_remove(&f->daemon);
    return 0;
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_start_after_stop),
        EACH(test_start_after_kill),
        EACH(test_held_job_starts),
        EACH(test_full_while_running),
    };
    mounts = own_mounts();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
