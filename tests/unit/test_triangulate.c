/* Polygons into triangles: the area is kept, and rays hit exactly the inside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "base/sampling/sampling.h"
#include "support/outline.h"

static void check_outline(const struct outline *o)
{
    /* Coordinates are of order one, in double, with some hundred products. */
    assert_true(outline_area_error(o) <= 1e-11);
    assert_int_equal(outline_misses(o, OUTLINE_GRID), 0);
}

static void test_convex(void **state)
{
    struct outline o = {.n = 0};
    (void)state;
    for (int i = 0; i < 17; i++)
        outline_add(&o, cos(2 * ORL_PI * i / 17), sin(2 * ORL_PI * i / 17));
    check_outline(&o);
}

static void test_concave(void **state)
{
    static const double comb[][2] = {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1},
                                     {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3},
                                     {2, 1}, {1, 1}, {1, 3}, {0, 3}};
    static const double arrow[][2] = {{0, 0}, {2, 1}, {0, 2}, {0.9, 1}};
    struct outline o;
    (void)state;
    o = outline_of(comb, 16);
    check_outline(&o);
    o = outline_of(arrow, 4);
    check_outline(&o);
}

/*
 * A wall with two windows, twenty corners. Each hole is joined to the outline by a seam, traversed
 * in both directions; the second seam starts at a corner of the first hole, which it touches.
 */
static void test_keyholed(void **state)
{
    static const double wall[][2] = {
        {0, 0}, {10, 0}, {10, 4},    {0, 4},       {0, 0}, /* back at the start */
        {1, 1}, {1, 3},  {4, 3},     {4, 1},               /* first hole */
        {6, 1}, {6, 3},  {9, 3},     {9, 1},       {6, 1}, /* second hole */
        {4, 1}, {1, 1},  {0.5, 0.5}, {0.25, 0.25}, {0.125, 0.125}, {0.0625, 0.0625}};
    struct outline o;
    (void)state;
    o = outline_of(wall, 20);
    assert_true(fabs(outline_area(&o) - 28) < 1e-12);
    check_outline(&o);
}

/* Two holes joined to the same corner of the outline, one after the other. */
static void test_two_seams_at_one_corner(void **state)
{
    static const double plate[][2] = {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {1, 2},
                                      {1, 3}, {2, 3}, {2, 2}, {1, 2}, {0, 0}, {3, 1},
                                      {3, 2}, {4, 2}, {4, 1}, {3, 1}};
    struct outline o;
    (void)state;
    o = outline_of(plate, 16);
    assert_true(fabs(outline_area(&o) - 34) < 1e-12);
    check_outline(&o);
}

/* A frame: the hole is nearly as large as the outline, with a seam between neighbouring corners. */
static void test_thin_frame(void **state)
{
    static const double frame[][2] = {{0, 0},       {1, 0},       {1, 1},       {0, 1},
                                      {0, 0},       {0.01, 0.01}, {0.01, 0.99}, {0.99, 0.99},
                                      {0.99, 0.01}, {0.01, 0.01}};
    struct outline o;
    (void)state;
    o = outline_of(frame, 10);
    check_outline(&o);
}

static void test_collinear_and_duplicates(void **state)
{
    static const double square[][2] = {{0, 0}, {0.5, 0}, {1, 0}, {1, 0}, {1, 0.2}, {1, 0.7},
                                       {1, 1}, {0.3, 1}, {0, 1}, {0, 1}, {0, 1},   {0, 0.4}};
    static const double spike[][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {1, 1}, {0, 1}};
    struct outline o;
    (void)state;
    o = outline_of(square, 12);
    check_outline(&o);
    o = outline_of(spike, 7);
    check_outline(&o);
}

/* Stars: random radii about a centre make a simple polygon, sharp and concave. */
static void test_random_stars(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 60; seed++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 1);
        const uint32_t n = 5 + (uint32_t)(orl_random_uniform(&random) * (seed < 50 ? 60 : 500));
        struct outline o = {.n = 0};
        for (uint32_t i = 0; i < n; i++) {
            const double r = 0.1 + orl_random_uniform(&random), phi = 2 * ORL_PI * i / n;
            outline_add(&o, r * cos(phi), r * sin(phi));
        }
        if (seed % 10 == 0)
            check_outline(&o);
        else
            assert_true(outline_area_error(&o) <= 1e-11);
    }
}

/* A wall of many windows in a chain of seams, from one corner of the outline to the next hole. */
static void test_many_holes(void **state)
{
    enum { HOLES = 24 };
    struct outline o = {.n = 0};
    (void)state;
    outline_add(&o, 0, 0);
    outline_add(&o, 2 * HOLES + 1, 0);
    outline_add(&o, 2 * HOLES + 1, 3);
    outline_add(&o, 0, 3);
    outline_add(&o, 0, 0);
    /* Out along the sills, around each hole except for its sill; back along the sills. */
    for (int i = 0; i < HOLES; i++) {
        outline_add(&o, 2 * i + 1, 1);
        outline_add(&o, 2 * i + 1, 2);
        outline_add(&o, 2 * i + 2, 2);
        outline_add(&o, 2 * i + 2, 1);
    }
    for (int i = HOLES; i-- > 0;) {
        if (i < HOLES - 1)
            outline_add(&o, 2 * i + 2, 1);
        outline_add(&o, 2 * i + 1, 1);
    }
    assert_true(fabs(outline_area(&o) - (3.0 * (2 * HOLES + 1) - HOLES)) < 1e-9);
    check_outline(&o);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_convex),       cmocka_unit_test(test_concave),
        cmocka_unit_test(test_keyholed),     cmocka_unit_test(test_two_seams_at_one_corner),
        cmocka_unit_test(test_thin_frame),   cmocka_unit_test(test_collinear_and_duplicates),
        cmocka_unit_test(test_random_stars), cmocka_unit_test(test_many_holes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
