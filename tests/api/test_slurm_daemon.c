/*
 * orield --runner slurm on a real Slurm on loopback: large jobs run as its tasks, with the results
 * of a daemon without Slurm; small ones run in the daemon.
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
#include "support/daemon_metric.h"
#include "support/parted_daemon.h"
#include "support/patience.h"

static void test_a_render(void **state)
{
    char path[80];
    parted_submit(*state, parted_render, path);
    parted_wait(*state, path);
    parted_compare_daemons(*state, parted_render, path);
}

static void test_a_year(void **state)
{
    char path[80];
    parted_submit(*state, parted_annual, path);
    parted_wait(*state, path);
    parted_compare_daemons(*state, parted_annual, path);
}

static void test_a_study(void **state)
{
    char path[80];
    parted_submit(*state, parted_study, path);
    parted_wait(*state, path);
    parted_compare_daemons(*state, parted_study, path);
}

static void test_a_goal(void **state)
{
    char path[80];
    parted_submit(*state, parted_goal, path);
    parted_wait(*state, path);
    parted_compare_daemons(*state, parted_goal, path);
}

static void test_bsdfs(void **state)
{
    char path[80];
    parted_submit(*state, parted_panel, path);
    parted_wait(*state, path);
    parted_compare_daemons(*state, parted_panel, path);
}

/* The state of its parts is in the job's status, its events and the daemon's metrics. */
static void test_parts_are_told_of(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], events[96];
    struct reply reply;
    parted_submit(f, parted_middle, path);
    cluster_wait_for_tasks();
    daemon_metric_wait(&f->daemon, "oriel_parts{state=\"running\"}", 1);
    daemon_get(&f->daemon, path, &reply);
    assert_string_equal(reply_text(&reply, "runner.name"), "slurm");
    assert_true(reply_number(&reply, "runner.parts.running") > 0);
    reply_done(&reply);
    snprintf(events, sizeof events, "%s/events", path);
    daemon_get(&f->daemon, events, &reply); /* all events, until the job ends */
    assert_non_null(strstr(reply.body, "\"parts\":{\"waiting\":"));
    reply_done(&reply);
    daemon_get(&f->daemon, path, &reply);
    const double done = reply_number(&reply, "runner.parts.done");
    reply_done(&reply);
    assert_true(daemon_metric(&f->daemon, "oriel_parts{state=\"running\"}") == 0);
    assert_true(daemon_metric(&f->daemon, "oriel_parts_done_total") == done);
}

/* Counts the lines of the daemon's log that contain all of these. */
static int count_in_log(const struct parted_daemon *f, const char *const words[3])
{
    char path[80];
    snprintf(path, sizeof path, "%.64s.log", f->daemon.root);
    char *text = cli_read_file("/", path), *rest = text, *line;
    int n = 0;
    assert_non_null(text);
    while ((line = strsep(&rest, "\n")) != NULL)
        n += strstr(line, words[0]) && strstr(line, words[1]) && strstr(line, words[2]);
    free(text);
    return n;
}

/* Runs a job. Returns true if its percentage advanced, with an ETA, while parts ran. */
static bool watch_progress(struct parted_daemon *f, char ret_path[80])
{
    struct reply reply;
    double last = -1;
    int moves = 0, with_eta = 0;
    parted_submit(f, parted_long, ret_path);
    for (double until = patience_until(); patience_nap(until);) {
        daemon_get(&f->daemon, ret_path, &reply);
        const bool ended = strcmp(reply_text(&reply, "state"), "succeeded") == 0;
        const double percent = reply_number(&reply, "percent");
        if (!ended && reply_number(&reply, "runner.parts.running") > 0) {
            assert_true(percent >= last && percent < 100);
            moves += percent > last;
            with_eta += percent > 0 && reply_number(&reply, "eta_s") > 0;
            last = percent;
        }
        reply_done(&reply);
        if (ended)
            break;
        cluster_rest(0.2);
    }
    print_message("%d percentages, %d with an ETA\n", moves, with_eta);
    return moves >= 3 && with_eta >= 2;
}

/* A job's progress advances while its one round runs; and each part has log lines that lead a
 * cluster's user to its task. On a busy machine the parts of one job may end between two reports,
 * so that up to five jobs are watched. */
static void test_a_wave_moves(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], job[96];
    struct reply reply;
    int tries = 1;
    while (!watch_progress(f, path) && tries < 5)
        tries++;
    assert_true(tries < 5);
    daemon_get(&f->daemon, path, &reply);
    const int done = (int)reply_number(&reply, "runner.parts.done");
    /* A busy machine may reach a task's time limit. */
    const int again = (int)reply_number(&reply, "runner.parts.again");
    reply_done(&reply);
    snprintf(job, sizeof job, "job=%s", path + strlen("/v1/jobs/"));
    assert_int_equal(count_in_log(f, (const char *const[3]){"event=job-part ", job, "what=start"}),
                     done + again);
    assert_int_equal(count_in_log(f, (const char *const[3]){"event=job-part ", job, "what=end"}),
                     done);
    assert_int_equal(count_in_log(f, (const char *const[3]){"what=end", job, "slurm=-"}), 0);
}

static void test_cancel_ends_all_tasks(void **state)
{
    struct parted_daemon *f = *state;
    char path[80];
    struct reply reply;
    parted_submit(f, parted_long, path);
    cluster_wait_for_tasks();
    daemon_cancel(&f->daemon, path, &reply);
    reply_done(&reply);
    cluster_wait_for_none();
    daemon_wait(&f->daemon, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    parted_assert_cleared(f);
}

/* A job with less work than a queue is worth runs in the daemon. */
static void test_small_jobs_stay(void **state)
{
    struct parted_daemon *f = *state;
    char path[80];
    struct reply reply;
    daemon_end(&f->daemon, SIGTERM);
    f->options[5] = "100";
    parted_restart(f);
    parted_submit(f, parted_render, path);
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
    parted_assert_cleared(f);
}

static void assert_refused(const struct parted_daemon *f, const char *const *args, const char *says)
{
    struct cli_child child = cli_start_program("orield", args);
    cli_finish(&child, &f->desk->result);
    assert_true(f->desk->result.exit_code > 0);
    if (!strstr(f->desk->result.err, says))
        fail_msg("\"%s\" is not in: %s", says, f->desk->result.err);
}

static void test_options_that_do_not_fit(void **state)
{
    const struct parted_daemon *f = *state;
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
    assert_refused(f, here, "need --runner slurm");
    assert_refused(f, other, "local or slurm, not 'cloud'");
    assert_refused(f, word, "not 'rm'");
    assert_refused(f, open, "other users may use the shared folder");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_render, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, parted_daemon_set_up, parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_study, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_bsdfs, parted_daemon_set_up, parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_goal, parted_daemon_set_up, parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_parts_are_told_of, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_wave_moves, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_ends_all_tasks, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_small_jobs_stay, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_options_that_do_not_fit, parted_daemon_set_up,
                                        parted_daemon_tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
