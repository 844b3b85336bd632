/* Warnings of the daemon when its pool or its loop is too slow. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <semaphore.h>
#include <stdlib.h>
#include <unistd.h>

#include "health/metrics.h"

static sem_t gate;

static void wait_at_gate(uv_work_t *work)
{
    (void)work;
    sem_wait(&gate);
}

static void passed(uv_work_t *work, int status)
{
    (void)work, (void)status;
}

/* A busy pool of one thread: the probe waits, and is sent once. */
static void test_busy_pool(void **state)
{
    struct orl_loop_watchdog watchdog = {0};
    uv_loop_t loop;
    uv_work_t busy;
    (void)state;
    sem_init(&gate, 0, 0);
    assert_int_equal(uv_loop_init(&loop), 0);
    orl_loop_watchdog_open(&watchdog, &loop);
    assert_true(orl_loop_watchdog_pool_s(&watchdog) == 0);
    uv_queue_work(&loop, &busy, wait_at_gate, passed);
    orl_loop_watchdog_ping(&watchdog);
    usleep(50000);
    orl_loop_watchdog_ping(&watchdog);
    uv_run(&loop, UV_RUN_NOWAIT);
    assert_true(watchdog.pending);
    assert_true(orl_loop_watchdog_pool_s(&watchdog) >= 0.05);
    sem_post(&gate);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_false(watchdog.pending);
    assert_true(orl_loop_watchdog_pool_s(&watchdog) >= 0.05); /* the probe's actual time */
    const double slow_s = watchdog.latency_s;
    /* At least one of many probes is answered sooner, even on a busy machine. */
    double soonest_s = slow_s;
    for (int i = 0; i < 200 && soonest_s >= slow_s; i++) {
        orl_loop_watchdog_ping(&watchdog);
        uv_run(&loop, UV_RUN_DEFAULT);
        soonest_s = orl_loop_watchdog_pool_s(&watchdog);
    }
    assert_true(soonest_s < slow_s);
    uv_loop_close(&loop);
    sem_destroy(&gate);
}

static void on_timer(uv_timer_t *timer)
{
    usleep(30000);
    uv_close((uv_handle_t *)timer, NULL);
}

static void on_prepare(uv_prepare_t *prepare)
{
    struct orl_loop_watchdog *watchdog = prepare->data;
    orl_loop_watchdog_end_turn(watchdog);
    if (watchdog->longest_s >= 0.03)
        uv_close((uv_handle_t *)prepare, NULL);
}

/* Runs turns of a loop that waits for 0.3 s and then works for 0.03 s. Returns the sum of their
 * seconds. */
static double sum_turns(void)
{
    struct orl_loop_watchdog watchdog = {0};
    uv_loop_t loop;
    uv_timer_t timer;
    uv_prepare_t prepare;
    assert_int_equal(uv_loop_init(&loop), 0);
    orl_loop_watchdog_open(&watchdog, &loop);
    uv_timer_init(&loop, &timer);
    uv_timer_start(&timer, on_timer, 300, 0);
    uv_prepare_init(&loop, &prepare);
    prepare.data = &watchdog;
    uv_prepare_start(&prepare, on_prepare);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_true(watchdog.longest_s >= 0.03);
    uv_loop_close(&loop);
    return watchdog.turns.sum;
}

/* The time of a turn excludes its waiting. Other processes may prolong turns, so the least sum of
 * twenty runs is compared. */
static void test_turns(void **state)
{
    double least_s = 1;
    (void)state;
    for (int i = 0; i < 20 && least_s >= 0.25; i++)
        least_s = fmin(least_s, sum_turns());
    assert_true(least_s < 0.25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_busy_pool),
        cmocka_unit_test(test_turns),
    };
    setenv("UV_THREADPOOL_SIZE", "1", 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
