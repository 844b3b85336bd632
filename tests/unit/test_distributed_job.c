/*
 * Rounds of parts, from their files to their ends. A program of the test's own replaces oriel: it
 * records that it ran, and acts by files beside it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "distributed/distributed_job.h"
#include "support/cli.h"

/*
 * oriel part FILE. The files "fails", "full" and "dies" hold the number of times that a part will
 * still do so. The process that writes a file to the job's folder is the one that the runner ends,
 * not a child of it.
 */
static const char program[] =
    "#!/bin/sh\n"
    "cd \"${0%/*}\" && stem=${2%.json} name=${2##*/}\n"
    "echo \"$name\" >>ran\n"
    "less() { [ -s \"$1\" ] && sed -i 1d \"$1\"; }\n"
    "[ ! -e slow ] || exec sleep 20\n"
    "less dies && exit 1\n"
    "less fails && { echo '{\"type\": \"urn:oriel:error:out-of-range\", "
    "\"detail\": \"the glass is cracked\"}' >e; exec mv e \"$stem.error\"; }\n"
    "less full && { echo '{\"type\": \"urn:oriel:error:disk-full\", "
    "\"detail\": \"no room\"}' >e; exec mv e \"$stem.error\"; }\n"
    "echo '{}' >\"$stem.done\"\n";

/* Speed factor of a distributed job's clock. */
enum { HASTE = 50 };

struct fixture {
    char folder[64], job[96], program[96];
    json_t *doc;
    struct orl_distributed_job distributed;
    atomic_bool cancel, detach;
    struct orl_parts_count reported;
    double share;
    int n_events[3]; /* number of parts: starts, ends, further tries */
    struct orl_error err;
};

static double now_s(void *ctx)
{
    struct timespec now;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return HASTE * ((double)now.tv_sec + 1e-9 * (double)now.tv_nsec);
}

static void on_told(void *ctx, const struct orl_parts_count *count)
{
    ((struct fixture *)ctx)->reported = *count;
}

static void on_part_event(void *ctx, const struct orl_part_event *event)
{
    struct fixture *f = ctx;
    f->n_events[0] += strcmp(event->what, "start") == 0;
    f->n_events[1] += strcmp(event->what, "end") == 0;
    f->n_events[2] += strcmp(event->what, "again") == 0 && event->why;
}

static int open_distributed(struct fixture *f)
{
    const struct orl_distributed_job_spec spec = {.folder = f->job,
                                                  .doc = f->doc,
                                                  .threads = 1,
                                                  .most = 3,
                                                  .program = f->program,
                                                  .most_processes = 1,
                                                  .cancel = &f->cancel,
                                                  .detach = &f->detach,
                                                  .now_s = now_s,
                                                  .reported = on_told,
                                                  .part_event = on_part_event,
                                                  .ctx = f};
    return orl_distributed_job_open(&f->distributed, &spec, &f->err);
}

static int set_up(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    cli_make_folder(f->folder);
    snprintf(f->job, sizeof f->job, "%s/job", f->folder);
    snprintf(f->program, sizeof f->program, "%s/program", f->folder);
    cli_write_file(f->folder, "program", program);
    assert_int_equal(chmod(f->program, 0700), 0);
    f->doc = json_pack("{s:s}", "kind", "render");
    assert_int_equal(open_distributed(f), 0);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    orl_distributed_job_done(&f->distributed, true);
    assert_int_equal(access(f->job, F_OK), -1);
    json_decref(f->doc);
    cli_remove_folder(f->folder);
    free(f);
    return 0;
}

static const struct orl_job_task tasks[] = {{"view", "a0", 1, 0, 0}, {"view", "a1", 1, 0, 0},
                                            {"view", "a2", 1, 0, 0}, {"view", "a3", 1, 0, 0},
                                            {"view", "a4", 1, 0, 0}, {"view", "a5", 1, 0, 0}};
enum { PIECES = sizeof tasks / sizeof *tasks };

static void on_share(void *ctx, double share)
{
    struct fixture *f = ctx;
    assert_true(share >= f->share && share <= 1);
    f->share = share;
}

static int divide_job(struct fixture *f)
{
    const struct orl_job_tasks_watch watch = {on_share, f};
    f->share = 0;
    bool here[PIECES] = {false};
    return f->distributed.tasks.claim(f->distributed.tasks.ctx, tasks, PIECES, here, &watch,
                                      &f->err);
}

static int count_runs(const struct fixture *f)
{
    char *text = cli_read_file(f->folder, "ran");
    int n = 0;
    for (const char *at = text; at && *at; at++)
        n += *at == '\n';
    free(text);
    return n;
}

static void test_each_part_runs_once(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(divide_job(f), 0);
    assert_int_equal(count_runs(f), 3);
    assert_int_equal(f->reported.done, 3);
    assert_int_equal(f->reported.waiting + f->reported.running + f->reported.again, 0);
    assert_int_equal(f->reported.rounds, 1);
    assert_true(f->share == 1);
    assert_int_equal(f->n_events[0], 3);
    assert_int_equal(f->n_events[1], 3);
}

/* A part that fails or dies is run once more, and counted. */
static void test_parts_are_tried_again(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "fails", "x\n");
    cli_write_file(f->folder, "dies", "x\n");
    assert_int_equal(divide_job(f), 0);
    assert_int_equal(count_runs(f), 5);
    assert_int_equal(f->reported.again, 2);
    assert_int_equal(f->reported.done, 3);
    assert_int_equal(f->n_events[0], 5);
    assert_int_equal(f->n_events[2], 2);
}

static void test_a_part_fails_for_good(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "fails", "x\nx\nx\nx\nx\nx\nx\nx\nx\n");
    assert_int_equal(divide_job(f), ORL_ERR_RANGE);
    assert_non_null(strstr(f->err.message, "the glass is cracked"));
}

/* A full disk is not an error of a part: parts wait, and are retried until there is room. */
static void test_the_disk_is_full(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "full", "x\nx\nx\nx\nx\nx\nx\nx\nx\nx\n");
    assert_int_equal(divide_job(f), 0);
    assert_int_equal(count_runs(f), 13);
    assert_int_equal(f->reported.done, 3);
    assert_int_equal(f->reported.held, 0);
}

static void test_a_part_dies_for_good(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "dies", "x\nx\nx\nx\nx\nx\nx\nx\nx\n");
    assert_int_equal(divide_job(f), ORL_ERR_INTERNAL);
    assert_non_null(strstr(f->err.message, "3 times without a result"));
}

/* A run ends and leaves its round: the next run finishes that round, and starts none of its own. */
static void test_a_round_is_resumed(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "slow", "");
    atomic_store(&f->cancel, true);
    atomic_store(&f->detach, true);
    assert_int_equal(divide_job(f), ORL_ERR_CANCELLED);
    orl_distributed_job_done(&f->distributed, false); /* also ends the processes, as a kill would */
    char path[128];
    snprintf(path, sizeof path, "%s/slow", f->folder);
    assert_int_equal(unlink(path), 0);
    atomic_store(&f->cancel, false);
    assert_int_equal(open_distributed(f), 0);
    const int before = count_runs(f);
    assert_int_equal(divide_job(f), 0);
    assert_int_equal(count_runs(f), before + 3);
    assert_int_equal(f->reported.rounds, 1);
    assert_int_equal(f->reported.done, 3);
}

/* Without `detach` a cancelled round is removed, so that no run waits for it. */
static void test_a_cancelled_round_is_removed(void **state)
{
    struct fixture *f = *state;
    cli_write_file(f->folder, "slow", "");
    atomic_store(&f->cancel, true);
    assert_int_equal(divide_job(f), ORL_ERR_CANCELLED);
    char command[160];
    snprintf(command, sizeof command, "ls %s/*.wave >/dev/null 2>&1", f->job);
    assert_int_not_equal(system(command), 0); /* NOLINT(cert-env33-c) */
}

/* A folder that no run has made is refused, and not removed. */
static void test_a_folder_of_somebody_else(void **state)
{
    struct fixture *f = *state;
    orl_distributed_job_done(&f->distributed, true);
    assert_int_equal(mkdir(f->job, 0700), 0);
    assert_int_equal(open_distributed(f), ORL_ERR_INVALID);
    assert_non_null(strstr(f->err.message, "move it away"));
    assert_int_equal(rmdir(f->job), 0);
}

/* A runner that enforces limits on parts: the requests for the parts started last. */
static struct orl_runner inner;
static struct orl_part_request last_requests[PIECES];
static size_t n_last;
static enum orl_part_end says;

static int start_held(void *ctx, const char *round, const struct orl_part_request *requests,
                      size_t n, size_t n_all, struct orl_error *err)
{
    n_last = n;
    memcpy(last_requests, requests, n * sizeof *requests);
    return inner.start(ctx, round, requests, n, n_all, err);
}

static int poll_held(void *ctx, const char *round, struct orl_part_status *ret_status, size_t n,
                     struct orl_error *err)
{
    const int rc = inner.poll(ctx, round, ret_status, n, err);
    for (size_t i = 0; i < n; i++)
        ret_status[i].limits = (struct orl_part_limits){UINT32_MAX, 900};
    return rc;
}

static enum orl_part_end end_held(void *ctx, const char *round, uint32_t number)
{
    (void)ctx, (void)round, (void)number;
    return says;
}

static void hold_to_limits(struct fixture *f, enum orl_part_end end)
{
    inner = f->distributed.runner;
    f->distributed.runner.start = start_held;
    f->distributed.runner.poll = poll_held;
    f->distributed.runner.end = end_held;
    says = end;
}

/* A part that ran out of memory is restarted with twice as much. */
static void test_limits_are_raised(void **state)
{
    struct fixture *f = *state;
    f->distributed.spec.memory_bytes = 1;
    hold_to_limits(f, ORL_PART_OUT_OF_MEMORY);
    cli_write_file(f->folder, "dies", "1\n");
    assert_int_equal(divide_job(f), 0);
    assert_int_equal(n_last, 1);
    assert_int_equal(last_requests[0].limits.mib, 512);
    assert_true(f->distributed.count.again == 1);
}

/* The last request is 1024 MiB, and there are 900: the part is tried three times. */
static void test_limits_that_cannot_be_raised(void **state)
{
    struct fixture *f = *state;
    f->distributed.spec.memory_bytes = 1;
    hold_to_limits(f, ORL_PART_OUT_OF_MEMORY);
    cli_write_file(f->folder, "dies", "1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n");
    assert_int_equal(divide_job(f), ORL_ERR_LIMIT);
    assert_non_null(strstr(f->err.message, "exceeded its memory limit (900 MiB"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_each_part_runs_once, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_parts_are_tried_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_part_fails_for_good, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_the_disk_is_full, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_part_dies_for_good, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_round_is_resumed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_cancelled_round_is_removed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_folder_of_somebody_else, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_limits_are_raised, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_limits_that_cannot_be_raised, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
