/* A wall clock that jumps forwards, while a daemon runs and between two runs: data kept for some
 * days is not removed early. */
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

#include "process/limits.h"
#include "support/daemon.h"
#include "support/storage.h"

static const char *const a_day[] = {"--keep-days", "1", NULL};

static void shift_clock(const struct daemon *daemon, long long seconds)
{
    char path[96];
    snprintf(path, sizeof path, "%s/shift", daemon->root);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%lld", seconds);
    fclose(file);
}

static void make_old(const struct daemon *daemon, const char *job)
{
    char sql[200];
    snprintf(sql, sizeof sql,
             "UPDATE jobs SET retained_ms = retained_ms - 2 * 86400000 WHERE id = '%s'",
             strrchr(job, '/') + 1);
    storage_run_sql(daemon, sql);
}

/* Makes two jobs, the first of which is two days old by the daemon's clock. */
static void make_jobs(struct daemon_room *f, char ret_old[80], char ret_new[80])
{
    storage_run_job(&f->daemon, f->scene, 1, "v", ret_old);
    storage_run_job(&f->daemon, f->scene, 2, "v", ret_new);
    storage_fetch(&f->daemon, ret_new, 200); /* so that it may be removed */
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    make_old(&f->daemon, ret_old);
}

static void test_jump_between_runs(void **state)
{
    struct daemon_room *f = *state;
    char old[80], kept[80];
    make_jobs(f, old, kept);
    /* The state after a year, or after a clock jump of a year. */
    storage_run_sql(&f->daemon, "UPDATE data_folder SET wall_ms = wall_ms - 365 * 86400000");
    daemon_restart(&f->daemon, a_day);
    daemon_wait_status(&f->daemon, old, 404);
    storage_fetch(&f->daemon, kept, 200);
}

static void test_jump_while_running(void **state)
{
    struct daemon_room *f = *state;
    const char *build = getenv("ORIEL_BUILD");
    char old[80], kept[80], later[80], shim[300], path[96];
    if (ORL_SANITIZED)
        skip(); /* the sanitizer's library has to be loaded first */
    make_jobs(f, old, kept);
    snprintf(shim, sizeof shim, "%s/tests/shifted.so", build ? build : "build");
    snprintf(path, sizeof path, "%s/shift", f->daemon.root);
    shift_clock(&f->daemon, 0);
    setenv("LD_PRELOAD", shim, 1);
    setenv("SHIFTED", path, 1);
    daemon_restart(&f->daemon, a_day);
    unsetenv("LD_PRELOAD");
    daemon_wait_status(&f->daemon, old, 404);
    shift_clock(&f->daemon, 365 * 86400);
    /* New jobs are a year younger by the wall clock; an older job is not removed sooner because of
     * that. */
    storage_run_job(&f->daemon, f->scene, 3, "v", later);
    assert_int_equal(daemon_end(&f->daemon, SIGTERM), 0);
    make_old(&f->daemon, later);
    setenv("LD_PRELOAD", shim, 1);
    daemon_restart(&f->daemon, a_day);
    unsetenv("LD_PRELOAD");
    daemon_wait_status(&f->daemon, later, 404);
    storage_fetch(&f->daemon, kept, 200);
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, daemon_room_set_up, daemon_room_tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_jump_between_runs),
        EACH(test_jump_while_running),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
