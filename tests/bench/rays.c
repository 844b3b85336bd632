#include <math.h>

#include "bench/bench.h"
#include "study/speed.h"

struct measurement {
    const struct orl_geometry *geometry;
    int runs;
    double (*now_s)(void *ctx);
    double rates[BENCH_MOST_THREADS];
};

static void measure(void *arg, size_t index, uint32_t member)
{
    struct measurement *m = arg;
    (void)member;
    m->rates[index] = orl_ray_rate(m->geometry, 1 << 19, m->runs, NULL, m->now_s, NULL);
}

double bench_embree_rate(const struct orl_geometry *geometry, struct orl_crew *crew, int runs,
                         double (*now_s)(void *ctx))
{
    struct measurement m = {.geometry = geometry, .runs = runs, .now_s = now_s};
    const uint32_t members = orl_crew_size(crew);
    double rate = 0;
    if (members > BENCH_MOST_THREADS)
        bench_fail("too many threads", NULL);
    orl_crew_for(crew, members, measure, &m);
    for (uint32_t i = 0; i < members; i++)
        rate += m.rates[i];
    if (!isfinite(rate))
        bench_fail("no ray hit anything", NULL);
    return rate;
}
