#include <math.h>

#include "bench/bench.h"
#include "study/speed.h"

double bench_embree_rate(const struct orl_geometry *geometry, int runs, double (*now_s)(void *ctx))
{
    const double rate = orl_ray_rate(geometry, 1 << 20, runs, now_s, NULL);
    if (!isfinite(rate))
        bench_fail("no ray hit anything", NULL);
    return rate;
}
