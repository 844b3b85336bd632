/* Durable commits, and requests that wait for them: tested by counting syncs, and by making them
 * fail. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "store/durability/wal.h"
#include "store/rows/scenes.h"
#include "support/data_folder.h"

/* ---- Syncs ---------------------------------------------------------------------------------- */

static atomic_int syncs_of_log,
    failing; /* failing: number of following syncs, of any file, that fail */
static pthread_t loop_thread;
static atomic_int syncs_on_loop;

/* Replaces the C library's fdatasync. */
int fdatasync(int fd)
{
    char link[64], path[ORL_PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t size = readlink(link, path, sizeof path - 1);
    path[size > 0 ? size : 0] = '\0';
    syncs_of_log += strstr(path, "-wal") != NULL;
    syncs_on_loop += pthread_equal(pthread_self(), loop_thread) != 0;
    if (failing > 0) {
        failing--;
        errno = EIO;
        return -1;
    }
    return (int)syscall(SYS_fdatasync, fd);
}

/* ---- Fixture -------------------------------------------------------------------------------- */

struct waiter {
    struct orl_wal_sync_wait wait;
    int told, rc;
    char message[ORL_ERROR_TEXT_MAX];
};

struct fixture {
    struct data_folder data;
    struct orl_wal_sync *wal_sync;
    struct waiter waiters[20];
    int quiet;
    struct orl_error err;
};

static void on_quiet(void *ctx)
{
    struct fixture *f = ctx;
    f->quiet++;
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    char path[ORL_PATH_MAX];
    *state = f;
    loop_thread = pthread_self();
    failing = 0;
    if (data_folder_make(&f->data, &f->err) || orl_db_serve(&f->data.db, &f->err))
        return -1;
    orl_folders_path(&f->data.folders, path, "oriel.db");
    return orl_wal_sync_open(uv_default_loop(), &f->data.db, path, on_quiet, f, &f->wal_sync,
                             &f->err);
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    orl_wal_sync_stop(f->wal_sync);
    uv_run(uv_default_loop(), UV_RUN_DEFAULT);
    orl_wal_sync_free(f->wal_sync);
    data_folder_close(&f->data);
    data_folder_remove(&f->data);
    free(f);
    return 0;
}

static void on_synced(struct orl_wal_sync_wait *wait, int rc, const struct orl_error *err)
{
    struct waiter *waiter = (struct waiter *)wait;
    waiter->told++;
    waiter->rc = rc;
    if (rc)
        snprintf(waiter->message, sizeof waiter->message, "%s", err->message);
}

static void commit(struct fixture *f, int number)
{
    char id[ORL_SHA_HEX];
    bool created = false;
    snprintf(id, sizeof id, "%064d", number);
    assert_int_equal(orl_bsdf_insert(&f->data.db, id, "b", 1, "{}", &created, &f->err), 0);
}

static struct waiter *ask_for_sync(struct fixture *f, int i)
{
    struct waiter *waiter = &f->waiters[i];
    *waiter = (struct waiter){.wait.synced = on_synced};
    orl_wal_sync_request(f->wal_sync, &waiter->wait);
    return waiter;
}

static void wait_for_syncs(const struct fixture *f)
{
    while (!orl_wal_sync_is_idle(f->wal_sync))
        uv_run(uv_default_loop(), UV_RUN_ONCE);
}

/* ---- Tests ---------------------------------------------------------------------------------- */

static void test_told_once_it_is_safe(void **state)
{
    struct fixture *f = *state;
    commit(f, 1); /* the commit starts a new log, which SQLite syncs */
    syncs_on_loop = 0;
    syncs_of_log = 0;
    commit(f, 2);
    const uint64_t last = orl_wal_sync_last_commit(f->wal_sync);
    assert_false(orl_wal_sync_is_durable(f->wal_sync, last));
    assert_int_equal(syncs_of_log, 0);
    const struct waiter *waiter = ask_for_sync(f, 0);
    assert_int_equal(waiter->told, 0);
    wait_for_syncs(f);
    assert_int_equal(waiter->told, 1);
    assert_int_equal(waiter->rc, 0);
    assert_true(orl_wal_sync_is_durable(f->wal_sync, last));
    assert_int_equal(syncs_of_log, 1);
    assert_int_equal(syncs_on_loop, 0);
    assert_int_equal(f->quiet, 1);
    commit(f, 3);
    assert_false(orl_wal_sync_is_durable(f->wal_sync, orl_wal_sync_last_commit(f->wal_sync)));
}

/* Twenty requests in one turn of the loop share the syncs that the thread has not begun. */
static void test_syncs_are_shared(void **state)
{
    struct fixture *f = *state;
    commit(f, 0);
    syncs_of_log = 0;
    for (int i = 0; i < 20; i++) {
        commit(f, 1 + i);
        ask_for_sync(f, i);
    }
    wait_for_syncs(f);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(f->waiters[i].told, 1);
        assert_int_equal(f->waiters[i].rc, 0);
    }
    assert_in_range(syncs_of_log, 1, 20);
    assert_true(orl_wal_sync_is_durable(f->wal_sync, orl_wal_sync_last_commit(f->wal_sync)));
}

/* One sync fails: the log's content is made durable in the other way, and so are commits until a
 * new log starts, which is at the next commit. */
static void test_a_sync_fails(void **state)
{
    struct fixture *f = *state;
    for (int i = 0; i < 5; i++)
        commit(f, i);
    failing = 1;
    const struct waiter *first = ask_for_sync(f, 0);
    wait_for_syncs(f);
    assert_int_equal(failing, 0);
    assert_int_equal(first->rc, 0);
    commit(f, 10);
    const struct waiter *second = ask_for_sync(f, 1);
    wait_for_syncs(f);
    assert_int_equal(second->rc, 0);
    commit(f, 11);
    syncs_of_log = 0;
    const struct waiter *third = ask_for_sync(f, 2);
    wait_for_syncs(f);
    assert_int_equal(third->rc, 0);
    assert_int_equal(syncs_of_log, 1); /* syncs of the log are trusted again */
}

/* All syncs fail: requests get errors, nothing is reported durable, and when they succeed again
 * everything is. */
static void test_a_disk_that_fails(void **state)
{
    struct fixture *f = *state;
    commit(f, 1);
    commit(f, 2);
    const uint64_t last = orl_wal_sync_last_commit(f->wal_sync);
    failing = 1000;
    for (int i = 0; i < 3; i++) {
        const struct waiter *waiter = ask_for_sync(f, i);
        wait_for_syncs(f);
        assert_true(waiter->rc < 0);
        assert_non_null(strstr(waiter->message, "database"));
        assert_false(orl_wal_sync_is_durable(f->wal_sync, last));
    }
    failing = 0;
    const struct waiter *waiter = ask_for_sync(f, 3);
    wait_for_syncs(f);
    assert_int_equal(waiter->rc, 0);
    assert_true(orl_wal_sync_is_durable(f->wal_sync, last));
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_told_once_it_is_safe),
        EACH(test_syncs_are_shared),
        EACH(test_a_sync_fails),
        EACH(test_a_disk_that_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
