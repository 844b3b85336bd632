/*
 * Jobs whose parts are tasks of a real Slurm on loopback, with two nodes: results equal to those in
 * one process; and cluster failures, none of which loses data.
 */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cluster.h"
#include "support/parted.h"

static const char *const by_slurm[] = {"--slurm", "--parts", "4", NULL};

/* Also asserts that each task had a time limit. */
static void compare_parts(struct cli_desk *desk, const char *document)
{
    parted_compare(desk, document, by_slurm);
    assert_true(cluster_tasks_ever() > 0);
    cluster_command("! squeue --noheader --array --states=all --format=%l | grep -q UNLIMITED");
}

static void test_a_render(void **state)
{
    compare_parts(*state, parted_render);
}

static void test_skies(void **state)
{
    compare_parts(*state, parted_skies);
}

static void test_rounds(void **state)
{
    compare_parts(*state, parted_goal);
}

static void test_a_year(void **state)
{
    compare_parts(*state, parted_annual);
}

static void test_a_study(void **state)
{
    compare_parts(*state, parted_study);
}

/* ---- Faults ---------------------------------------------------------------------------------- */

static struct cli_child start_run(struct cli_desk *f, const char *document)
{
    static char path[160], to[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, document);
    snprintf(to, sizeof to, "%s/slurm", f->folder);
    const char *const args[] = {"run", path,      "-o",      to,  "--threads",
                                "1",   "--slurm", "--parts", "4", NULL};
    return cli_start(args);
}

static void assert_ends_the_same(struct cli_desk *f, struct cli_child *child, const char *document,
                                 bool tried_again)
{
    cli_finish(child, &f->result);
    if (f->result.exit_code != 0)
        fail_msg("%s", f->result.err);
    assert_non_null(strstr(f->result.err, "repeated"));
    if (tried_again)
        assert_null(strstr(f->result.err, " 0 of them repeated"));
    parted_run(f, document, "whole", NULL);
    parted_assert_same(f, "whole", "slurm");
}

/* Tasks cancelled from outside are submitted again. */
static void test_tasks_are_killed(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    cluster_wait_for_tasks();
    cluster_command("scancel --me");
    assert_ends_the_same(f, &child, parted_skies, true);
}

/* A node vanishes, and returns. */
static void test_a_node_vanishes(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    cluster_wait_for_tasks();
    kill(cluster_pid("n1.pid"), SIGKILL);
    cluster_rest(1);
    cluster_command("slurmd -N n1");
    assert_ends_the_same(f, &child, parted_skies, false);
}

/* Slurm's controller does not answer for a while: in the long form for 30 s. */
static void test_the_controller_is_away(void **state)
{
    struct cli_desk *f = *state;
    const char *document = cluster_long_form() ? parted_long : parted_goal;
    struct cli_child child = start_run(f, document);
    cluster_wait_for_tasks();
    const pid_t controller = cluster_pid("slurmctld.pid");
    kill(controller, SIGSTOP);
    cluster_rest(cluster_long_form() ? 30 : 3);
    kill(controller, SIGCONT);
    assert_ends_the_same(f, &child, document, false);
}

static void test_cancel_ends_all_tasks(void **state)
{
    struct cli_desk *f = *state;
    struct cli_child child = start_run(f, parted_skies);
    cluster_wait_for_tasks();
    kill(child.pid, SIGTERM);
    cli_finish(&child, &f->result);
    assert_int_equal(f->result.exit_code, 1);
    cluster_wait_for_none();
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
    assert_non_null(strstr(f->result.err, "'rm' is not one"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_render, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_skies, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_rounds, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_study, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_tasks_are_killed, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_a_node_vanishes, parted_set_up, cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_the_controller_is_away, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_ends_all_tasks, parted_set_up,
                                        cli_desk_tear_down),
        cmocka_unit_test_setup_teardown(test_what_sbatch_refuses_is_told, parted_set_up,
                                        cli_desk_tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
