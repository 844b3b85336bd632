/*
 * A cancel at the k-th poll, for every k, of all work on photons: the map file's order, and the
 * indexes of the techniques. Each step polls many times, returns the cancellation error and leaks
 * nothing (AddressSanitizer checks).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light/virtual_suns.h"
#include "photon/density/precomputed_irradiance.h"
#include "photon/map/quantization.h"
#include "render/gather/icache.h"
#include "render/technique/photon_maps.h"
#include "support/scene_text.h"

static atomic_int polls;     /* polls since the count began */
static atomic_int cancel_at; /* the poll from which on the result is true; negative: never */

/* Replaces core/base/threads/cancel.c: the core's polls call this. */
bool orl_is_cancelled(const atomic_bool *cancel)
{
    if (!cancel)
        return false;
    const int poll = atomic_fetch_add(&polls, 1), at = atomic_load(&cancel_at);
    return at >= 0 && poll >= at;
}

enum { PHOTONS = 80000, FACETS = 2 };

static const char scene[] = "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                            "w polygon a 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
                            "w polygon b 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3\n";

/* The inputs of a photon map; equal for each build. */
struct bench {
    struct orl_lit_scene *lit_scene;
    struct orl_thread_pool *pool;
    struct orl_photon *photons;
    struct orl_photon_map *map;
    struct orl_search *search;
};

typedef int (*making)(const struct bench *bench);

static int make_map(const struct bench *bench)
{
    const struct orl_map_build build = {
        .kind = "global", .emitted = 1, .seed = 1, .extent = bench->lit_scene->geometry->radius};
    struct orl_photon_map *map = NULL;
    struct orl_error err;
    const int code = orl_photon_map_build(bench->photons, PHOTONS, &build, bench->pool, &map, &err);
    orl_photon_map_free(map);
    return code;
}

static int make_gather(const struct bench *bench, const struct orl_indirect_estimator *indirect)
{
    const struct orl_photon_map *maps[ORL_MAP_KINDS] = {
        [ORL_MAP_GLOBAL] = bench->map, [ORL_MAP_CAUSTIC] = bench->map};
    struct orl_gather gather;
    int code = orl_gather_init(&gather, bench->lit_scene, indirect, maps, NULL, 1, bench->pool,
                               bench->search);
    if (code == 0)
        code = orl_gather_for_views(&gather, bench->pool);
    orl_gather_done(&gather);
    return code;
}

static int make_final_gather(const struct bench *bench)
{
    return make_gather(bench, &orl_indirect_gathered);
}

static int make_density(const struct bench *bench)
{
    return make_gather(bench, &orl_indirect_density);
}

/* Runs neighbour clamping; a cancelled run leaves the radii unchanged. */
static int hold_records_back(const struct bench *bench)
{
    enum { COUNT = 400 };
    struct orl_icache cache;
    orl_icache_init(&cache, 1);
    for (int i = 0; i < COUNT; i++) {
        const struct orl_irradiance_record record = {
            .place = {.point = orl_v3(i % 20, i / 20, 0), .normal = orl_v3(0, 0, 1)},
            .radius = 1 + i % 7 * 4};
        assert_int_equal(orl_icache_add(&cache, &record, 1), 0);
    }
    assert_int_equal(orl_icache_index(&cache), 0);
    const int code = orl_icache_clamp_neighbours(&cache, bench->pool);
    for (int i = 0; i < COUNT && code < 0; i++)
        assert_true(cache.records[i].radius == 1 + i % 7 * 4);
    orl_icache_done(&cache);
    return code;
}

static void set_up(struct bench *bench)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    assert_true(sodium_init() >= 0);
    bench->lit_scene = build_lit_scene(scene, NULL, NULL, NULL);
    bench->pool = orl_thread_pool_new(1);
    bench->photons = malloc(PHOTONS * sizeof *bench->photons);
    bench->search = calloc(1, sizeof *bench->search);
    for (uint32_t i = 0; i < PHOTONS; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(bench->lit_scene->geometry, i % FACETS, u, &point, &normal);
        bench->photons[i] =
            (struct orl_photon){.position = {(float)point.x, (float)point.y, (float)point.z},
                                .flux = {1, 1, 1},
                                .batch = (uint8_t)(i / FACETS % ORL_MAP_BATCHES),
                                .normal = orl_normal_encode(normal)};
    }
    const struct orl_map_build build = {
        .kind = "global", .emitted = 1, .seed = 1, .extent = bench->lit_scene->geometry->radius};
    struct orl_error err;
    assert_int_equal(
        orl_photon_map_build(bench->photons, PHOTONS, &build, bench->pool, &bench->map, &err), 0);
}

static void tear_down(struct bench *bench)
{
    orl_photon_map_free(bench->map);
    orl_lit_scene_free(bench->lit_scene);
    orl_thread_pool_free(bench->pool);
    free(bench->photons);
    free(bench->search);
}

static int make_with(making make, const struct bench *bench, int at)
{
    static const atomic_bool never;
    orl_thread_pool_set_cancel(bench->pool, &never);
    atomic_store(&polls, 0);
    atomic_store(&cancel_at, at);
    const int code = make(bench);
    atomic_store(&cancel_at, -1);
    return code;
}

static void test_polls(void **state)
{
    /* A chunk is some hundreds or thousands of photons, in each pass. */
    static const struct {
        const char *name;
        making make;
        int least;
    } cases[] = {{"map", make_map, 40},
                 {"final gather", make_final_gather, 200},
                 {"density", make_density, 20},
                 {"records held back", hold_records_back, 400}};
    struct bench bench = {0};
    (void)state;
    set_up(&bench);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(make_with(cases[i].make, &bench, -1), 0);
        const int most = atomic_load(&polls), step = most / 60 + 1;
        print_message("# %s: %d polls\n", cases[i].name, most);
        assert_true(most >= cases[i].least);
        for (int at = 0; at < most; at += step)
            assert_int_equal(make_with(cases[i].make, &bench, at), ORL_ERR_CANCELLED);
    }
    tear_down(&bench);
}

/* Suns in a thousand mirrors: a poll at each mirror. */
static void test_lights(void **state)
{
    enum { MIRRORS = 1000 };
    static char text[MIRRORS * 80 + 512];
    size_t length = (size_t)snprintf(text, sizeof text,
                                     "void mirror m 0 0 3 .9 .9 .9\nvoid light l 0 0 3 1 1 1\n"
                                     "l source sun 0 0 4 0 .3 1 .5\n");
    (void)state;
    for (int i = 0; i < MIRRORS; i++)
        length += (size_t)snprintf(text + length, sizeof text - length,
                                   "m polygon p%d 0 0 9 %d 0 0 %d.5 0 0 %d 1 0\n", i, i, i, i);
    struct bench bench = {.lit_scene = build_lit_scene(text, NULL, NULL, NULL),
                          .pool = orl_thread_pool_new(1)};
    struct orl_virtual_suns images;
    static const atomic_bool never;
    orl_thread_pool_set_cancel(bench.pool, &never);
    atomic_store(&polls, 0);
    atomic_store(&cancel_at, MIRRORS / 2);
    assert_int_equal(orl_virtual_suns_build(&images, bench.lit_scene, bench.pool),
                     ORL_ERR_CANCELLED);
    orl_virtual_suns_done(&images);
    assert_int_equal(atomic_load(&polls), MIRRORS / 2 + 1);
    atomic_store(&cancel_at, -1);
    orl_lit_scene_free(bench.lit_scene);
    orl_thread_pool_free(bench.pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_polls), cmocka_unit_test(test_lights)};
    atomic_store(&cancel_at, -1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
