/*
 * orield --runner slurm on a real Slurm on loopback: large jobs go as its tasks, with the results
 * of a daemon that does all by itself; small ones stay; and what goes wrong, each without a loss.
 */
#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/cluster.h"
#include "support/daemon.h"
#include "support/daemon_metric.h"
#include "support/parted.h"

struct fixture {
    struct cli_desk *desk;
    struct daemon daemon;
    char shared[96];
    const char *options[16];
};

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    void *desk = NULL;
    assert_non_null(f);
    const int code = parted_set_up(&desk);
    f->desk = desk;
    snprintf(f->shared, sizeof f->shared, "%s/shared", f->desk->folder);
    const char *const options[] = {"--runner", "slurm", "--shared",  f->shared, "--least", "0",
                                   "--parts",  "4",     "--threads", "1",       NULL};
    memcpy(f->options, options, sizeof options);
    daemon_start(&f->daemon, f->options);
    setenv("ORIEL_URL", f->daemon.url, 1);
    *state = f;
    return code;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    void *desk = f->desk;
    daemon_remove(&f->daemon);
    cli_desk_tear_down(&desk);
    free(f);
    return 0;
}

static void run(struct fixture *f, const char *const *args)
{
    cli_run(args, &f->desk->result);
    if (f->desk->result.exit_code != 0)
        fail_msg("oriel %s: %s", args[0], f->desk->result.err);
}

static void submit(struct fixture *f, const char *document, char ret_path[80])
{
    char path[160], id[40] = "";
    snprintf(path, sizeof path, "%s/%s", f->desk->folder, document);
    const char *const args[] = {"submit", path, NULL};
    run(f, args);
    assert_int_equal(sscanf(f->desk->result.out, "%36s", id), 1);
    snprintf(ret_path, 80, "/v1/jobs/%s", id);
}

static void fetch(struct fixture *f, const char *path, const char *output)
{
    char to[160];
    snprintf(to, sizeof to, "%s/%s", f->desk->folder, output);
    const char *const args[] = {"fetch", path + strlen("/v1/jobs/"), "-o", to, NULL};
    run(f, args);
}

static void wait_until_done(struct fixture *f, const char *path)
{
    struct reply reply;
    daemon_wait(&f->daemon, path, 240, &reply);
    if (strcmp(reply_text(&reply, "state"), "succeeded") != 0)
        fail_msg("%s", reply.body);
    assert_string_equal(reply_text(&reply, "runner.name"), "slurm");
    if (!(reply_number(&reply, "runner.parts.done") > 1))
        fail_msg("%s", reply.body);
    assert_true(reply_number(&reply, "runner.parts.waiting") == 0);
    reply_done(&reply);
}

/* Nothing is left in the shared folder. */
static void assert_cleared(const struct fixture *f)
{
    assert_int_equal(rmdir(f->shared), 0);
    assert_int_equal(mkdir(f->shared, 0700), 0);
}

/* What was fetched into "slurm", and what a daemon finds that has no Slurm. */
static void compare_fetched(struct fixture *f, const char *document)
{
    static const char *const alone[] = {"--threads", "1", NULL};
    struct daemon other;
    struct reply reply;
    char path[80];
    daemon_start(&other, alone);
    setenv("ORIEL_URL", other.url, 1);
    submit(f, document, path);
    daemon_wait(&other, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    fetch(f, path, "local");
    daemon_remove(&other);
    setenv("ORIEL_URL", f->daemon.url, 1);
    parted_assert_same(f->desk, "local", "slurm");
}

/* Of a job that is done, or will be. */
static void compare(struct fixture *f, const char *document, const char *path)
{
    wait_until_done(f, path);
    fetch(f, path, "slurm");
    assert_cleared(f);
    compare_fetched(f, document);
}

static void test_a_render(void **state)
{
    char path[80];
    submit(*state, parted_render, path);
    compare(*state, parted_render, path);
}

static void test_a_year(void **state)
{
    char path[80];
    submit(*state, parted_annual, path);
    compare(*state, parted_annual, path);
}

/* ---- Faults ---------------------------------------------------------------------------------- */

static void restart(struct fixture *f)
{
    daemon_restart(&f->daemon, f->options);
    setenv("ORIEL_URL", f->daemon.url, 1);
}

/* Parts of the wave that is under way. */
static int count_parts(const struct fixture *f, const char *path)
{
    char folder[256], wave[256] = "";
    int n = 0;
    snprintf(folder, sizeof folder, "%s/%s", f->shared, path + strlen("/v1/jobs/"));
    for (int pass = 0; pass < 2; pass++) {
        DIR *entries = opendir(folder);
        assert_non_null(entries);
        for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
            const char *ending = strrchr(entry->d_name, '.');
            if (pass == 0 && ending && strcmp(ending, ".wave") == 0)
                snprintf(wave, sizeof wave, "%.*s-", (int)(ending - entry->d_name), entry->d_name);
            n += pass == 1 && ending && strcmp(ending, ".json") == 0 &&
                 strncmp(entry->d_name, wave, strlen(wave)) == 0;
        }
        closedir(entries);
    }
    assert_true(*wave && n > 0);
    return n;
}

/* Of the parts that are done since, those of the wave that was under way had their tasks. */
static void assert_nothing_twice(struct fixture *f, const char *path, int tasks_then, int wave)
{
    struct reply reply;
    daemon_get(&f->daemon, path, &reply);
    assert_true(reply_number(&reply, "runner.parts.again") == 0);
    assert_int_equal(cluster_tasks_ever(),
                     tasks_then + (int)reply_number(&reply, "runner.parts.done") - wave);
    reply_done(&reply);
}

/* Killed in the middle: it goes on with what is done, and waits for what is under way. */
static void test_the_daemon_is_killed(void **state)
{
    struct fixture *f = *state;
    char path[80];
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    daemon_end(&f->daemon, SIGKILL);
    cluster_rest(0.5);
    const int tasks = cluster_tasks_ever(), wave = count_parts(f, path);
    restart(f);
    wait_until_done(f, path);
    assert_nothing_twice(f, path, tasks, wave);
    compare(f, parted_long, path);
}

/* Stopped in good order its tasks go on, too. */
static void test_the_daemon_is_stopped(void **state)
{
    struct fixture *f = *state;
    char path[80];
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    assert_true(cluster_tasks(false) > 0);
    restart(f);
    wait_until_done(f, path);
    assert_cleared(f);
}

/* What a killed daemon has left of a job that is cancelled before it goes on: its tasks end, too.
 */
static void test_what_nobody_wants_is_swept(void **state)
{
    struct fixture *f = *state;
    char first[80], path[80];
    struct reply reply;
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    daemon_end(&f->daemon, SIGKILL);
    f->options[1] = "local";
    f->options[2] = NULL;
    restart(f); /* which knows nothing of Slurm: the job is done here, and its tasks go on */
    daemon_cancel(&f->daemon, path, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, path, 10, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    daemon_end(&f->daemon, SIGTERM);
    assert_true(cluster_tasks(false) > 0);
    f->options[1] = "slurm";
    f->options[2] = "--shared";
    restart(f);
    cluster_wait_for_none(10);
    for (int i = 0; i < 50 && rmdir(f->shared) != 0; i++)
        cluster_rest(0.1);
    assert_int_equal(mkdir(f->shared, 0700), 0);
    submit(f, parted_render, first); /* it goes on as ever */
    wait_until_done(f, first);
}

static double held(struct fixture *f, const char *path)
{
    struct reply reply;
    daemon_get(&f->daemon, path, &reply);
    const double n = reply_number(&reply, "runner.parts.held");
    reply_done(&reply);
    return n;
}

/* No byte more fits into the shared folder for a while: parts wait until there is room. Where the
 * test may not mount a small disk it is left out. */
static void test_the_shared_disk_is_full(void **state)
{
    struct fixture *f = *state;
    char path[80], command[256];
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    snprintf(command, sizeof command, "mount -t tmpfs -o size=8m,mode=700 none %s 2>/dev/null",
             f->shared);
    const bool mounted = system(command) == 0; /* NOLINT(cert-env33-c) */
    restart(f);
    if (!mounted)
        skip();
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    snprintf(command, sizeof command, "! cat /dev/zero >%s/filler 2>/dev/null", f->shared);
    cluster_command(command);
    for (int i = 0; i < 200 && !(held(f, path) > 0); i++)
        cluster_rest(0.1);
    assert_true(held(f, path) > 0);
    snprintf(command, sizeof command, "rm %s/filler", f->shared);
    cluster_command(command);
    wait_until_done(f, path);
    daemon_end(&f->daemon, SIGTERM);
    snprintf(command, sizeof command, "umount %s", f->shared);
    cluster_command(command);
    restart(f);
    fetch(f, path, "slurm");
    compare_fetched(f, parted_long);
}

/* How its parts stand: in its status, its events and the daemon's figures. */
static void test_parts_are_told_of(void **state)
{
    struct fixture *f = *state;
    char path[80], events[96];
    struct reply reply;
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    for (int i = 0; i < 50 && daemon_metric(&f->daemon, "oriel_parts{state=\"running\"}") < 1; i++)
        cluster_rest(0.1);
    assert_true(daemon_metric(&f->daemon, "oriel_parts{state=\"running\"}") > 0);
    daemon_get(&f->daemon, path, &reply);
    assert_string_equal(reply_text(&reply, "runner.name"), "slurm");
    assert_true(reply_number(&reply, "runner.parts.running") > 0);
    reply_done(&reply);
    snprintf(events, sizeof events, "%s/events", path);
    daemon_get(&f->daemon, events, &reply); /* all of them, until the job ends */
    assert_non_null(strstr(reply.body, "\"parts\":{\"waiting\":"));
    reply_done(&reply);
    daemon_get(&f->daemon, path, &reply);
    const double done = reply_number(&reply, "runner.parts.done");
    reply_done(&reply);
    assert_true(daemon_metric(&f->daemon, "oriel_parts{state=\"running\"}") == 0);
    assert_true(daemon_metric(&f->daemon, "oriel_parts_done_total") == done);
}

static void test_cancel_ends_all_tasks(void **state)
{
    struct fixture *f = *state;
    char path[80];
    struct reply reply;
    submit(f, parted_long, path);
    cluster_wait_for_tasks();
    daemon_cancel(&f->daemon, path, &reply);
    reply_done(&reply);
    cluster_wait_for_none(10);
    daemon_wait(&f->daemon, path, 10, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    assert_cleared(f);
}

/* What is less work than a queue is worth. */
static void test_small_jobs_stay(void **state)
{
    struct fixture *f = *state;
    char path[80];
    struct reply reply;
    daemon_end(&f->daemon, SIGTERM);
    f->options[5] = "100";
    restart(f);
    submit(f, parted_render, path);
    daemon_wait(&f->daemon, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_string_equal(reply_text(&reply, "runner.name"), "local");
    assert_non_null(strstr(reply_text(&reply, "runner.why"), "of one core, less than the 100 s"));
    assert_null(reply_at(&reply, "runner.parts"));
    char scene[80], plan[400];
    snprintf(scene, sizeof scene, "%s", reply_text(&reply, "scene"));
    reply_done(&reply);
    snprintf(plan, sizeof plan,
             "{\"scene\": \"%s\", \"technique\": \"gather\", \"photons\": {\"global\": 90000000,"
             " \"caustic\": 0}, \"sensors\": [[1, 1, 0.8, 0, 0, 1]]}",
             scene);
    daemon_post_json(&f->daemon, "/v1/plans", plan, &reply);
    if (strcmp(reply_text(&reply, "runner.name"), "slurm") != 0)
        fail_msg("%s", reply.body);
    assert_null(reply_at(&reply, "work"));
    reply_done(&reply);
    assert_cleared(f);
}

static void assert_refused(const struct fixture *f, const char *const *args, const char *says)
{
    struct cli_child child = cli_start_program("orield", args);
    cli_finish(&child, &f->desk->result);
    assert_true(f->desk->result.exit_code > 0);
    if (!strstr(f->desk->result.err, says))
        fail_msg("\"%s\" is not in: %s", says, f->desk->result.err);
}

static void test_options_that_do_not_fit(void **state)
{
    const struct fixture *f = *state;
    char open_to_all[160], data[160];
    snprintf(open_to_all, sizeof open_to_all, "%s/open", f->desk->folder);
    snprintf(data, sizeof data, "%s/data", f->desk->folder);
    assert_int_equal(mkdir(open_to_all, 0755), 0);
    const char *const nowhere[] = {"--runner", "slurm", NULL};
    const char *const here[] = {"--shared", f->shared, NULL};
    const char *const other[] = {"--runner", "cloud", NULL};
    const char *const word[] = {"--runner", "slurm", "--slurm-option", "rm", NULL};
    const char *const open[] = {"--runner", "slurm", "--shared", open_to_all, "--data", data, NULL};
    assert_refused(f, nowhere, "needs --shared DIR");
    assert_refused(f, here, "go with --runner slurm");
    assert_refused(f, other, "local or slurm, not 'cloud'");
    assert_refused(f, word, "'rm' is none");
    assert_refused(f, open, "others than this user may use the shared folder");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_render, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_daemon_is_killed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_daemon_is_stopped, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_nobody_wants_is_swept, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_shared_disk_is_full, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_parts_are_told_of, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_ends_all_tasks, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_small_jobs_stay, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_options_that_do_not_fit, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
