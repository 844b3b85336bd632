/*
 * The Slurm runner's use of sbatch, squeue and scancel. The test puts its own commands first on
 * PATH: they record their arguments, and act by files of a folder.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "distributed/runner.h"
#include "support/cli.h"

static const char sbatch[] = "#!/bin/sh\n"
                             "cd \"${0%/*}\" && echo \"$@\" >>sbatch.args\n"
                             "[ ! -e sbatch.hangs ] || exec sleep 20\n"
                             "[ ! -e sbatch.says ] || { cat sbatch.says >&2; exit 1; }\n"
                             "echo 77\n";
static const char squeue[] = "#!/bin/sh\n"
                             "cd \"${0%/*}\" && echo \"$@\" >>squeue.args\n"
                             "[ ! -e squeue.says ] || { cat squeue.says >&2; exit 1; }\n"
                             "[ ! -e queue ] || cat queue\n";
static const char sinfo[] = "#!/bin/sh\n"
                            "cd \"${0%/*}\" && echo \"$@\" >>sinfo.args\n"
                            "cat partitions\n";
/* The first call does nothing if a file says so. */
static const char scancel[] = "#!/bin/sh\n"
                              "cd \"${0%/*}\" && echo \"$@\" >>scancel.args\n"
                              "[ ! -e scancel.fails ] || { rm scancel.fails; exit 1; }\n"
                              "[ -e scancel.never ] || rm -f queue\n";
static const char away[] = "slurm_load_jobs error: Unable to contact slurm controller (connect "
                           "failure)\n";
static const char job[] = "0123456789abcdef0123456789abcdef";

struct fixture {
    char folder[64], shared[96];
    struct orl_runner runner;
    struct orl_error err;
};

static double clock_s, tick_s; /* the runner's clock, and its advance per reading */

static double now_s(void *ctx)
{
    (void)ctx;
    clock_s += tick_s;
    return clock_s;
}

static void write_command(const struct fixture *f, const char *name, const char *text)
{
    char path[160];
    cli_write_file(f->folder, name, text);
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    assert_int_equal(chmod(path, 0700), 0);
}

static const char *const usual_words[] = {"--partition=long; touch x"};

static void open_runner(struct fixture *f, const char *const *words, size_t n_words)
{
    const struct orl_runner_spec spec = {.folder = f->shared,
                                         .job = job,
                                         .program = "/opt/oriel/bin/oriel",
                                         .threads = 2,
                                         .most = 4,
                                         .words = words,
                                         .n_words = n_words,
                                         .now_s = now_s,
                                         .outage_limit_s = 100,
                                         .command_s = 0.5};
    if (f->runner.done)
        f->runner.done(f->runner.ctx);
    assert_int_equal(orl_runner_slurm(&spec, &f->runner, &f->err), 0);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    char path[256];
    assert_non_null(f);
    cli_make_folder(f->folder);
    snprintf(f->shared, sizeof f->shared, "%s/shared", f->folder);
    assert_int_equal(mkdir(f->shared, 0700), 0);
    write_command(f, "sbatch", sbatch);
    write_command(f, "squeue", squeue);
    write_command(f, "scancel", scancel);
    write_command(f, "sinfo", sinfo);
    cli_write_file(f->folder, "partitions", "short|10:00|1000\nlong*|1-02:00:00|2000+\n");
    snprintf(path, sizeof path, "%s:/usr/bin:/bin", f->folder);
    setenv("PATH", path, 1);
    clock_s = 1000;
    tick_s = 0;
    open_runner(f, usual_words, 1);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    f->runner.done(f->runner.ctx);
    cli_remove_folder(f->folder);
    free(f);
    return 0;
}

static int start(struct fixture *f)
{
    static const struct orl_part_request requests[] = {
        {0, {30, 512}}, {1, {30, 512}}, {2, {60, 512}}};
    return f->runner.start(f->runner.ctx, "wave1", requests, 3, 3, &f->err);
}

static int poll_parts(struct fixture *f, struct orl_part_status status[3])
{
    return f->runner.poll(f->runner.ctx, "wave1", status, 3, &f->err);
}

/* Waits a second, so that the runner queries Slurm. */
static void assert_states(struct fixture *f, enum orl_part_state a, enum orl_part_state b,
                          enum orl_part_state c)
{
    struct orl_part_status status[3];
    clock_s += 1.1;
    if (poll_parts(f, status))
        fail_msg("%s", f->err.message);
    assert_int_equal(status[0].state, a);
    assert_int_equal(status[1].state, b);
    assert_int_equal(status[2].state, c);
}

static int count_lines(const struct fixture *f, const char *name)
{
    char *text = cli_read_file(f->folder, name);
    int n = 0;
    for (const char *at = text; at && *at; at++)
        n += *at == '\n';
    free(text);
    return n;
}

static void assert_holds(const struct fixture *f, const char *name, const char *wanted)
{
    char *text = cli_read_file(f->folder, name);
    assert_non_null(text);
    if (!strstr(text, wanted))
        fail_msg("\"%s\" is not in: %s", wanted, text);
    free(text);
}

static void forget(const struct fixture *f, const char *name)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    assert_int_equal(unlink(path), 0);
}

static void test_what_is_handed_in(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(start(f), 0);
    assert_holds(f, "sbatch.args", "--job-name=oriel-0123456789ab-wave1 ");
    assert_holds(f, "sbatch.args", "--cpus-per-task=2 ");
    assert_holds(f, "sbatch.args", "--array=0-1%4 --time=30 --mem=512M ");
    assert_holds(f, "sbatch.args", "--array=2%4 --time=60 --mem=512M ");
    assert_holds(f, "sbatch.args", "/part.sh /opt/oriel/bin/oriel ");
    assert_holds(f, "sbatch.args", " --partition=long; touch x "); /* one word, no shell */
    assert_int_equal(access("x", F_OK), -1);
    cli_write_file(f->folder, "queue", "0|R \n1|PD\n7|R\nN/A|R\n");
    assert_states(f, ORL_PART_RUNNING, ORL_PART_WAITING, ORL_PART_GONE);
    assert_holds(f, "squeue.args", "--name=oriel-0123456789ab-wave1");
}

/* A limit is at most the partition's, does not replace one set by the options, and is omitted for
 * memory if no node states its size. */
static void test_limits_have_bounds(void **state)
{
    static const char *const short_words[] = {"--partition=short"};
    static const char *const timed_words[] = {"--time=5", "-plong"};
    struct fixture *f = *state;
    struct orl_part_status status[3];
    open_runner(f, short_words, 1);
    cli_write_file(f->folder, "partitions", "short|10:00|1000\n");
    assert_int_equal(start(f), 0);
    assert_holds(f, "sinfo.args", "--partition=short");
    assert_holds(f, "sbatch.args", "--array=0-1%4 --time=10 --mem=512M ");
    assert_int_equal(poll_parts(f, status), 0);
    assert_int_equal(status[2].limits.minutes, 10);
    assert_int_equal(status[2].task, 77);
    forget(f, "sbatch.args");
    open_runner(f, timed_words, 2);
    cli_write_file(f->folder, "partitions", "long|infinite|1\n");
    assert_int_equal(start(f), 0);
    assert_holds(f, "sbatch.args", "--array=0-1%4 --time=5 -plong ");
    assert_int_equal(poll_parts(f, status), 0);
    assert_int_equal(status[2].limits.minutes, 0);
}

static enum orl_part_end end_of(struct fixture *f, uint32_t number)
{
    return f->runner.end(f->runner.ctx, "wave1", number);
}

static void test_what_a_part_came_up_against(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(start(f), 0);
    cli_write_file(f->folder, "queue", "0|OOM |77\n1|TO|77\n2|TO|76\n");
    assert_int_equal(end_of(f, 0), ORL_PART_OUT_OF_MEMORY);
    assert_int_equal(end_of(f, 1), ORL_PART_OUT_OF_TIME);
    assert_int_equal(end_of(f, 2), ORL_PART_ENDED); /* the end is of an earlier try */
    forget(f, "queue");
    cli_write_file(f->shared, "slurm-77_0.log",
                   "oriel: slurmstepd: DUE TO TIME LIMIT\n"
                   "slurmstepd: error: Detected 1 oom-kill event(s) in StepId=1.batch.\n");
    cli_write_file(f->shared, "slurm-77_1.log",
                   "slurmstepd: error: *** JOB 1 ON n1 CANCELLED AT 1970 DUE TO TIME LIMIT ***\n");
    cli_write_file(f->shared, "slurm-77_2.log", "oriel: DUE TO TIME LIMIT\n");
    assert_int_equal(end_of(f, 0), ORL_PART_OUT_OF_MEMORY);
    assert_int_equal(end_of(f, 1), ORL_PART_OUT_OF_TIME);
    assert_int_equal(end_of(f, 2), ORL_PART_ENDED);
}

static void test_a_refusal_ends_it(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "sbatch.says", "sbatch: error: invalid partition specified: x\n");
    assert_int_equal(start(f), ORL_ERR_INVALID);
    assert_non_null(strstr(f->err.message, "invalid partition specified"));
}

/* A round that cannot be submitted waits, and is submitted when Slurm is back. */
static void test_slurm_is_away_at_the_start(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "sbatch.says", away);
    cli_write_file(f->folder, "squeue.says", away);
    assert_int_equal(start(f), 0);
    assert_states(f, ORL_PART_WAITING, ORL_PART_WAITING, ORL_PART_WAITING);
    assert_int_equal(count_lines(f, "sbatch.args"), 1); /* the first: Slurm is away */
    forget(f, "squeue.says");
    forget(f, "sbatch.says");
    assert_states(f, ORL_PART_UNKNOWN, ORL_PART_UNKNOWN, ORL_PART_UNKNOWN);
    assert_int_equal(count_lines(f, "sbatch.args"), 3);
    cli_write_file(f->folder, "queue", "0|PD\n1|PD\n2|PD\n");
    assert_states(f, ORL_PART_WAITING, ORL_PART_WAITING, ORL_PART_WAITING);
    assert_int_equal(count_lines(f, "sbatch.args"), 3);
}

/* An sbatch that hangs and is killed may have submitted its job, which is not submitted twice. */
static void test_sbatch_hangs(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "sbatch.hangs", "");
    assert_int_equal(start(f), 0);
    forget(f, "sbatch.hangs");
    cli_write_file(f->folder, "queue", "0|R\n1|PD\n");
    clock_s += 1.1;
    struct orl_part_status status[3];
    assert_int_equal(poll_parts(f, status), 0);
    assert_int_equal(status[0].state, ORL_PART_RUNNING);
    assert_int_equal(status[1].state, ORL_PART_WAITING);
    assert_int_equal(count_lines(f, "sbatch.args"), 2);
    assert_holds(f, "sbatch.args", "--array=2%4 ");
}

static void test_outage_limit(void **state)
{
    struct fixture *f = *state;
    struct orl_part_status status[3];
    assert_int_equal(start(f), 0);
    cli_write_file(f->folder, "squeue.says", away);
    assert_states(f, ORL_PART_UNKNOWN, ORL_PART_UNKNOWN, ORL_PART_UNKNOWN);
    clock_s += 101;
    assert_int_equal(poll_parts(f, status), ORL_ERR_IO);
    assert_non_null(strstr(f->err.message, "has not answered for 100 s: slurm_load_jobs error"));
    assert_non_null(strstr(f->err.hint, "scontrol ping"));
}

/* A thousand seconds of polling: once a second at first, then at growing intervals. */
static void test_slurm_is_not_asked_all_the_time(void **state)
{
    struct fixture *f = *state;
    struct orl_part_status status[3];
    assert_int_equal(start(f), 0);
    for (int i = 0; i < 10000; i++) {
        clock_s += 0.1;
        assert_int_equal(poll_parts(f, status), 0);
    }
    const int asked = count_lines(f, "squeue.args");
    if (asked < 20 || asked > 210)
        fail_msg("asked %d times", asked);
}

static void test_cancel_goes_on_until_all_are_gone(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(start(f), 0);
    cli_write_file(f->folder, "queue", "0|R\n");
    cli_write_file(f->folder, "scancel.fails", "");
    assert_int_equal(f->runner.cancel(f->runner.ctx, "wave1", &f->err), 0);
    assert_int_equal(count_lines(f, "scancel.args"), 2);
    assert_holds(f, "scancel.args", "--name=oriel-0123456789ab-wave1");
}

static void test_cancel_gives_up(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(start(f), 0);
    cli_write_file(f->folder, "queue", "0|R\n");
    cli_write_file(f->folder, "scancel.never", "");
    tick_s = 20;
    assert_int_equal(f->runner.cancel(f->runner.ctx, "wave1", &f->err), ORL_ERR_IO);
    assert_non_null(strstr(f->err.hint, "scancel --name=oriel-0123456789ab-wave1"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_what_is_handed_in, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_limits_have_bounds, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_what_a_part_came_up_against, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_refusal_ends_it, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_slurm_is_away_at_the_start, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_sbatch_hangs, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_outage_limit, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_slurm_is_not_asked_all_the_time, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_goes_on_until_all_are_gone, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_cancel_gives_up, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
