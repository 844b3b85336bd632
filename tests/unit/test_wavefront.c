/*
 * Photons traced in waves leave what each would leave alone, to the last bit and in the same
 * order; batches of rays and samples equal single ones.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "photon/tracing/trace.h"
#include "scene/material/scatter.h"
#include "support/room.h"

enum { WAVES = 40, RAYS = 1000, DRAWS = 1000 };

/* This text's pane is the room's; the ball forces rays one by one. */
#define THINGS                                                                                     \
    "void metal shiny 0 0 5 .8 .7 .6 .9 .1\n!genbox shiny box .5 .5 .4 | xform -t 1.7 .4 .1\n"     \
    "void plastic ground 0 0 5 .2 .3 .2 0 0\n"                                                     \
    "ground polygon outside 0 0 12 -9 -9 -.1 9 -9 -.1 9 9 -.1 -9 9 -.1\n"
#define BALL "w sphere ball 0 0 4 2 3 2 .3\n"

static void check_waves(const char *text, const char *bsdf, bool caustic)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_emission *emission = NULL;
    struct orl_lit_scene *lit_scene = build_lit_scene(text, bsdf ? "pane.xml" : NULL, bsdf, pool);
    struct orl_deposits alone = {0}, together = {0};
    double points[ORL_EMISSIONS_AT_ONCE][ORL_SOBOL_DIMENSIONS];
    struct orl_random randoms[ORL_EMISSIONS_AT_ONCE];
    struct orl_photon_ray photon_rays[ORL_EMISSIONS_AT_ONCE];
    bool is_emitted[ORL_EMISSIONS_AT_ONCE];
    assert_int_equal(orl_emission_new(lit_scene, ORL_PHOTONS_FOR_MAPS, 1, pool, &emission, NULL),
                     0);
    for (size_t wave = 0; wave < WAVES; wave++) {
        const size_t n = ORL_EMISSIONS_AT_ONCE - wave % 3;
        struct orl_random random = orl_random_stream(wave, ORL_PURPOSE_BENCH, 0);
        for (size_t i = 0; i < n; i++)
            for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++)
                points[i][d] = orl_random_uniform(&random);
        for (size_t i = 0; i < n; i++) {
            struct orl_random own = orl_random_stream(wave, ORL_PURPOSE_PHOTON, i);
            struct orl_photon_ray photon_ray;
            bool was_emitted;
            orl_emission_sample_many(emission, (const double(*)[ORL_SOBOL_DIMENSIONS]) & points[i],
                                     1, caustic, &own, &alone.health, &photon_ray, &was_emitted);
            if (was_emitted)
                orl_trace_photon(lit_scene, &photon_ray, caustic, (uint8_t)(i % ORL_MAP_BATCHES),
                                 &own, &alone);
            randoms[i] = orl_random_stream(wave, ORL_PURPOSE_PHOTON, i);
        }
        orl_emission_sample_many(emission, (const double(*)[ORL_SOBOL_DIMENSIONS])points, n,
                                 caustic, randoms, &together.health, photon_rays, is_emitted);
        orl_trace_many(lit_scene, photon_rays, is_emitted, n, caustic, randoms, &together);
    }
    assert_true(alone.count > 100);
    assert_int_equal(alone.count, together.count);
    assert_memory_equal(alone.photons, together.photons, alone.count * sizeof *alone.photons);
    assert_int_equal(alone.health.rays, together.health.rays);
    assert_int_equal(alone.health.photons, together.health.photons);
    assert_int_equal(alone.health.paths, together.health.paths);
    assert_true(orl_sum_value(&alone.flux) == orl_sum_value(&together.flux));
    free(alone.photons);
    free(together.photons);
    orl_emission_free(emission);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

static void test_waves(void **state)
{
    char bsdf[2048];
    (void)state;
    scene_uniform_bsdf(0.2, bsdf);
    check_waves(ROOM_SUN ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE THINGS, NULL, false);
    check_waves(ROOM_SUN ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE THINGS, NULL, true);
    check_waves(ROOM_SUN ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE BALL, NULL, false);
    check_waves(ROOM_SUN ROOM_SKY ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE THINGS, bsdf, false);
    check_waves(ROOM_SUN ROOM_SKY ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE, bsdf, true);
}

/* Without any photon in the wave nothing is stored, and nothing is copied from NULL. */
static void test_none_is_emitted(void **state)
{
    struct orl_lit_scene *lit_scene =
        build_lit_scene(ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE, NULL, NULL, NULL);
    struct orl_deposits deposits = {0};
    static const struct orl_photon_ray photon_rays[ORL_EMISSIONS_AT_ONCE];
    static const bool is_emitted[ORL_EMISSIONS_AT_ONCE];
    static struct orl_random randoms[ORL_EMISSIONS_AT_ONCE];
    (void)state;
    orl_trace_many(lit_scene, photon_rays, is_emitted, ORL_EMISSIONS_AT_ONCE, false, randoms,
                   &deposits);
    assert_int_equal(deposits.count, 0);
    assert_null(deposits.photons);
    orl_lit_scene_free(lit_scene);
}

static void check_rays(const char *text, bool alike)
{
    struct orl_geometry *g = scene_geometry(text);
    struct orl_ray rays[RAYS];
    struct orl_hit hits[RAYS], hit;
    bool found[RAYS];
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, alike);
    for (size_t i = 0; i < RAYS; i++) {
        const double x = orl_random_uniform(&random), y = orl_random_uniform(&random);
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        rays[i].origin = orl_v3(x - 0.5, y - 0.5, 0.7);
        rays[i].direction =
            orl_hemisphere_about(orl_v3(0, 0, -1), alike ? 0.45 + 0.1 * u : u, alike ? 0.5 : v);
    }
    rays[7].origin.x = NAN;
    orl_geometry_intersect_many(g, rays, RAYS, alike, hits, found);
    for (size_t i = 0; i < RAYS; i++) {
        const bool met =
            orl_geometry_intersect(g, rays[i].origin, rays[i].direction, INFINITY, &hit);
        assert_int_equal(met, found[i]);
        if (!met)
            continue;
        assert_int_equal(hit.facet, hits[i].facet);
        assert_true(hit.distance == hits[i].distance && hit.point.x == hits[i].point.x);
        assert_int_equal(hit.front, hits[i].front);
    }
    assert_false(found[7]);
    orl_geometry_free(g);
}

static void test_rays(void **state)
{
    (void)state;
    check_rays(ROOM_GREY ROOM_SHELL THINGS, false);
    check_rays(ROOM_GREY ROOM_SHELL THINGS, true);
    check_rays(ROOM_GREY ROOM_SHELL BALL, false);
}

static void test_draws(void **state)
{
    static const char *const files[] = {"tests/fixtures/bsdf_lcp8.xml",
                                        "tests/fixtures/bsdf_klems41.xml"};
    static struct orl_bsdf_sample_request asks[DRAWS];
    static struct orl_bsdf_sample_result draws[DRAWS];
    static bool found[DRAWS];
    struct orl_bsdf *bsdfs[2];
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (int k = 0; k < 2; k++) {
        size_t size;
        unsigned char *xml = scene_read_bytes(files[k], &size);
        assert_int_equal(orl_bsdf_load_xml(files[k], (char *)xml, size, &bsdfs[k], NULL), 0);
        free(xml);
    }
    for (size_t i = 0; i < DRAWS; i++) {
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        const double side = orl_random_uniform(&random) < 0.5 ? 1 : -1;
        asks[i].bsdf = bsdfs[i % 3 == 0];
        asks[i].given = orl_hemisphere_about(orl_v3(0, 0, side), u, v);
        asks[i].adjoint = i % 5 == 0;
        asks[i].sides = (enum orl_bsdf_side)(i % 4);
        for (int k = 0; k < 3; k++)
            asks[i].u[k] = orl_random_uniform(&random);
    }
    orl_bsdf_sample_many(asks, DRAWS, draws, found);
    for (size_t i = 0; i < DRAWS; i++) {
        const struct orl_bsdf_sample_request *a = &asks[i];
        struct orl_vec3 direction;
        struct orl_rgb weight;
        double pdf;
        const bool any = (a->adjoint ? orl_bsdf_sample_adjoint : orl_bsdf_sample)(
            a->bsdf, a->given, a->sides, a->u, &direction, &weight, &pdf);
        assert_int_equal(any, found[i]);
        if (!any)
            continue;
        assert_memory_equal(&direction, &draws[i].direction, sizeof direction);
        assert_memory_equal(&weight, &draws[i].weight, sizeof weight);
        assert_true(pdf == draws[i].pdf && !draws[i].straight);
    }
    orl_bsdf_unref(bsdfs[0]);
    orl_bsdf_unref(bsdfs[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_waves),
                                       cmocka_unit_test(test_none_is_emitted),
                                       cmocka_unit_test(test_rays), cmocka_unit_test(test_draws)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
