/*
 * Encoding of photons in a map: a map extended in steps is the same file as one made at once, for
 * any effect of new photons on the cell size and the flux range.
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
#include "photon/map/quantization.h"
#include "photon/map/write_map.h"
#include "support/cli.h"
#include "support/scene_text.h"

enum { COUNT = 6000 };

struct fixture {
    char folder[64];
    struct orl_thread_pool *pool;
    struct orl_photon photons[COUNT];
};

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    cli_make_folder(f->folder);
    f->pool = orl_thread_pool_start(2);
    assert_non_null(f->pool);
    *state = f;
    return sodium_init() < 0 ? -1 : 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    cli_remove_folder(f->folder);
    orl_thread_pool_stop(f->pool);
    free(f);
    return 0;
}

/* Makes photons in a box about the origin, with fluxes over five decades and some duplicates. */
static void make_photons(struct fixture *f, double size, double brightness)
{
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, 1);
    for (size_t i = 0; i < COUNT; i++) {
        struct orl_photon *p = &f->photons[i];
        const double flux = brightness * pow(10, -5 * orl_random_uniform(&random));
        *p = (struct orl_photon){.normal = (uint16_t)(orl_random_bits(&random) >> 48),
                                 .batch = (uint8_t)(i % ORL_MAP_BATCHES),
                                 .tag = (uint8_t)(i % 3)};
        for (int k = 0; k < 3; k++) {
            p->position[k] = (float)(size * (orl_random_uniform(&random) - 0.5));
            p->flux[k] = (float)(flux * orl_random_uniform(&random));
        }
        if (i % 5 == 4)
            memcpy(p->position, f->photons[i / 2].position, sizeof p->position);
        if (i % 15 == 14)
            *p = f->photons[i / 2];
    }
}

static void write_map(struct fixture *f, const char *name, size_t first, size_t end,
                      const char *earlier_name, uint32_t threads)
{
    char path[128], earlier[128];
    struct orl_error err = {0};
    struct orl_thread_pool *pool = orl_thread_pool_start(threads);
    struct orl_photon_map *map = NULL;
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    snprintf(earlier, sizeof earlier, "%s/%s", f->folder, earlier_name ? earlier_name : "");
    if (earlier_name)
        assert_int_equal(orl_photon_map_open(earlier, true, &map, &err), 0);
    const struct orl_map_build build = {.kind = "global",
                                        .family = "aa",
                                        .target = end,
                                        .emitted = end,
                                        .seed = 3,
                                        .extent = 37.3,
                                        .earlier = map};
    assert_int_equal(
        orl_photon_map_write(path, f->photons + first, end - first, &build, pool, &err), 0);
    orl_photon_map_free(map);
    orl_thread_pool_stop(pool);
}

static void assert_same_files(const struct fixture *f, const char *a, const char *b)
{
    const char *const names[2] = {a, b};
    unsigned char *bytes[2];
    size_t size[2];
    for (int i = 0; i < 2; i++) {
        char path[128];
        snprintf(path, sizeof path, "%s/%s", f->folder, names[i]);
        bytes[i] = scene_read_bytes(path, &size[i]);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
}

/* Compares one step with every split into two, and with three. */
static void check_all(struct fixture *f)
{
    static const size_t cuts[] = {1, 17, 1000, 3000, COUNT - 1, COUNT};
    write_map(f, "whole", 0, COUNT, NULL, 1);
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        write_map(f, "part", 0, cuts[i], NULL, 2);
        write_map(f, "topped", cuts[i], COUNT, "part", 3);
        assert_same_files(f, "whole", "topped");
    }
    write_map(f, "part", 0, 100, NULL, 1);
    write_map(f, "more", 100, 2500, "part", 1);
    write_map(f, "topped", 2500, COUNT, "more", 2);
    assert_same_files(f, "whole", "topped");
}

static void test_even(void **state)
{
    struct fixture *f = *state;
    make_photons(f, 10, 1);
    check_all(f);
}

/* Later photons are ever further out: cells grow, and move. */
static void test_growing_places(void **state)
{
    struct fixture *f = *state;
    make_photons(f, 10, 1);
    for (size_t i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++)
            f->photons[i].position[k] *= (float)exp2(20.0 * ((double)i / COUNT - 1));
    check_all(f);
    for (size_t i = 0; i < COUNT; i++)
        f->photons[i].position[0] += 37.3F * (i < 4000);
    check_all(f);
}

/* Later photons are ever brighter, until the first ones are too faint to be stored. */
static void test_growing_fluxes(void **state)
{
    struct fixture *f = *state;
    make_photons(f, 10, 1);
    for (size_t i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++)
            f->photons[i].flux[k] *= (float)exp2(50.0 * ((double)i / COUNT - 0.5));
    check_all(f);
    for (size_t i = 0; i < 2000; i++) /* the first photons are black */
        memset(f->photons[i].flux, 0, sizeof f->photons[i].flux);
    check_all(f);
}

/* All photons in one place, and in one of two. */
static void test_one_place(void **state)
{
    struct fixture *f = *state;
    make_photons(f, 0, 1);
    check_all(f);
    for (size_t i = 0; i < COUNT; i++)
        f->photons[i].position[1] = i % 7 == 3 ? -20.0F : 1e-30F;
    check_all(f);
}

static void check_cells(const struct fixture *f, double size, double extent)
{
    struct orl_map_encoder p;
    assert_int_equal(orl_map_encode_init(&p, NULL, f->photons, COUNT, 1, extent, f->pool), 0);
    const double least = (extent > 0 ? extent : 1) * 0x1p-32;
    assert_true(p.cell <= 2 * size / (ORL_POSITION_CELLS - 1) || p.cell == least);
    for (size_t i = 0; i < COUNT; i++) {
        uint32_t cell[3];
        orl_map_encode_cell(&p, i, cell);
        for (int k = 0; k < 3; k++) {
            const double off = (f->photons[i].position[k] - p.low[k]) / p.cell - cell[k];
            assert_true(cell[k] < ORL_POSITION_CELLS && off > -1e-6 && off < 1 + 1e-6);
        }
    }
}

/* Cells are at most twice as wide as the bounds require, unless they have the minimum size. */
static void test_cells_are_tight(void **state)
{
    static const double sizes[] = {1e-12, 1e-3, 0.9, 4, 10, 99}, extents[] = {50, 37.3, 1e4, 0};
    struct fixture *f = *state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        make_photons(f, sizes[i], 1);
        for (size_t k = 0; k < sizeof extents / sizeof *extents; k++)
            check_cells(f, sizes[i], extents[k]);
    }
}

/* Cells scale with the scene: photons have the same neighbours in any unit. */
static void test_cells_scale(void **state)
{
    struct fixture *f = *state;
    struct orl_map_encoder here, there;
    make_photons(f, 10, 1);
    assert_int_equal(orl_map_encode_init(&here, NULL, f->photons, COUNT, 1, 8, f->pool), 0);
    for (int units = 0; units < 2; units++) {
        const float scale = units ? 2048 : 0.125F;
        struct orl_photon *scaled = malloc(sizeof f->photons);
        assert_non_null(scaled);
        memcpy(scaled, f->photons, sizeof f->photons);
        for (size_t i = 0; i < COUNT; i++)
            for (int k = 0; k < 3; k++)
                scaled[i].position[k] *= scale;
        assert_int_equal(
            orl_map_encode_init(&there, NULL, scaled, COUNT, 1, 8 * (double)scale, f->pool), 0);
        for (size_t i = 0; i < COUNT; i++) {
            uint32_t a[3], b[3];
            orl_map_encode_cell(&here, i, a);
            orl_map_encode_cell(&there, i, b);
            assert_memory_equal(a, b, sizeof a);
        }
        free(scaled);
    }
}

/* Flux codes, made coarser at once or by steps, are accurate to one part in 256; the brightest
 * flux fits. */
static void test_flux_codes(void **state)
{
    struct orl_random random = orl_random_stream(8, ORL_PURPOSE_BENCH, 2);
    (void)state;
    for (int i = 0; i < 100000; i++) {
        const double scale = exp2(100 * orl_random_uniform(&random) - 50);
        const struct orl_rgb value = {scale * orl_random_uniform(&random),
                                      scale * orl_random_uniform(&random),
                                      scale * orl_random_uniform(&random)};
        const double dither = orl_random_uniform(&random), most = orl_rgb_max(value);
        const int least = orl_flux_least(most);
        const uint32_t code = orl_flux_pack_from(value, least, dither);
        const struct orl_rgb back = orl_rgb_scale(orl_flux_unpack(code), orl_flux_unit(least));
        assert_int_equal(code >> 27, 31);
        assert_true(fabs(back.r - value.r) <= most / 256);
        for (int by = 0; by < 45; by += 3) {
            const uint32_t coarse = orl_flux_pack_from(value, least + by, dither);
            assert_int_equal(orl_flux_coarsen(code, by), coarse);
            assert_int_equal(orl_flux_coarsen(coarse, 7),
                             orl_flux_pack_from(value, least + by + 7, dither));
            assert_true(by < 40 || coarse == 0);
        }
    }
    assert_int_equal(orl_flux_pack_from((struct orl_rgb){0, 0, 0}, ORL_FLUX_LEAST, 0.9), 0);
    assert_int_equal(orl_flux_least(0), ORL_FLUX_LEAST);
}

/* Encoding in vectors equals encoding one by one: for black photons, five decades of flux, and
 * equal fluxes. */
static void test_many(void **state)
{
    static const double sizes[] = {4, 1e-3, 3e4}, lights[] = {1e3, 1e-30, 0};
    struct fixture *f = *state;
    for (size_t k = 0; k < 3; k++) {
        struct orl_map_encoder encoder;
        make_photons(f, sizes[k], lights[k]);
        for (size_t i = 3; i < COUNT; i += 7)
            memset(f->photons[i].flux, 0, sizeof f->photons[i].flux);
        f->photons[1].flux[2] = 1e-44F;
        assert_int_equal(
            orl_map_encode_init(&encoder, NULL, f->photons, COUNT, 5, k == 2 ? 0 : 3, f->pool), 0);
        assert_true(orl_map_encode_is_near(&encoder));
        for (size_t i = 0; i + ORL_ENCODED_AT_ONCE <= COUNT; i += ORL_ENCODED_AT_ONCE) {
            struct orl_photon_words many[ORL_ENCODED_AT_ONCE];
            orl_map_encode_words_many(&encoder, i, many);
            for (size_t j = 0; j < ORL_ENCODED_AT_ONCE; j++) {
                const struct orl_photon_words one = orl_map_encode_words(&encoder, i + j);
                assert_memory_equal(&one, &many[j], sizeof one);
            }
        }
    }
}

#define EACH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(test_even),
        EACH(test_growing_places),
        EACH(test_growing_fluxes),
        EACH(test_one_place),
        EACH(test_cells_are_tight),
        EACH(test_cells_scale),
        cmocka_unit_test(test_flux_codes),
        EACH(test_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
