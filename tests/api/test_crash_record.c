/* Crash attribution: the job whose thread crashed is named, not those that ran beside it. */
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

#include "health/crash.h"
#include "process/limits.h"
#include "support/daemon.h"
#include "support/daemon_metric.h"
#include "support/scene_text.h"

static void expect_state(struct daemon *daemon, const char *job, const char *state, int attempts)
{
    struct reply reply;
    daemon_wait(daemon, job, 120, &reply);
    if (strcmp(reply_text(&reply, "state"), state) != 0 ||
        reply_number(&reply, "attempts") != attempts)
        fail_msg("%s: %s", job, reply.body);
    reply_done(&reply);
}

static bool log_has(const struct daemon *daemon, const char *text)
{
    char path[96];
    snprintf(path, sizeof path, "%s.log", daemon->root);
    size_t size = 0;
    unsigned char *log = scene_read_bytes(path, &size);
    const bool found = memmem(log, size, text, strlen(text)) != NULL;
    free(log);
    return found;
}

/* Restarts the daemon with a library that causes the faults selected by the variable. */
static void restart_faulty(struct daemon_room *f, const char *variable, const char *value,
                           const char *const *extra)
{
    char shim[256];
    const char *build = getenv("ORIEL_BUILD");
    snprintf(shim, sizeof shim, "%s/tests/faulty.so", build ? build : "build");
    daemon_end(&f->daemon, SIGTERM);
    setenv("LD_PRELOAD", shim, 1);
    setenv(variable, value, 1);
    daemon_restart(&f->daemon, extra);
}

/* Disables faults for daemons started from now on. */
static void end_faults(void)
{
    unsetenv("LD_PRELOAD");
    unsetenv("FAULTY_CRASH");
    unsetenv("FAULTY_JUMP");
    unsetenv("FAULTY_OVERFLOW");
}

static void test_rules(void **state)
{
    const struct orl_previous_exit marked = {.signum = SIGSEGV, .job = "0123"};
    const struct orl_previous_exit silent = {.resident = 10, .capacity = 100};
    const struct orl_previous_exit checking = {.resident = 10, .capacity = 100, .checks = 1};
    const struct orl_previous_exit grown = {.resident = 90, .capacity = 100, .checks = 1};
    (void)state;
    assert_true(orl_previous_exit_caused_by(&marked, true, false));
    assert_false(orl_previous_exit_caused_by(&marked, false, true));
    assert_true(orl_previous_exit_caused_by(&silent, false, true));
    assert_false(orl_previous_exit_caused_by(&silent, false, false));
    assert_false(orl_previous_exit_caused_by(&checking, false, true));
    assert_true(orl_previous_exit_caused_by(&grown, false, true));
    const struct orl_previous_exit rebooted = {.resident = 99, .capacity = 100, .rebooted = true};
    const struct orl_previous_exit killed = {.resident = 90, .capacity = 100, .not_oom = true};
    const struct orl_previous_exit used_up = {.resident = 91, .capacity = 100, .not_oom = true};
    const struct orl_previous_exit named = {
        .signum = SIGBUS, .job = "0123", .not_oom = true, .rebooted = true};
    assert_false(orl_previous_exit_caused_by(&rebooted, false, true));
    assert_false(orl_previous_exit_caused_by(&killed, false, true));
    assert_true(orl_previous_exit_caused_by(&used_up, false, true));
    assert_false(orl_previous_exit_caused_by(&used_up, false, false));
    assert_true(orl_previous_exit_caused_by(&named, true, false));
}

/* A fault in a job's thread: reports and the log name that job, and it fails at the third. The job
 * that ran beside it at the first fault continues. */
static void test_faults_are_named(void **state)
{
    static const char *const two[] = {"--jobs", "2", "--threads", "2", NULL};
    struct daemon_room *f = *state;
    char killer[80], bystander[80], line[120];
    if (ORL_SANITIZED)
        skip();
    restart_faulty(f, "FAULTY_CRASH", "killer.hdr", two);
    daemon_submit(&f->daemon, f->scene, 2000000, 5, NULL, bystander);
    daemon_wait_running(&f->daemon, bystander, -1);
    daemon_submit(&f->daemon, f->scene, 1000, 6, "killer", killer);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(daemon_wait_end(&f->daemon), -1);
        daemon_restart(&f->daemon, two);
    }
    end_faults();
    expect_state(&f->daemon, killer, "failed", 3);
    expect_state(&f->daemon, bystander, "succeeded", 2);
    snprintf(line, sizeof line, "event=crashed signal=11 job=%s", strrchr(killer, '/') + 1);
    assert_true(log_has(&f->daemon, line));
    assert_true(log_has(&f->daemon, "event=crashed-at frames="));
    assert_true(log_has(&f->daemon, "faulty.so+0x"));
    assert_true(log_has(&f->daemon, ",orield+0x"));
}

static void expect_line(const struct daemon *daemon, const char *text)
{
    if (!log_has(daemon, text))
        fail_msg("the log lacks '%s'", text);
}

/* Sends a request whose handler opens the named result file, and waits until the daemon ends. */
static void crash_by_request(struct daemon_room *f, const char *job)
{
    char request[256];
    const int length = snprintf(request, sizeof request,
                                "GET %s/files/result.json HTTP/1.1\r\nHost: localhost:%s\r\n\r\n",
                                job, strrchr(f->daemon.url, ':') + 1);
    const int fd = daemon_dial(&f->daemon);
    assert_int_equal(write(fd, request, (size_t)length), length);
    assert_int_equal(daemon_wait_end(&f->daemon), -1);
    close(fd);
}

/* The crash report names the request, and no job. */
static void expect_crash_by_request(struct daemon_room *f, const char *fault, const char *job)
{
    char line[160];
    restart_faulty(f, fault, "result.json", NULL);
    crash_by_request(f, job);
    expect_line(&f->daemon, "event=crashed signal=11 job=-");
    snprintf(line, sizeof line, " method=GET path=%s/files/result.json", job);
    expect_line(&f->daemon, line);
}

/* A call through a null pointer in a request's handler: the unwinder finds no caller, but the
 * report has the registers, the return address and the request. */
static void test_calls_of_null_are_located(void **state)
{
    static const char *const json[] = {"--log-format", "json", NULL};
    struct daemon_room *f = *state;
    char job[80];
    if (ORL_SANITIZED)
        skip();
    daemon_submit(&f->daemon, f->scene, 1000, 6, NULL, job);
    expect_state(&f->daemon, job, "succeeded", 1);
    expect_crash_by_request(f, "FAULTY_JUMP", job);
    expect_line(&f->daemon, "event=crashed-registers code=1 address=0x0 pc=0x0 sp=0x7f");
    expect_line(&f->daemon, " caller=faulty.so+0x");
    end_faults();
    daemon_restart(&f->daemon, NULL);
    restart_faulty(f, "FAULTY_JUMP", "result.json", json);
    crash_by_request(f, job);
    expect_line(&f->daemon, "\"event\":\"crashed-registers\",\"code\":1,\"address\":\"0x0\","
                            "\"pc\":\"0x0\",\"sp\":\"0x7f");
    expect_line(&f->daemon, ",\"caller\":\"faulty.so+0x");
    end_faults();
    daemon_restart(&f->daemon, NULL);
}

/* The signal handler runs on a separate stack on the loop's thread, too. */
static void test_stack_overflows_are_reported(void **state)
{
    struct daemon_room *f = *state;
    char job[80];
    if (ORL_SANITIZED)
        skip();
    daemon_submit(&f->daemon, f->scene, 1000, 6, NULL, job);
    expect_state(&f->daemon, job, "succeeded", 1);
    expect_crash_by_request(f, "FAULTY_OVERFLOW", job);
    end_faults();
    daemon_restart(&f->daemon, NULL);
}

/* The daemon is killed whenever uploads are being checked, and the only job has not grown: it does
 * not count against the job. */
static void test_uploads_are_no_jobs_fault(void **state)
{
    struct daemon_room *f = *state;
    char job[80], part[40 * 40] = "";
    struct reply reply;
    for (int i = 0; i < 40; i++)
        sprintf(part + strlen(part), "grey sphere s%d 0 0 4 %d 0 0 .1\n", i, i);
    daemon_submit(&f->daemon, f->scene, 100000000, 3, NULL, job);
    for (int i = 0; i < 4; i++) {
        daemon_wait_running(&f->daemon, job, -1);
        const pid_t client = fork();
        if (client == 0) {
            static const char scene[] = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
                                        "!xform -a 50000 -t 0 0 1 part.rad\n";
            const struct upload_file files[] = {{"scene.rad", scene, sizeof scene - 1, false},
                                                {"part.rad", part, strlen(part), true}};
            struct daemon own = f->daemon;
            own.curl = curl_easy_init();
            daemon_upload(&own, files, 2, NULL, &reply);
            _exit(0);
        }
        daemon_metric_wait(&f->daemon, "oriel_memory_checks_bytes", 1);
        kill(client, SIGSTOP);
        daemon_end(&f->daemon, SIGKILL);
        kill(client, SIGKILL);
        waitpid(client, NULL, 0);
        daemon_restart(&f->daemon, NULL);
    }
    daemon_wait_running(&f->daemon, job, -1);
    daemon_cancel(&f->daemon, job, &reply);
    reply_done(&reply);
    expect_state(&f->daemon, job, "cancelled", 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rules),
        cmocka_unit_test_setup_teardown(test_faults_are_named, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_calls_of_null_are_located, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_stack_overflows_are_reported, daemon_room_set_up,
                                        daemon_room_tear_down),
        cmocka_unit_test_setup_teardown(test_uploads_are_no_jobs_fault, daemon_room_set_up,
                                        daemon_room_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
