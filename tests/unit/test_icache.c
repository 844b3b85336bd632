/* Irradiance cache records: validity, gradients, neighbour clamping, and its cost if all records
 * are in one place. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>

#include "render/gather/icache.h"
#include "render/gather/icache_iterator.h"
#include "support/scene_text.h"

/* Returns a place on the plane z = 0, facing up. */
static struct orl_shading_point place_at(double x, double y)
{
    return (struct orl_shading_point){.point = orl_v3(x, y, 0), .normal = orl_v3(0, 0, 1)};
}

static struct orl_irradiance_record record_at(double x, double y, double radius, double value)
{
    return (struct orl_irradiance_record){
        .place = place_at(x, y), .irradiance = orl_gray(value), .radius = radius, .least = 0.01};
}

static void fill_cache(struct orl_icache *cache, const struct orl_irradiance_record *records,
                       size_t count)
{
    orl_icache_init(cache, 3);
    assert_int_equal(orl_icache_add(cache, records, count), 0);
    assert_int_equal(orl_icache_index(cache), 0);
}

/*
 * A record is valid up to a quarter of its radius and is read half as far again. Alone, it gives
 * its value and gradient.
 */
static void test_reach_and_gradient(void **state)
{
    struct orl_irradiance_record record = record_at(0, 0, 4, 10);
    struct orl_icache cache;
    struct orl_cached_irradiance found;
    (void)state;
    for (int c = 0; c < 3; c++)
        record.translation_gradient[c] = orl_v3(2, 0, 0);
    fill_cache(&cache, &record, 1);
    const struct orl_shading_point near = place_at(0.5, 0.5), beyond = place_at(1.01, 0);
    const struct orl_shading_point far = place_at(1.51, 0);
    assert_true(orl_icache_covers(&cache, &near));
    assert_true(orl_icache_lookup(&cache, &near, &found));
    const struct orl_rgb e = found.irradiance;
    assert_true(fabs(e.r - 11) < 1e-12 && e.r == e.g && e.g == e.b);
    assert_false(orl_icache_covers(&cache, &beyond));
    assert_true(orl_icache_lookup(&cache, &beyond, &found));
    assert_true(fabs(found.irradiance.r - 12.02) < 1e-12);
    assert_false(orl_icache_lookup(&cache, &far, &found));
    struct orl_shading_point below = place_at(0, 0);
    below.normal = orl_v3(0, 0, -1);
    assert_false(orl_icache_lookup(&cache, &below, &found));
    orl_icache_done(&cache);
}

/*
 * Records share their photons: the photon errors are averaged by the same weights as values. Ray
 * errors are independent: two records of equal weight have 1/sqrt(2) of one's. The scatter of
 * records of 10 and 20 beyond their rays' noise is the interpolation error.
 */
static void test_errors(void **state)
{
    struct orl_irradiance_record records[2] = {record_at(0, 0, 4, 10), record_at(0.6, 0, 4, 20)};
    struct orl_icache cache;
    struct orl_cached_irradiance found;
    (void)state;
    records[0].photon_error = 1;
    records[1].photon_error = 3;
    fill_cache(&cache, records, 2);
    const struct orl_shading_point between = place_at(0.2, 0);
    assert_true(orl_icache_lookup(&cache, &between, &found));
    assert_true(found.irradiance.r > 10 && found.irradiance.r < 15);
    const double p = (found.irradiance.r - 10) / 10, by_photons = 1 + 2 * p;
    assert_true(fabs(found.standard_error - sqrt(by_photons * by_photons + 100 * p * (1 - p))) <
                1e-9);
    for (int i = 0; i < 2; i++)
        cache.records[i].ray_error = 4;
    const struct orl_shading_point middle = place_at(0.3, 0);
    assert_true(orl_icache_lookup(&cache, &middle, &found));
    assert_true(fabs(found.standard_error - sqrt(4 + 8 + (25 - 16))) < 1e-9);
    orl_icache_done(&cache);
}

/* Clamping: no radius exceeds a neighbour's within reach plus the distance to it. A record of
 * minimum radius stays valid. */
static void test_hold_back(void **state)
{
    const struct orl_irradiance_record records[4] = {
        record_at(0, 0, 4, 1),     /* reaches 1: the next record is within */
        record_at(0.5, 0, 0.2, 1), /* something is near here */
        record_at(3, 0, 4, 1),     /* reaches neither */
        record_at(0, 0.9, 0.001, 1),
    };
    struct orl_icache cache;
    (void)state;
    fill_cache(&cache, records, 4);
    assert_int_equal(orl_icache_clamp_neighbours(&cache, NULL), 0);
    assert_true(fabs(cache.records[0].radius - 0.7) < 1e-12);
    assert_true(fabs(cache.records[1].radius - 0.2) < 1e-12);
    assert_true(fabs(cache.records[2].radius - 4) < 1e-12);
    assert_true(fabs(cache.records[3].radius - 0.001) < 1e-12);
    const struct orl_shading_point close = place_at(0, 0.902), far = place_at(0, 0.903);
    assert_true(orl_icache_covers(&cache, &close));
    assert_false(orl_icache_covers(&cache, &far));
    /* Outside its clamped radius the record is no longer valid. */
    const struct orl_shading_point was_served = place_at(0, 0.8);
    struct orl_cached_irradiance found;
    assert_false(orl_icache_covers(&cache, &was_served));
    assert_false(orl_icache_lookup(&cache, &was_served, &found));
    orl_icache_done(&cache);
}

/* The order of the records does not change any radius. */
static void test_order(void **state)
{
    enum { COUNT = 200 };
    struct orl_irradiance_record records[COUNT], reversed[COUNT];
    struct orl_icache one, other;
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        const double x = orl_random_uniform(&random), y = orl_random_uniform(&random);
        records[i] = record_at(x, y, 0.05 + orl_random_uniform(&random), x + y);
        reversed[COUNT - 1 - i] = records[i];
    }
    fill_cache(&one, records, COUNT);
    fill_cache(&other, reversed, COUNT);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(orl_icache_clamp_neighbours(&one, NULL), 0);
        assert_int_equal(orl_icache_clamp_neighbours(&other, NULL), 0);
    }
    int held = 0;
    for (int i = 0; i < COUNT; i++) {
        assert_true(one.records[i].radius == other.records[COUNT - 1 - i].radius);
        held += one.records[i].radius < records[i].radius;
    }
    assert_true(held > COUNT / 4);
    orl_icache_done(&one);
    orl_icache_done(&other);
}

/* ---- Many records in one place --------------------------------------------------------------- */

enum { MANY = 100000 };

/* Returns records in a cube of that side, with radii between two bounds. */
static struct orl_irradiance_record *crowd(double side, double least, double most)
{
    struct orl_irradiance_record *records = malloc(MANY * sizeof *records);
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 0);
    assert_non_null(records);
    for (int i = 0; i < MANY; i++) {
        const double x = side * orl_random_uniform(&random), y = side * orl_random_uniform(&random);
        records[i] = record_at(x, y, 0, 1);
        records[i].radius = least + (most - least) * orl_random_uniform(&random);
        records[i].least = 0;
    }
    return records;
}

static size_t visits_about(const struct orl_icache *cache, const struct orl_shading_point *place)
{
    struct orl_icache_iterator v = orl_icache_iterator_begin(cache, place);
    size_t visits = 0;
    while (orl_icache_iterator_next(&v) != ORL_ICACHE_END)
        visits++;
    return visits;
}

/* Returns the number of records that neighbour clamping visits, per record of the first COUNT. */
static double count_visits(struct orl_irradiance_record *records, size_t count)
{
    struct orl_icache cache;
    fill_cache(&cache, records, count);
    assert_int_equal(orl_icache_clamp_neighbours(&cache, NULL), 0);
    const double looks = (double)cache.n_visited / (double)count;
    if (count == MANY)
        memcpy(records, cache.records, count * sizeof *records);
    orl_icache_done(&cache);
    return looks;
}

/*
 * For four times as many records n log n allows each log 100000 / log 25000 = 1.14 times as many
 * visits; every pair would be 4 times as many.
 */
static const double most_growth = 1.5;

/* Records of radius 0, as for a viewpoint in the plane of a wall: they are valid nowhere. */
static void test_radius_zero(void **state)
{
    struct orl_irradiance_record *records = crowd(0, 0, 0);
    struct orl_icache cache;
    (void)state;
    fill_cache(&cache, records, MANY);
    assert_int_equal(visits_about(&cache, &records[0].place), 0);
    assert_false(orl_icache_covers(&cache, &records[0].place));
    assert_false(orl_icache_has_record_for(&cache, &records[0].place));
    orl_icache_done(&cache);
    assert_true(count_visits(records, MANY) == 1); /* only the root of the tree is visited */
    free(records);
}

/* All records within reach of each other: equal radii, which clamp none, and mixed ones. */
static void test_crowds(void **state)
{
    static const double radii[][2] = {{0.01, 0.01}, {0.01, 0.02}, {0.01, 100}};
    (void)state;
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        struct orl_irradiance_record *records = crowd(1e-3, radii[i][0], radii[i][1]);
        const double fewer = count_visits(records, MANY / 4), looks = count_visits(records, MANY);
        print_message("# radii of %g to %g: %.1f looks a record, of a quarter of them %.1f\n",
                      radii[i][0], radii[i][1], looks, fewer);
        assert_true(looks <= most_growth * fewer && looks < 0.01 * MANY);
        for (int k = 0; k < MANY; k++)
            assert_true(records[k].radius >= radii[i][0] && records[k].radius < 0.02);
        free(records);
    }
}

/* Clamping against a search over every pair, for records all over a room with normals of three
 * walls. */
static void test_against_pairs(void **state)
{
    enum { COUNT = 600 };
    struct orl_irradiance_record records[COUNT];
    struct orl_icache cache;
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 0);
    int held = 0;
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        const struct orl_vec3 points[3] = {{u, v, 0}, {u, 0, v}, {0, u, v}};
        const struct orl_vec3 normals[3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
        const double radius = orl_random_uniform(&random);
        records[i] = record_at(0, 0, 2 * radius * radius, 1);
        records[i].place.point = points[i % 3];
        records[i].place.normal = normals[i % 3];
    }
    fill_cache(&cache, records, COUNT);
    assert_int_equal(orl_icache_clamp_neighbours(&cache, NULL), 0);
    for (int i = 0; i < COUNT; i++) {
        double radius = records[i].radius;
        for (int k = 0; k < COUNT; k++)
            if (k != i && orl_irradiance_record_covers(&records[i], &records[k].place))
                radius =
                    fmin(radius,
                         orl_irradiance_record_radius(&records[k]) +
                             orl_length(orl_sub(records[i].place.point, records[k].place.point)));
        assert_true(cache.records[i].radius == radius);
        held += radius < records[i].radius;
    }
    assert_true(held > COUNT / 4);
    orl_icache_done(&cache);
}

/* Far from the origin and with tiny radii: cell numbers do not overflow. */
static void test_tiny_and_far(void **state)
{
    struct orl_irradiance_record records[2] = {record_at(1e12, -1e12, 1e-300, 1),
                                               record_at(3, 4, 1e-9, 1)};
    struct orl_icache cache;
    (void)state;
    for (int i = 0; i < 2; i++)
        records[i].least = 0;
    fill_cache(&cache, records, 2);
    for (int i = 0; i < 2; i++)
        assert_true(orl_icache_covers(&cache, &records[i].place));
    assert_int_equal(orl_icache_clamp_neighbours(&cache, NULL), 0);
    orl_icache_done(&cache);
}

/* Thinning of planned records: of those in one place one remains, of those a pixel apart all do. */
static void test_thinning(void **state)
{
    const struct orl_pixel_footprint footprint = {.angle = 1e-3};
    const double pixel = 2 * footprint.angle, least = orl_pixel_footprint_radius(&footprint, 2);
    struct orl_irradiance_record *records = crowd(0.01 * pixel, 0, 0);
    size_t count = MANY;
    (void)state;
    for (size_t i = 0; i < MANY; i++)
        records[i].least = least;
    records[MANY / 2].place.normal = orl_v3(0, 0, -1);
    assert_int_equal(orl_irradiance_records_thin(records, &count), 0);
    assert_in_range(count, 2, 8 + 1); /* the places lie at corners of cells */
    count = 100 * 100;
    for (size_t i = 0; i < count; i++) {
        records[i] = record_at((double)(i % 100) * pixel, (double)i / 100 * pixel, 1, (double)i);
        records[i].least = least;
    }
    assert_int_equal(orl_irradiance_records_thin(records, &count), 0);
    assert_int_equal(count, 100 * 100);
    for (size_t i = 0; i < count; i++)
        assert_true(records[i].irradiance.r == (double)i);
    free(records);
}

/* A viewpoint on a surface: distances below the geometry's resolution still give a positive
 * radius. */
static void test_least_radius(void **state)
{
    const struct orl_pixel_footprint eye = {.angle = 1e-3, .nearest = 1e-4};
    const struct orl_pixel_footprint clipped = {.angle = 1e-3, .start = 2, .nearest = 1e-4};
    const struct orl_pixel_footprint usual = {.angle = 1e-3};
    (void)state;
    assert_true(orl_pixel_footprint_radius(&eye, 0) == orl_pixel_footprint_radius(&usual, 1e-4));
    assert_true(orl_pixel_footprint_radius(&eye, 3) == orl_pixel_footprint_radius(&usual, 3));
    assert_true(orl_pixel_footprint_radius(&clipped, 0) == orl_pixel_footprint_radius(&usual, 2));
    assert_true(orl_pixel_footprint_radius(&clipped, 1) == orl_pixel_footprint_radius(&usual, 3));
}

/* ---- Obstacles between a record and a place -------------------------------------------------- */

/* A hit that a record has seen nearby limits its reach: an upright board at x = 0 between it and a
 * place. */
static void test_board_between(void **state)
{
    struct orl_irradiance_record record = record_at(-0.3, 0, 4, 10);
    struct orl_geometry *board = scene_geometry(
        "void plastic w 0 0 5 .5 .5 .5 0 0\nw polygon b 0 0 12 0 -1 -1 0 1 -1 0 1 1 0 -1 1\n");
    const struct orl_shading_point across = place_at(0.3, 0), before = place_at(-0.9, 0);
    const struct orl_shading_point beside = place_at(-0.3, 0.6);
    struct orl_icache cache;
    struct orl_cached_irradiance found;
    (void)state;
    record.clear = 0.3;
    fill_cache(&cache, &record, 1);
    assert_true(orl_icache_covers(&cache, &across)); /* no obstacle is known there */
    cache.geometry = board;
    assert_false(orl_icache_covers(&cache, &across));
    assert_false(orl_icache_has_record_for(&cache, &across));
    assert_false(orl_icache_lookup(&cache, &across, &found));
    assert_false(orl_irradiance_records_lookup(&record, 1, &cache, &across, &found));
    assert_true(orl_icache_covers(&cache, &before) && orl_icache_lookup(&cache, &before, &found));
    assert_true(orl_icache_covers(&cache, &beside) && orl_icache_lookup(&cache, &beside, &found));
    assert_true(orl_irradiance_records_lookup(&record, 1, &cache, &beside, &found));
    orl_icache_done(&cache);
    orl_geometry_free(board);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reach_and_gradient), cmocka_unit_test(test_errors),
        cmocka_unit_test(test_hold_back),          cmocka_unit_test(test_order),
        cmocka_unit_test(test_radius_zero),        cmocka_unit_test(test_crowds),
        cmocka_unit_test(test_against_pairs),      cmocka_unit_test(test_tiny_and_far),
        cmocka_unit_test(test_thinning),           cmocka_unit_test(test_least_radius),
        cmocka_unit_test(test_board_between)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
