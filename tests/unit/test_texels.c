/*
 * Irradiance by texels: a surface of any outline holds exactly the light that lands on it; the
 * other side stays dark; coincident surfaces count once; results are equal for any number of
 * threads.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "photon/density/irradiance_tables.h"
#include "photon/map/quantization.h"
#include "support/cli.h"
#include "support/scene_text.h"

/* An L and a triangle that stands on it, both tilted; two squares back to back; a sphere. */
static const char scene[] =
    "void plastic w 0 0 5 .5 .5 .5 0 0\n"
    "w polygon l 0 0 18 0 0 0 3 0 1 3 1 1 1 1 .3333333333333333 1 2 .3333333333333333 0 2 0\n"
    "w polygon t 0 0 9 .5 .5 .1666666666666667 2.5 .5 .8333333333333333 1.5 .6 2\n"
    "w polygon a 0 0 12 0 0 -3 1 0 -3 1 1 -3 0 1 -3\n"
    "w polygon b 0 0 12 0 0 -3 0 1 -3 1 1 -3 1 0 -3\n"
    "w sphere s 0 0 4 5 0 0 1\n";
enum { FACETS = 4, A_FACET = 20000, PER_TEXEL = 48, POINTS = 100000 };

static char folder[64];

static int set_up(void **state)
{
    (void)state;
    cli_make_folder(folder);
    return sodium_init() < 0 ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    cli_remove_folder(folder);
    return 0;
}

/* Returns a map with equally many photons on the front of every polygon, of flux 1, 2 and 3. */
static struct orl_photon_map *shower(const struct orl_geometry *geometry,
                                     struct orl_thread_pool *pool)
{
    static struct orl_photon photons[FACETS * A_FACET];
    const struct orl_map_build build = {
        .kind = "global", .emitted = 1, .seed = 1, .extent = geometry->radius};
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_photon_map *map = NULL;
    struct orl_error err;
    char path[128];
    for (uint32_t i = 0; i < FACETS * A_FACET; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(geometry, i % FACETS, u, &point, &normal);
        photons[i] =
            (struct orl_photon){.position = {(float)point.x, (float)point.y, (float)point.z},
                                .flux = {1, 2, 3},
                                .batch = (uint8_t)(i / FACETS % ORL_MAP_BATCHES),
                                .normal = orl_normal_encode(normal)};
    }
    snprintf(path, sizeof path, "%s/map", folder);
    assert_int_equal(orl_photon_map_write(path, photons, FACETS * A_FACET, &build, pool, &err), 0);
    assert_int_equal(orl_photon_map_open(path, false, &map, &err), 0);
    return map;
}

static const struct orl_texel *texel_at(const struct orl_texels *texels, uint32_t facet, bool front,
                                        struct orl_vec3 point)
{
    bool cut;
    return orl_texels_at(texels, facet, front, point, &cut);
}

/*
 * A mean over points of the surface, times its area, is the flux. Texels of 48 photons scatter by
 * 15 %, those cut by the outline by at most twice as much: a mean of 1e5 points has an error of
 * 0.1 % (one sigma); the tolerance is four of these. Fluxes in a map are rounded, without bias, by
 * 0.1 %.
 */
static void expect_all_light(const struct orl_geometry *geometry, const struct orl_texels *texels,
                             uint32_t facet)
{
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, facet);
    double sums[3] = {0}, most_off = 0;
    for (int i = 0; i < POINTS; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        double parts = 0;
        orl_facet_sample(geometry, facet, u, &point, &normal);
        const struct orl_texel *texel = texel_at(texels, facet, true, point);
        assert_non_null(texel);
        for (int c = 0; c < 3; c++)
            sums[c] += (double)texel->irradiance[c] / POINTS;
        for (int b = 0; b < ORL_MAP_BATCHES; b++)
            parts += texel->parts[b];
        most_off = fmax(most_off, fabs(parts - (texel->irradiance[0] > 0 ? UINT8_MAX : 0)));
        assert_null(texel_at(texels, facet, false, point));
    }
    assert_true(most_off < 1e-4); /* shares sum to one */
    for (int c = 0; c < 3; c++) {
        const double share = sums[c] * geometry->facets[facet].area / ((c + 1.0) * A_FACET);
        print_message("facet %u: %.4f of the flux\n", facet, share);
        assert_true(fabs(share - 1) < 0.004);
    }
}

/* Rays hit that one of two coincident, opposite squares whose front they see, and read its light.
 */
static void expect_light_in_front(const struct orl_geometry *geometry,
                                  const struct orl_texels *texels, uint32_t facet)
{
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, facet);
    double sum = 0;
    for (int i = 0; i < POINTS; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        struct orl_hit hit;
        orl_facet_sample(geometry, facet, u, &point, &normal);
        assert_true(orl_geometry_intersect(geometry, orl_madd(point, normal, 0.5), orl_neg(normal),
                                           1, &hit));
        assert_int_equal(hit.facet, facet);
        assert_true(hit.front);
        sum += (double)texel_at(texels, hit.facet, hit.front, hit.point)->irradiance[0];
    }
    const double share = sum / POINTS * geometry->facets[facet].area / A_FACET;
    assert_true(fabs(share - 1) < 0.004);
}

static void test_texels(void **state)
{
    struct orl_lit_scene *lit_scene = build_lit_scene(scene, NULL, NULL, NULL);
    const struct orl_geometry *geometry = lit_scene->geometry;
    struct orl_thread_pool *pool = orl_thread_pool_start(1), *three = orl_thread_pool_start(3);
    struct orl_photon_map *map = shower(geometry, pool);
    struct orl_texels *texels = orl_texels_new(map, lit_scene, PER_TEXEL, pool);
    struct orl_texels *again = orl_texels_new(map, lit_scene, PER_TEXEL, three);
    (void)state;
    assert_non_null(texels);
    assert_non_null(again);
    for (uint32_t facet = 0; facet < 2; facet++) {
        assert_true(orl_texels_has(texels, facet));
        expect_all_light(geometry, texels, facet);
        struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, facet);
        for (int i = 0; i < 1000; i++) {
            const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
            struct orl_vec3 point, normal;
            orl_facet_sample(geometry, facet, u, &point, &normal);
            assert_memory_equal(texel_at(texels, facet, true, point),
                                texel_at(again, facet, true, point), sizeof(struct orl_texel));
        }
    }
    expect_light_in_front(geometry, texels, 2);
    expect_light_in_front(geometry, texels, 3);
    assert_false(orl_texels_has(texels, FACETS)); /* the sphere */
    orl_texels_free(texels);
    orl_texels_free(again);
    orl_photon_map_free(map);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
    orl_thread_pool_stop(three);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_texels)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
