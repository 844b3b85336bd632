/* A thread blocked for ever: SIGTERM still ends the daemon, and nothing is lost. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "health/crash.h"
#include "process/limits.h"
#include "support/daemon.h"
#include "support/patience.h"
#include "support/scene_text.h"

/* Returns the path of the folder that the hanging thread makes as a sign that it hangs. */
static const char *note_of(const struct daemon *daemon, char path[96])
{
    snprintf(path, 96, "%.64s.hangs", daemon->root);
    return path;
}

/*
 * Restarts the daemon with a thread that hangs when it moves a job's results to their final place.
 */
static void restart_hanging(struct daemon *daemon, const char *const *extra)
{
    char shim[256], path[96];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(shim, sizeof shim, "%s/tests/faulty.so", build ? build : "build");
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    setenv("LD_PRELOAD", shim, 1);
    setenv("FAULTY_HANG", "/results/", 1);
    setenv("FAULTY_HANG_NOTE", note_of(daemon, path), 1);
    daemon_restart(daemon, extra);
    unsetenv("LD_PRELOAD");
    unsetenv("FAULTY_HANG");
    unsetenv("FAULTY_HANG_NOTE");
}

static size_t count_in_log(const struct daemon *daemon, const char *text)
{
    char path[96];
    size_t size = 0, count = 0;
    snprintf(path, sizeof path, "%s.log", daemon->root);
    char *log = (char *)scene_read_bytes(path, &size);
    for (const char *at = log; (at = memmem(at, size - (size_t)(at - log), text, strlen(text)));
         at += strlen(text))
        count++;
    free(log);
    return count;
}

/* Waits until the job is complete except for moving its results. */
static void wait_hanging(const struct daemon *daemon)
{
    char path[96];
    note_of(daemon, path);
    for (double until = patience_until(); access(path, R_OK) != 0 && patience_nap(until);)
        continue;
    assert_int_equal(rmdir(path), 0);
}

/* Further signals do not extend the limit. */
static int end_by_many_signals(struct daemon *daemon)
{
    siginfo_t info = {.si_pid = 0};
    for (double until = patience_until(); info.si_pid == 0 && patience_nap(until);) {
        kill(daemon->pid, SIGTERM);
        assert_int_equal(waitid(P_PID, (id_t)daemon->pid, &info, WEXITED | WNOHANG | WNOWAIT), 0);
    }
    assert_int_equal(info.si_pid, daemon->pid);
    return daemon_wait_end(daemon);
}

static void test_blocked_thread(void **state)
{
    static const char *const one[] = {"--jobs", "1", "--threads", "1", NULL};
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], other[80];
    if (ORL_SANITIZED)
        skip(); /* the sanitizer's library has to be loaded first */
    restart_hanging(&f->daemon, one);
    daemon_submit(&f->daemon, f->scene, 1000, 5, "blocked", job);
    wait_hanging(&f->daemon);
    daemon_submit(&f->daemon, f->scene, 1000, 6, NULL, other);
    assert_int_equal(end_by_many_signals(&f->daemon), 1);
    assert_int_equal(count_in_log(&f->daemon, "event=stop-forced signal=15"), 1);
    daemon_restart(&f->daemon, NULL);
    daemon_wait(&f->daemon, job, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    daemon_wait(&f->daemon, other, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    assert_int_equal(count_in_log(&f->daemon, "blamed=yes"), 0);
}

/* A job of a daemon that was asked to stop is not blamed. */
static void test_no_blame(void **state)
{
    const struct orl_previous_exit stopped = {
        .signum = ORL_EXIT_STOPPED, .resident = 9, .capacity = 10};
    (void)state;
    assert_false(orl_previous_exit_caused_by(&stopped, true, true));
    assert_false(orl_previous_exit_caused_by(&stopped, false, true));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_blocked_thread, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test(test_no_blame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
