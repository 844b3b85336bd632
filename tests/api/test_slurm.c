/*
 * Jobs whose parts are tasks of a real Slurm on loopback, of two nodes: the same results as in one
 * piece; and what goes wrong on clusters, each without a loss.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include <signal.h>

#include "support/parted.h"

static const char *const by_slurm[] = {"--slurm", "--parts", "4", NULL};
static char cluster[64];

/* A script of ours, with a folder of ours: nothing of a user's is in it. */
static int control(const char *what, unsigned port)
{
    char command[256];
    snprintf(command, sizeof command, "tests/support/slurm %s %s %u", what, cluster, port);
    return system(command); /* NOLINT(cert-env33-c) */
}

static int start_cluster(void **state)
{
    char conf[96];
    (void)state;
    cli_make_folder(cluster);
    snprintf(conf, sizeof conf, "%s/slurm.conf", cluster);
    setenv("SLURM_CONF", conf, 1);
    return control("start", 20000 + 3 * ((unsigned)getpid() % 4000));
}

static int stop_cluster(void **state)
{
    (void)state;
    control("stop", 0);
    cli_remove_folder(cluster);
    return 0;
}

static void test_a_render(void **state)
{
    parted_compare(*state, parted_render, by_slurm);
}

static void test_skies(void **state)
{
    parted_compare(*state, parted_skies, by_slurm);
}

static void test_rounds(void **state)
{
    parted_compare(*state, parted_goal, by_slurm);
}

static void test_a_year(void **state)
{
    parted_compare(*state, parted_annual, by_slurm);
}

/* ---- Faults ---------------------------------------------------------------------------------- */

static void rest(double seconds)
{
    const struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - (double)(long)seconds))};
    nanosleep(&time, NULL);
}

static struct cli_child start_run(struct cli_desk *f, const char *document)
{
    static char path[160], to[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, document);
    snprintf(to, sizeof to, "%s/slurm", f->folder);
    const char *const args[] = {"run", path,      "-o",      to,  "--threads",
                                "1",   "--slurm", "--parts", "4", NULL};
    return cli_start(args);
}

/* Words of squeue about tasks that run; true where there are any. */
static bool tasks_run(void)
{
    char line[64] = "";
    FILE *squeue = popen("squeue --noheader --array --format=%t", "r"); /* NOLINT(cert-env33-c) */
    bool any = false;
    assert_non_null(squeue);
    while (fgets(line, sizeof line, squeue))
        any = any || strncmp(line, "R", 1) == 0;
    pclose(squeue);
    return any;
}

static void wait_for_tasks(bool wanted)
{
    for (int i = 0; i < 300 && tasks_run() != wanted; i++)
        rest(0.1);
    assert_true(tasks_run() == wanted);
}

static pid_t pid_in(const char *name)
{
    char *text = cli_read_file(cluster, name);
    assert_non_null(text);
    const pid_t pid = (pid_t)strtol(text, NULL, 10);
    free(text);
    assert_true(pid > 1);
    return pid;
}

static void assert_ends_the_same(struct cli_desk *f, struct cli_child *child, const char *document,
                                 bool tried_again)
{
    cli_finish(child, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_non_null(strstr(f->result.err, "once more"));
    if (tried_again)
        assert_null(strstr(f->result.err, " 0 of them once more"));
    parted_run(f, document, "whole", NULL);
    parted_assert_same(f, "whole", "slurm");
}

static void run_command(const char *command)
{
    assert_int_equal(system(command), 0); /* NOLINT(cert-env33-c) */
}

/* Tasks that are cancelled from outside leave nothing behind: they are handed in once more. */
static void test_tasks_are_killed(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    wait_for_tasks(true);
    run_command("scancel --me");
    assert_ends_the_same(f, &child, parted_skies, true);
}

/* A node that vanishes, and comes back. */
static void test_a_node_vanishes(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    wait_for_tasks(true);
    kill(pid_in("n1.pid"), SIGKILL);
    rest(1);
    run_command("slurmd -N n1");
    assert_ends_the_same(f, &child, parted_skies, false);
}

/* Its controller does not answer for a while. */
static void test_the_controller_is_away(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_goal);
    wait_for_tasks(true);
    const pid_t controller = pid_in("slurmctld.pid");
    kill(controller, SIGSTOP);
    rest(3);
    kill(controller, SIGCONT);
    assert_ends_the_same(f, &child, parted_goal, false);
}

static void test_cancel_ends_all_tasks(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    wait_for_tasks(true);
    kill(child.pid, SIGTERM);
    cli_finish(&child, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    wait_for_tasks(false);
}

static void test_what_sbatch_refuses_is_told(void **state)
{
    struct cli_desk *f = *state;
    char path[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, parted_render);
    const char *const nowhere[] = {
        "run", path, "-o", f->output, "--slurm", "--sbatch", "--partition=nowhere", NULL};
    cli_run(nowhere, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "sbatch: "));
    const char *const word[] = {"run",     path,       "-o",       f->output,
                                "--slurm", "--sbatch", "rm -rf /", NULL};
    cli_run(word, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    assert_non_null(strstr(f->result.err, "'rm' is none"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_render, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_skies, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_rounds, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_tasks_are_killed, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_node_vanishes, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_the_controller_is_away, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_ends_all_tasks, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_what_sbatch_refuses_is_told, parted_set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, start_cluster, stop_cluster);
}
