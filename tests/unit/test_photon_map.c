/*
 * The photon map file: photons are read as written, the bytes depend on the photons only, and
 * damaged files are refused.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/io/checked_file.h"
#include "base/sampling/sampling.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"
#include "support/scene_text.h"
#include "support/scratch.h"

static int set_up(void **state)
{
    return scratch_set_up(state) != 0 || sodium_init() < 0 ? -1 : 0;
}

static struct orl_vec3 random_normal(struct orl_random *random)
{
    const double z = 2 * orl_random_uniform(random) - 1, s = sqrt(1 - z * z);
    const double phi = 2 * ORL_PI * orl_random_uniform(random);
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/*
 * Makes photons in a box of 8 x 5 x 3 m with random normals. Each has its own flux, increasing
 * with its index, so that a photon read back is identified by the rank of its red flux.
 */
static struct orl_photon *make_photons(size_t count, uint64_t seed)
{
    struct orl_photon *photons = malloc((count + 1) * sizeof *photons);
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, count);
    assert_non_null(photons);
    for (size_t i = 0; i < count; i++) {
        photons[i] = (struct orl_photon){
            .position = {(float)(8 * orl_random_uniform(&random)),
                         (float)(5 * orl_random_uniform(&random) - 2.5),
                         (float)(3 * orl_random_uniform(&random))},
            .flux = {(float)(1 + orl_random_uniform(&random)),
                     (float)(0.5 + orl_random_uniform(&random)), 0.25F + (float)(i % 7)},
            .normal = orl_normal_encode(random_normal(&random)),
            .batch = (uint8_t)(i % ORL_MAP_BATCHES)};
    }
    return photons;
}

static void build_map(const char *path, struct orl_photon *photons, size_t count,
                      const struct orl_map_build *build, uint32_t threads)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(threads);
    struct orl_error err;
    assert_int_equal(orl_photon_map_write(path, photons, count, build, pool, &err), 0);
    orl_thread_pool_stop(pool);
}

static void write_map(const char *path, struct orl_photon *photons, size_t count, uint64_t emitted,
                      uint64_t seed, uint32_t threads)
{
    const struct orl_map_build build = {.kind = "global", .emitted = emitted, .seed = seed};
    build_map(path, photons, count, &build, threads);
}

static struct orl_photon_map *open_map(const char *path)
{
    struct orl_photon_map *map = NULL;
    struct orl_error err;
    assert_int_equal(orl_photon_map_open(path, true, &map, &err), 0);
    return map;
}

/*
 * A photon's code leads to its leaf. If several leaves begin with the code, it leads to the last
 * of them. Codes before the first photon's lead to the first leaf, and those after the last to the
 * last. The counts are not multiples of a group of leaves.
 */
static void test_places_lead_to_leaves(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 15, 16, 17, 129, 5000, 20011};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        struct orl_photon *photons = make_photons(counts[c], 9);
        struct orl_zorder order;
        write_map(scratch_path("order"), photons, counts[c], 100, 9, 1);
        struct orl_photon_map *map = open_map(scratch_path("order"));
        assert_int_equal(orl_zorder_init(&order, map), 0);
        for (size_t i = 0; i < counts[c]; i++) {
            const uint32_t *words = map->places + i / ORL_MAP_LEAF * ORL_LEAF_WORDS;
            uint32_t cell[3];
            orl_position_unpack(words[i % ORL_MAP_LEAF], words[i % ORL_MAP_LEAF + ORL_MAP_LEAF],
                                cell);
            const uint64_t code = orl_zorder_code(cell, map->normals[i]);
            const uint64_t leaf = orl_zorder_find(&order, code);
            assert_true(leaf == i / ORL_MAP_LEAF ||
                        (leaf > i / ORL_MAP_LEAF && order.codes[0][leaf] == code));
        }
        assert_int_equal(orl_zorder_find(&order, 0), 0);
        assert_int_equal(orl_zorder_find(&order, UINT64_MAX - 1), (counts[c] - 1) / ORL_MAP_LEAF);
        orl_zorder_done(&order);
        orl_photon_map_free(map);
        free(photons);
    }
}

/* ---- Round trip -------------------------------------------------------------------------------
 */

/* Returns the photon of the map nearest to a place. */
static size_t find_photon(const struct orl_photon_map *map, const float position[3])
{
    size_t best = 0;
    double best2 = INFINITY;
    for (size_t i = 0; i < orl_photon_map_header(map)->count; i++) {
        const struct orl_photon p = orl_photon_map_get(map, i);
        double d2 = 0;
        for (int k = 0; k < 3; k++)
            d2 += (p.position[k] - position[k]) * (p.position[k] - position[k]);
        if (d2 < best2) {
            best2 = d2;
            best = i;
        }
    }
    return best;
}

/*
 * Places are restored within half a cell per coordinate (and the rounding of floats near 8 m). A
 * flux rounds by at most one step of its mantissa. The largest channel has 256 steps or more, so
 * the step is at most 1/256 of it, and half that if rounded to nearest; dither makes it a whole
 * step.
 */
static void test_round_trip(void **state)
{
    enum { COUNT = 500 };
    const uint64_t emitted = 1234;
    struct orl_photon *photons = make_photons(COUNT, 1);
    (void)state;
    write_map(scratch_path("map"), photons, COUNT, emitted, 9, 1);
    struct orl_photon_map *map = open_map(scratch_path("map"));
    const struct orl_map_header *h = orl_photon_map_header(map);
    assert_int_equal(h->count, COUNT);
    assert_int_equal(h->emitted, emitted);
    assert_string_equal(h->kind, "global");
    assert_true(h->cell <= 8.0 / (1 << 20) * 1.01);
    for (size_t i = 0; i < COUNT; i++) {
        const struct orl_photon *was = &photons[i];
        const struct orl_photon is = orl_photon_map_get(map, find_photon(map, was->position));
        const double most = fmax(was->flux[0], fmax(was->flux[1], was->flux[2])) / (double)emitted;
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(is.position[k] - was->position[k]) <= 0.5 * h->cell + 2e-6);
            assert_true(fabs(is.flux[k] - was->flux[k] / (double)emitted) <= most / 256 * 1.01);
        }
        assert_int_equal(is.normal, was->normal);
        assert_int_equal(is.batch, was->batch);
    }
    orl_photon_map_free(map);
    free(photons);
}

/*
 * Dither keeps sums: rounding errors of N photons are independent, each uniform within a step
 * about its mean 0. The standard error of the sum is at most sqrt(N) step / 2.
 */
static void check_sums(struct orl_photon *photons, size_t count)
{
    double was[3] = {0}, is[3] = {0}, variance = 0;
    write_map(scratch_path("map"), photons, count, 1, 77, 2);
    struct orl_photon_map *map = open_map(scratch_path("map"));
    for (size_t i = 0; i < count; i++) {
        const struct orl_photon p = orl_photon_map_get(map, i);
        const double most = fmax(photons[i].flux[0], fmax(photons[i].flux[1], photons[i].flux[2]));
        variance += most * most / (256.0 * 256.0) / 4;
        for (int k = 0; k < 3; k++) {
            was[k] += photons[i].flux[k];
            is[k] += p.flux[k];
        }
    }
    for (int k = 0; k < 3; k++)
        assert_true(fabs(is[k] - was[k]) < 4 * sqrt(variance));
    orl_photon_map_free(map);
}

static void test_sums_are_kept(void **state)
{
    enum { COUNT = 100000 };
    struct orl_photon *photons = make_photons(COUNT, 2);
    (void)state;
    check_sums(photons, COUNT);
    /* Saturated colours: a channel of zero stays exactly zero, faint ones keep their mean. */
    for (size_t i = 0; i < COUNT; i++) {
        photons[i].flux[1] = 0;
        photons[i].flux[2] = photons[i].flux[0] * 1e-3F;
    }
    check_sums(photons, COUNT);
    struct orl_photon_map *map = open_map(scratch_path("map"));
    for (size_t i = 0; i < COUNT; i++)
        assert_true(orl_photon_map_get(map, i).flux[1] == 0);
    orl_photon_map_free(map);
    free(photons);
}

/* Fluxes over twelve decades: the brightest carry the sum, and nothing overflows. */
static void test_wild_fluxes_sum(void **state)
{
    enum { COUNT = 100000 };
    struct orl_photon *photons = make_photons(COUNT, 3);
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (size_t i = 0; i < COUNT; i++) {
        const float scale = (float)pow(10, 12 * orl_random_uniform(&random) - 9);
        for (int k = 0; k < 3; k++)
            photons[i].flux[k] *= scale;
    }
    check_sums(photons, COUNT);
    /* One photon that outshines the sum of all others by far is kept, not clamped. */
    photons[COUNT / 2].flux[0] = 3e10F;
    check_sums(photons, COUNT);
    free(photons);
}

/* A normal takes two bytes: axes are exact, all others within a degree. */
static void test_normals(void **state)
{
    const struct orl_vec3 axes[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                     {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (int i = 0; i < 6; i++) {
        const struct orl_vec3 d = orl_sub(orl_normal_decode(orl_normal_encode(axes[i])), axes[i]);
        assert_true(orl_length(d) == 0);
    }
    for (int i = 0; i < 100000; i++) {
        const struct orl_vec3 n = random_normal(&random);
        const struct orl_vec3 back = orl_normal_decode(orl_normal_encode(n));
        assert_true(orl_dot(n, back) > cos(1.0 * ORL_DEG_TO_RAD));
    }
}

/* ---- Bytes ------------------------------------------------------------------------------------
 */

static void test_same_bytes_for_any_pool_size(void **state)
{
    enum { COUNT = 200000, VARIANTS = 4 };
    static const uint32_t threads[VARIANTS] = {1, 2, 7, 1};
    unsigned char *bytes[VARIANTS];
    size_t size[VARIANTS];
    (void)state;
    for (int i = 0; i < VARIANTS; i++) {
        struct orl_photon *photons = make_photons(COUNT, 5);
        /* A build that consumes its photons gives the same map. */
        const struct orl_map_build build = {
            .kind = "global", .emitted = COUNT, .seed = 5, .free_photons = i % 2 == 1};
        build_map(scratch_path("map"), photons, COUNT, &build, threads[i]);
        bytes[i] = scene_read_bytes(scratch_path("map"), &size[i]);
        free(photons);
    }
    for (int i = 1; i < VARIANTS; i++) {
        assert_int_equal(size[i], size[0]);
        assert_memory_equal(bytes[i], bytes[0], size[0]);
    }
    assert_true((double)size[0] / COUNT <= 24);
    for (int i = 0; i < VARIANTS; i++)
        free(bytes[i]);
}

/* ---- Damage -----------------------------------------------------------------------------------
 */

struct image {
    unsigned char *bytes;
    size_t size;
};

static struct image make_image(size_t count)
{
    struct orl_photon *photons = make_photons(count, 6);
    struct image image;
    write_map(scratch_path("map"), photons, count, count + 1, 6, 1);
    image.bytes = scene_read_bytes(scratch_path("map"), &image.size);
    free(photons);
    return image;
}

static int open_bytes(const void *bytes, size_t size, bool verify)
{
    struct orl_photon_map *map = NULL;
    struct orl_error err = {0};
    FILE *file = fopen(scratch_path("damaged"), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
    const int code = orl_photon_map_open(scratch_path("damaged"), verify, &map, &err);
    if (code < 0) {
        assert_null(map);
        assert_int_equal(err.code, code);
        assert_true(err.message[0]);
    }
    orl_photon_map_free(map);
    return code;
}

/* Signs a header that was changed on purpose, as an attacker would. */
static void sign_header(unsigned char *bytes)
{
    struct orl_map_header *h = (void *)bytes;
    orl_checksum_of(bytes, offsetof(struct orl_map_header, header_checksum), h->header_checksum);
}

static void test_truncated(void **state)
{
    struct image image = make_image(300);
    (void)state;
    assert_int_equal(open_bytes(image.bytes, image.size, true), 0);
    for (size_t size = 0; size < image.size; size += size < 300 ? 1 : 97)
        assert_int_equal(open_bytes(image.bytes, size, false), ORL_ERR_CORRUPT);
    assert_int_equal(open_bytes(image.bytes, image.size - 1, false), ORL_ERR_CORRUPT);
    free(image.bytes);
}

static void test_flipped_bits(void **state)
{
    struct image image = make_image(300);
    (void)state;
    for (size_t at = 0; at < image.size; at += at < sizeof(struct orl_map_header) ? 1 : 61) {
        image.bytes[at] ^= 0x10;
        const int code = open_bytes(image.bytes, image.size, true);
        assert_true(code == ORL_ERR_CORRUPT || code == ORL_ERR_VERSION);
        image.bytes[at] ^= 0x10;
    }
    free(image.bytes);
}

static void test_wrong_headers(void **state)
{
    struct image image = make_image(300);
    struct orl_map_header *h = (void *)image.bytes;
    const struct orl_map_header good = *h;
    (void)state;
    h->magic[0] = 'X';
    sign_header(image.bytes);
    assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_CORRUPT);
    *h = good;
    h->version = ORL_MAP_VERSION + 1;
    sign_header(image.bytes);
    assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_VERSION);
    *h = good;
    h->byte_order = 0x04030201U;
    sign_header(image.bytes);
    assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_VERSION);
    *h = good;
    h->emitted = 0;
    sign_header(image.bytes);
    assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_CORRUPT);
    *h = good;
    h->cell = NAN;
    sign_header(image.bytes);
    assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_CORRUPT);
    free(image.bytes);
}

/*
 * Counts that need more than the file holds, including sizes that wrap around 64 bits. The whole
 * header agrees with the layout of that count, and is signed.
 */
static void test_huge_counts(void **state)
{
    static const uint64_t counts[] = {400,        (1ULL << 32) - 1, 1ULL << 32, 1ULL << 57,
                                      1ULL << 60, 1ULL << 61,       UINT64_MAX, UINT64_MAX - 15};
    struct image image = make_image(300);
    struct orl_map_header *h = (void *)image.bytes;
    (void)state;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const struct orl_map_layout l = orl_map_layout_of(counts[i]);
        h->count = counts[i];
        h->places = l.places;
        h->fluxes = l.fluxes;
        h->normals = l.normals;
        h->tags = l.tags;
        h->boxes = l.boxes;
        h->levels = l.levels;
        h->size = l.size;
        sign_header(image.bytes);
        assert_int_equal(open_bytes(image.bytes, image.size, false), ORL_ERR_CORRUPT);
    }
    free(image.bytes);
}

static void test_not_files(void **state)
{
    struct orl_photon_map *map = NULL;
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(open_bytes("", 0, false), ORL_ERR_CORRUPT);
    assert_int_equal(orl_photon_map_open(scratch_path("absent"), false, &map, &err), ORL_ERR_IO);
    assert_int_equal(orl_photon_map_open(scratch_path(""), false, &map, &err), ORL_ERR_CORRUPT);
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    assert_int_equal(
        orl_photon_map_write(scratch_path("no/such/folder"), NULL, 0, &build, pool, &err),
        ORL_ERR_IO);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places_lead_to_leaves),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_sums_are_kept),
        cmocka_unit_test(test_wild_fluxes_sum),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_same_bytes_for_any_pool_size),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_flipped_bits),
        cmocka_unit_test(test_wrong_headers),
        cmocka_unit_test(test_huge_counts),
        cmocka_unit_test(test_not_files),
    };
    return cmocka_run_group_tests(tests, set_up, scratch_tear_down);
}
