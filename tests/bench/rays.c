#include <stdlib.h>

#include "base/random.h"
#include "bench/bench.h"
#include "scene/embree.h"
#include "scene/hemisphere.h"

enum { RAYS = 1 << 20 };

struct ray {
    struct orl_vec3 origin, direction;
};

/* Rays as light takes them: from random surfaces of the scene, cosine-weighted. */
static void make_rays(const struct orl_geometry *g, struct ray *rays)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    size_t n = 0;
    while (n < RAYS) {
        struct orl_vec3 point = orl_v3(0, 0, 0), direction = orl_v3(0, 1, 0);
        struct orl_hit hit;
        for (int bounce = 0; bounce < 8 && n < RAYS; bounce++) {
            const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
            if (!orl_geometry_intersect(g, point, direction, INFINITY, &hit))
                break;
            const struct orl_vec3 normal = hit.front ? hit.normal : orl_neg(hit.normal);
            direction = orl_hemisphere_about(normal, u, v);
            point = orl_hit_leave(g, &hit, direction);
            rays[n++] = (struct ray){point, direction};
        }
    }
    /* Neighbours in the array are neighbours on a path; a shuffle makes them strangers. */
    for (size_t i = RAYS - 1; i > 0; i--) {
        const size_t j = orl_random_bits(&random) % (i + 1);
        const struct ray swap = rays[i];
        rays[i] = rays[j];
        rays[j] = swap;
    }
}

double bench_embree_rate(const struct orl_geometry *geometry, int runs, double (*now_s)(void *ctx))
{
    struct ray *rays = malloc(RAYS * sizeof *rays);
    double rates[BENCH_MOST_RUNS];
    size_t hits = 0;
    if (!rays)
        bench_fail("out of memory", NULL);
    make_rays(geometry, rays);
    for (int run = 0; run < runs; run++) {
        const double started = now_s(NULL);
        for (size_t i = 0; i < RAYS; i++) {
            struct orl_embree_hit hit;
            hits +=
                orl_embree_intersect(geometry, rays[i].origin, rays[i].direction, INFINITY, &hit);
        }
        rates[run] = RAYS / (now_s(NULL) - started);
    }
    free(rays);
    if (hits == 0)
        bench_fail("no ray hit anything", NULL);
    return bench_median(rates, runs);
}
