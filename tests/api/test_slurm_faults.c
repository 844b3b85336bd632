/*
 * Failures between orield --runner slurm and a real Slurm on loopback, without any loss: equal
 * results, and nothing computed twice.
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

#include "base/sampling/sampling.h"
#include "support/cluster.h"
#include "support/parted_daemon.h"
#include "support/patience.h"

/* Counts the parts of the current round. */
static int count_parts(const struct parted_daemon *f, const char *path)
{
    char folder[256], round[256] = "";
    int n = 0;
    snprintf(folder, sizeof folder, "%s/%s", f->shared, path + strlen("/v1/jobs/"));
    for (int pass = 0; pass < 2; pass++) {
        DIR *entries = opendir(folder);
        assert_non_null(entries);
        for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
            const char *ending = strrchr(entry->d_name, '.');
            if (pass == 0 && ending && strcmp(ending, ".wave") == 0)
                snprintf(round, sizeof round, "%.*s-", (int)(ending - entry->d_name),
                         entry->d_name);
            n += pass == 1 && ending && strcmp(ending, ".json") == 0 &&
                 strncmp(entry->d_name, round, strlen(round)) == 0;
        }
        closedir(entries);
    }
    assert_true(*round && n > 0);
    return n;
}

/* Asserts that no part ran twice: those of the round that was running at the restart keep their
 * tasks. If that round had ended, no parts were left. */
static void assert_nothing_twice(struct parted_daemon *f, const char *path, int tasks_then,
                                 int round)
{
    struct reply reply;
    daemon_get(&f->daemon, path, &reply);
    assert_true(reply_number(&reply, "runner.parts.again") == 0);
    const int done = (int)reply_number(&reply, "runner.parts.done");
    assert_int_equal(cluster_tasks_ever(), done > 0 ? tasks_then + done - round : tasks_then);
    reply_done(&reply);
}

/* A killed daemon continues with the finished parts, and waits for the running ones. */
static void test_the_daemon_is_killed(void **state)
{
    struct parted_daemon *f = *state;
    char path[80];
    parted_submit(f, parted_middle, path);
    cluster_wait_for_tasks();
    daemon_end(&f->daemon, SIGKILL);
    cluster_rest(0.5);
    const int tasks = cluster_tasks_ever(), round = count_parts(f, path);
    parted_restart(f);
    parted_wait_resumed(f, path);
    assert_nothing_twice(f, path, tasks, round);
    parted_compare_daemons(f, parted_middle, path);
}

/* After an orderly stop its tasks continue, too. */
static void test_the_daemon_is_stopped(void **state)
{
    struct parted_daemon *f = *state;
    char path[80];
    parted_submit(f, parted_long, path);
    cluster_wait_for_tasks();
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    assert_true(cluster_tasks(false) > 0);
    parted_restart(f);
    parted_wait_resumed(f, path);
    parted_assert_cleared(f);
}

/* Tasks that a killed daemon left end when their job is cancelled before it continues. */
static void test_what_nobody_wants_is_swept(void **state)
{
    struct parted_daemon *f = *state;
    char first[80], path[80];
    struct reply reply;
    parted_submit(f, parted_long, path);
    cluster_wait_for_tasks();
    daemon_end(&f->daemon, SIGKILL);
    f->options[1] = "local";
    f->options[2] = NULL;
    parted_restart(f); /* a daemon without Slurm: the job runs in it, and its tasks continue */
    daemon_cancel(&f->daemon, path, &reply);
    reply_done(&reply);
    daemon_wait(&f->daemon, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    daemon_end(&f->daemon, SIGTERM);
    assert_true(cluster_tasks(false) > 0);
    f->options[1] = "slurm";
    f->options[2] = "--shared";
    parted_restart(f);
    cluster_wait_for_none();
    for (double until = patience_until(); rmdir(f->shared) != 0 && patience_nap(until);)
        continue;
    assert_int_equal(mkdir(f->shared, 0700), 0);
    parted_submit(f, parted_render, first); /* it continues as before */
    parted_wait(f, first);
}

static double held(struct parted_daemon *f, const char *path)
{
    struct reply reply;
    daemon_get(&f->daemon, path, &reply);
    const double n = reply_number(&reply, "runner.parts.held");
    reply_done(&reply);
    return n;
}

/* The shared folder is full for a while: parts wait until there is space. The test is skipped
 * without the right to mount a small disk. */
static void test_the_shared_disk_is_full(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], command[256];
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    snprintf(command, sizeof command, "mount -t tmpfs -o size=8m,mode=700 none %s 2>/dev/null",
             f->shared);
    const bool mounted = system(command) == 0; /* NOLINT(cert-env33-c) */
    parted_restart(f);
    if (!mounted)
        skip();
    parted_submit(f, parted_middle, path);
    cluster_wait_for_tasks();
    snprintf(command, sizeof command, "! cat /dev/zero >%s/filler 2>/dev/null", f->shared);
    cluster_command(command);
    for (double until = patience_until(); !(held(f, path) > 0) && patience_nap(until);)
        continue;
    assert_true(held(f, path) > 0);
    snprintf(command, sizeof command, "rm %s/filler", f->shared);
    cluster_command(command);
    parted_wait(f, path);
    daemon_end(&f->daemon, SIGTERM);
    snprintf(command, sizeof command, "umount %s", f->shared);
    cluster_command(command);
    parted_restart(f);
    parted_fetch(f, path, "slurm");
    parted_compare_fetched(f, parted_middle);
}

/* A part's output is truncated before it is read: the part runs again. */
static void test_output_is_truncated(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], command[400];
    parted_submit(f, parted_middle, path);
    cluster_wait_for_tasks();
    snprintf(command, sizeof command,
             "cd %s/%s/store; until ls sky-*.opm >/dev/null 2>&1; do sleep 0.02; done;"
             " truncate -s 1000 $(ls sky-*.opm | head -1)",
             f->shared, path + strlen("/v1/jobs/"));
    cluster_command(command);
    parted_wait(f, path);
    struct reply reply;
    daemon_get(&f->daemon, path, &reply);
    assert_true(reply_number(&reply, "runner.parts.waves") == 2);
    reply_done(&reply);
    parted_compare_daemons(f, parted_middle, path);
}

/* Installs a program in oriel's place, beside a copy of the daemon: if a file "hungry" exists its
 * part allocates 700 MiB and waits. Each such file is used once. */
static void set_up_hunger(struct parted_daemon *f, char ret_folder[160])
{
    const char *build = getenv("ORIEL_BUILD");
    char command[1400];
    snprintf(ret_folder, 160, "%s/bin", f->desk->folder);
    snprintf(command, sizeof command,
             "build=$(realpath %s) && mkdir %s && cp $build/orield %s && cat >%s/oriel <<END\n"
             "#!/bin/sh\n"
             "for i in 1 2; do\n"
             "    if [ \\$1 = part ] && mv %s/hungry\\$i %s/stilled\\$i 2>/dev/null; then\n"
             "        { head -c 700M /dev/zero; sleep 30; } | tail | wc -c\n"
             "        exit 1\n"
             "    fi\n"
             "done\n"
             "exec $build/oriel \"\\$@\"\n"
             "END\n"
             "chmod 700 %s/oriel",
             build ? build : "build", ret_folder, ret_folder, ret_folder, ret_folder, ret_folder,
             ret_folder);
    cluster_command(command);
}

/* Slurm kills a part that exceeds its memory: it gets twice as much, and then twice that. */
static void test_a_part_runs_out_of_memory(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], folder[160], command[400];
    struct reply reply;
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    set_up_hunger(f, folder);
    char *build = getenv("ORIEL_BUILD"), *kept = build ? strdup(build) : NULL;
    setenv("ORIEL_BUILD", folder, 1);
    parted_restart(f);
    snprintf(command, sizeof command, "touch %s/hungry1 %s/hungry2", folder, folder);
    cluster_command(command);
    parted_submit(f, parted_skies, path);
    parted_wait(f, path);
    setenv("ORIEL_BUILD", kept ? kept : "build", 1);
    free(kept);
    daemon_get(&f->daemon, path, &reply);
    assert_true(reply_number(&reply, "runner.parts.again") == 2);
    reply_done(&reply);
    cluster_command("squeue --noheader --array --states=all --format=%m | grep -qx 512M");
    parted_compare_daemons(f, parted_skies, path);
}

/* No slurmctld runs when the job is submitted, nor for a while after. */
static void test_slurmctld_is_killed(void **state)
{
    struct parted_daemon *f = *state;
    char path[80];
    kill(cluster_pid("slurmctld.pid"), SIGKILL);
    parted_submit(f, parted_skies, path);
    cluster_rest(2);
    cluster_command("slurmctld");
    parted_wait(f, path);
    parted_compare_daemons(f, parted_skies, path);
}

/* The first sbatch of the job is killed before it says a word: the job waits, and asks again. */
static void test_sbatch_is_killed(void **state)
{
    struct parted_daemon *f = *state;
    char path[80], folder[128], program[160], search[4096];
    char *const usual = strdup(getenv("PATH"));
    snprintf(folder, sizeof folder, "%s/bin", f->desk->folder);
    snprintf(program, sizeof program, "%s/sbatch", folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    FILE *file = fopen(program, "w");
    assert_non_null(file);
    fprintf(file,
            "#!/bin/sh\nif [ -e %s/killed ]; then PATH=${PATH#*:} exec sbatch \"$@\"; fi\n"
            ": >%s/killed\nkill -9 $$\n",
            folder, folder);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(program, 0700), 0);
    snprintf(search, sizeof search, "%s:%s", folder, usual);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    assert_int_equal(setenv("PATH", search, 1), 0);
    parted_restart(f);
    assert_int_equal(setenv("PATH", usual, 1), 0);
    parted_submit(f, parted_skies, path);
    parted_wait(f, path);
    snprintf(program, sizeof program, "%s/killed", folder);
    assert_int_equal(access(program, F_OK), 0);
    parted_compare_daemons(f, parted_skies, path);
    free(usual);
}

/* Cancels by the daemon: within 10 s none of its tasks, and no file in its folder, is left. */
static void cancel_after(struct parted_daemon *f, double moment_s)
{
    char path[80];
    struct reply reply;
    parted_submit(f, parted_long, path);
    cluster_rest(moment_s);
    daemon_cancel(&f->daemon, path, &reply);
    reply_done(&reply);
    cluster_wait_for_none();
    daemon_wait(&f->daemon, path, 240, &reply);
    assert_string_equal(reply_text(&reply, "state"), "cancelled");
    reply_done(&reply);
    assert_int_equal(cluster_tasks(false), 0); /* includes tasks that were being submitted then */
    parted_assert_cleared(f);
}

/* Cancels at moments over most of the job's time: one in each of four parts of it, or of ten in the
 * long form. */
static void test_cancels_at_any_moment(void **state)
{
    const int cancels = cluster_long_form() ? 10 : 4;
    const double until_s = 2.5;
    struct orl_random random = orl_random_stream(25, ORL_PURPOSE_BENCH, 0);
    for (int i = 0; i < cancels; i++)
        cancel_after(*state, until_s * (i + orl_random_uniform(&random)) / cancels);
}

/* Runs also if the test failed before it unmounted. */
static int unmount(void **state)
{
    const struct parted_daemon *f = *state;
    char command[160];
    snprintf(command, sizeof command, "umount -l %s 2>/dev/null", f->shared);
    (void)!system(command); /* NOLINT(cert-env33-c) */
    return parted_daemon_tear_down(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_the_daemon_is_killed, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_the_daemon_is_stopped, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_what_nobody_wants_is_swept, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_the_shared_disk_is_full, parted_daemon_set_up,
                                        unmount),
        cmocka_unit_test_setup_teardown(test_output_is_truncated, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_cancels_at_any_moment, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_part_runs_out_of_memory, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        /* The last test: afterwards Slurm treats tasks that it had not recorded as running for a
           while. */
        cmocka_unit_test_setup_teardown(test_slurmctld_is_killed, parted_daemon_set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_sbatch_is_killed, parted_daemon_set_up,
                                        parted_daemon_tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
