#include <math.h>
#include <stdatomic.h>
#include <time.h>

#include "bench/bench.h"
#include "study/speed.h"

struct measurement {
    const struct orl_geometry *geometry;
    int runs;
    uint32_t members;
    atomic_uint there;
    double rates[BENCH_MOST_THREADS];
};

/* Measures one thread; the threads wait for each other, so that all run at once. */
static void measure_member(void *arg, size_t index, uint32_t member)
{
    const struct timespec pause = {0, 20000};
    struct measurement *m = arg;
    (void)member;
    atomic_fetch_add(&m->there, 1);
    while (atomic_load(&m->there) < m->members)
        nanosleep(&pause, NULL);
    m->rates[index] = orl_ray_rate(m->geometry, 1 << 19, m->runs, NULL, bench_own_s, NULL);
}

double bench_embree_rate(const struct orl_geometry *geometry, struct orl_thread_pool *pool,
                         int runs)
{
    struct measurement m = {
        .geometry = geometry, .runs = runs, .members = orl_thread_pool_size(pool)};
    const uint32_t members = orl_thread_pool_size(pool);
    double rate = 0;
    if (members > BENCH_MOST_THREADS)
        bench_fail("too many threads", NULL);
    orl_parallel_for(pool, members, measure_member, &m);
    for (uint32_t i = 0; i < members; i++)
        rate += m.rates[i];
    if (!isfinite(rate))
        bench_fail("no ray hit anything", NULL);
    return rate;
}
