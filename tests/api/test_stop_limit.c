/* A thread that is blocked for good: SIGTERM ends the daemon all the same, and nothing is lost. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "health/blame.h"
#include "process/limits.h"
#include "process/sanitized.h"
#include "support/daemon.h"
#include "support/patience.h"
#include "support/scene_text.h"

/* Restarts the daemon with a thread that hangs when it moves a job's results to their place. */
static void restart_hanging(struct daemon *daemon, const char *const *extra)
{
    char shim[256];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(shim, sizeof shim, "%s/tests/faulty.so", build ? build : "build");
    assert_int_equal(daemon_end(daemon, SIGTERM), 0);
    setenv("LD_PRELOAD", shim, 1);
    setenv("FAULTY_HANG", "/results/", 1);
    daemon_restart(daemon, extra);
    unsetenv("LD_PRELOAD");
    unsetenv("FAULTY_HANG");
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

/* Waits until the job is all done but for moving its results. */
static void wait_hanging(const struct daemon *daemon, const char *job)
{
    char path[160];
    snprintf(path, sizeof path, "%s/partial/%s/result.json", daemon->root, strrchr(job, '/') + 1);
    for (double until = patience_until(); access(path, R_OK) != 0 && patience_nap(until);)
        continue;
    assert_int_equal(access(path, R_OK), 0);
}

static void test_blocked_thread(void **state)
{
    static const char *const one[] = {"--jobs", "1", "--threads", "1", NULL};
    struct daemon_room *f = *state;
    struct reply reply;
    char job[80], other[80];
    if (ORL_SANITIZED)
        skip(); /* which has to be loaded first */
    restart_hanging(&f->daemon, one);
    daemon_submit(&f->daemon, f->scene, 1000, 5, "blocked", job);
    wait_hanging(&f->daemon, job);
    daemon_submit(&f->daemon, f->scene, 1000, 6, NULL, other);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 1);
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

/* Whose daemon was told to stop is not to blame. */
static void test_no_blame(void **state)
{
    const struct orl_past stopped = {.signum = ORL_PAST_STOPPED, .resident = 9, .capacity = 10};
    (void)state;
    assert_false(orl_blame_is(&stopped, true, true));
    assert_false(orl_blame_is(&stopped, false, true));
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
