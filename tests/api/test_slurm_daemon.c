/*
 * orield --runner slurm on a real Slurm on loopback: large jobs go as its tasks, with the results
 * of a daemon that does all by itself; small ones stay; and what goes wrong, each without a loss.
 */
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
    daemon_wait(&f->daemon, path, 60, &reply);
    if (strcmp(reply_text(&reply, "state"), "succeeded") != 0)
        fail_msg("%s", reply.body);
    assert_string_equal(reply_text(&reply, "runner.name"), "slurm");
    assert_true(reply_number(&reply, "runner.parts.done") > 1);
    assert_true(reply_number(&reply, "runner.parts.waiting") == 0);
    reply_done(&reply);
}

/* Nothing is left in the shared folder. */
static void assert_cleared(const struct fixture *f)
{
    assert_int_equal(rmdir(f->shared), 0);
    assert_int_equal(mkdir(f->shared, 0700), 0);
}

/* By this one, and by a daemon that has no Slurm. */
static void compare(struct fixture *f, const char *document)
{
    static const char *const alone[] = {"--threads", "1", NULL};
    struct daemon other;
    char path[80];
    submit(f, document, path);
    wait_until_done(f, path);
    fetch(f, path, "slurm");
    assert_cleared(f);
    daemon_start(&other, alone);
    setenv("ORIEL_URL", other.url, 1);
    submit(f, document, path);
    struct reply reply;
    daemon_wait(&other, path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    reply_done(&reply);
    fetch(f, path, "local");
    daemon_remove(&other);
    parted_assert_same(f->desk, "local", "slurm");
}

static void test_a_render(void **state)
{
    compare(*state, parted_render);
}

static void test_a_year(void **state)
{
    compare(*state, parted_annual);
}

/* What is less work than a queue is worth. */
static void test_small_jobs_stay(void **state)
{
    struct fixture *f = *state;
    char path[80];
    struct reply reply;
    daemon_end(&f->daemon, SIGTERM);
    f->options[5] = "100";
    daemon_restart(&f->daemon, f->options);
    setenv("ORIEL_URL", f->daemon.url, 1);
    submit(f, parted_render, path);
    daemon_wait(&f->daemon, path, 60, &reply);
    assert_string_equal(reply_text(&reply, "state"), "succeeded");
    assert_string_equal(reply_text(&reply, "runner.name"), "local");
    assert_non_null(strstr(reply_text(&reply, "runner.why"), "of one core, less than the 100 s"));
    assert_null(reply_at(&reply, "runner.parts"));
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
        cmocka_unit_test_setup_teardown(test_small_jobs_stay, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_options_that_do_not_fit, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
