/*
 * Thread pools: every index is done once, for any number of worker threads, late or absent. Meant
 * to be run under ThreadSanitizer as well.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <pthread.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>

enum { MOST = 8 };

/* Results of a loop. Fields that only one thread writes are not atomic. */
struct loop {
    uint32_t *done; /* one per index */
    uint32_t per_member[MOST];
    uint32_t size;
    atomic_uint bad_member;
};

static void count_index(void *arg, size_t index, uint32_t member)
{
    struct loop *loop = arg;
    loop->done[index]++;
    if (member < loop->size)
        loop->per_member[member]++;
    else
        atomic_fetch_add(&loop->bad_member, 1);
}

/* Runs a loop and checks that the lead thread sees all writes of the others when it returns. */
static void check_loop(struct orl_thread_pool *pool, size_t n)
{
    struct loop loop = {.done = calloc(n + 1, sizeof *loop.done),
                        .size = orl_thread_pool_size(pool)};
    uint64_t sum = 0;
    assert_non_null(loop.done);
    atomic_init(&loop.bad_member, 0);
    orl_parallel_for(pool, n, count_index, &loop);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(loop.done[i], 1);
    assert_int_equal(loop.done[n], 0);
    assert_int_equal(atomic_load(&loop.bad_member), 0);
    for (uint32_t m = 0; m < loop.size; m++)
        sum += loop.per_member[m];
    assert_int_equal(sum, n);
    free(loop.done);
}

static void test_every_index_once(void **state)
{
    static const uint32_t sizes[] = {1, 2, 7};
    static const size_t counts[] = {0, 1, 2, 3, 100, 10000};
    (void)state;
    for (int s = 0; s < 3; s++) {
        struct orl_thread_pool *pool = orl_thread_pool_start(sizes[s]);
        assert_non_null(pool);
        assert_int_equal(orl_thread_pool_size(pool), sizes[s]);
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
            check_loop(pool, counts[c]);
        orl_thread_pool_stop(pool);
    }
}

/* Thousands of short loops in sequence: no server joins the wrong one. */
static void test_many_short_loops(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(4);
    (void)state;
    for (size_t i = 0; i < 3000; i++)
        check_loop(pool, i % 5);
    orl_thread_pool_stop(pool);
}

/* A pool of seven without any worker thread: the lead thread does all the work. */
static void test_absent_servers(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_new(7);
    (void)state;
    assert_non_null(pool);
    check_loop(pool, 1000);
    orl_thread_pool_dismiss(pool);
    orl_thread_pool_free(pool);
}

struct server {
    struct orl_thread_pool *pool;
    uint32_t member;
    pthread_t thread;
};

static void *serve(void *arg)
{
    const struct server *server = arg;
    orl_thread_pool_work(server->pool, server->member);
    return NULL;
}

/* Worker threads that arrive between loops, and one after the pool's dismissal, which returns at
 * once. */
static void test_late_servers(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_new(4);
    struct server servers[3];
    (void)state;
    for (uint32_t m = 1; m < 4; m++) {
        check_loop(pool, 200);
        if (m == 3)
            orl_thread_pool_dismiss(pool);
        servers[m - 1] = (struct server){.pool = pool, .member = m};
        assert_int_equal(pthread_create(&servers[m - 1].thread, NULL, serve, &servers[m - 1]), 0);
        if (m < 3)
            check_loop(pool, 2000);
    }
    for (int i = 0; i < 3; i++)
        pthread_join(servers[i].thread, NULL);
    orl_thread_pool_free(pool);
}

/* Servers dismissed while they wait, without any work: all return. */
static void test_dismiss_idle(void **state)
{
    (void)state;
    for (int i = 0; i < 50; i++)
        orl_thread_pool_stop(orl_thread_pool_start(3));
    orl_thread_pool_stop(NULL);
    orl_thread_pool_free(NULL);
}

struct ending {
    atomic_bool cancel;
    atomic_size_t done;
};

static void cancel_in_the_middle(void *arg, size_t index, uint32_t member)
{
    struct ending *ending = arg;
    (void)index, (void)member;
    if (atomic_fetch_add(&ending->done, 1) == 99)
        atomic_store(&ending->cancel, true);
}

/* A cancel flag ends only loops that check it; the flag can be removed again. */
static void test_cancelled_loops(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(4);
    struct ending ending;
    (void)state;
    atomic_init(&ending.cancel, false);
    atomic_init(&ending.done, 0);
    assert_int_equal(orl_parallel_try(pool, 1000, cancel_in_the_middle, &ending), 0);
    assert_int_equal(atomic_load(&ending.done), 1000);
    atomic_store(&ending.cancel, false);
    atomic_store(&ending.done, 0);
    orl_thread_pool_set_cancel(pool, &ending.cancel);
    assert_int_equal(orl_parallel_try(pool, 1000, cancel_in_the_middle, &ending),
                     ORL_ERR_CANCELLED);
    assert_in_range(atomic_load(&ending.done), 100, 100 + MOST);
    assert_true(orl_thread_pool_cancelled(pool));
    check_loop(pool, 500);
    assert_int_equal(orl_parallel_try(pool, 10, cancel_in_the_middle, &ending), ORL_ERR_CANCELLED);
    orl_thread_pool_set_cancel(pool, NULL);
    assert_int_equal(orl_parallel_try(pool, 10, cancel_in_the_middle, &ending), 0);
    orl_thread_pool_stop(pool);
}

/* A pool of size 0 counts as 1. */
static void test_size_zero(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(0);
    (void)state;
    assert_int_equal(orl_thread_pool_size(pool), 1);
    check_loop(pool, 10);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_index_once), cmocka_unit_test(test_many_short_loops),
        cmocka_unit_test(test_absent_servers),   cmocka_unit_test(test_late_servers),
        cmocka_unit_test(test_dismiss_idle),     cmocka_unit_test(test_size_zero),
        cmocka_unit_test(test_cancelled_loops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
