/* The clock of a thread pool's work. Wrapping the functions that run loops (ld --wrap) separates
 * loops from the rest. */
#include <time.h>

#include "bench/bench.h"

static uint32_t pool_size = 1;
static double in_loops_s; /* the lead thread's seconds in loops */

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void __real_orl_parallel_for(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                             void *arg);
int __real_orl_parallel_try(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                            void *arg);
void __wrap_orl_parallel_for(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                             void *arg);
int __wrap_orl_parallel_try(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                            void *arg);

void __wrap_orl_parallel_for(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                             void *arg)
{
    const double started = read_clock(CLOCK_THREAD_CPUTIME_ID);
    __real_orl_parallel_for(pool, count, body, arg);
    in_loops_s += read_clock(CLOCK_THREAD_CPUTIME_ID) - started;
}

int __wrap_orl_parallel_try(struct orl_thread_pool *pool, size_t count, orl_loop_body body,
                            void *arg)
{
    const double started = read_clock(CLOCK_THREAD_CPUTIME_ID);
    const int code = __real_orl_parallel_try(pool, count, body, arg);
    in_loops_s += read_clock(CLOCK_THREAD_CPUTIME_ID) - started;
    return code;
}

void bench_set_pool(uint32_t members)
{
    pool_size = members;
}

double bench_pool_s(void *ctx)
{
    const double alone = read_clock(CLOCK_THREAD_CPUTIME_ID) - in_loops_s;
    return alone + (bench_cpu_s(ctx) - alone) / pool_size;
}
