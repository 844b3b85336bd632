/*
 * Points sampled on surfaces: uniform by area for every kind, and the area itself.
 *
 * Points are binned along two coordinates in which equal bins have equal area, and compared by
 * chi-square. Seeds are fixed; the threshold is the 99.99 % quantile, by Wilson and Hilferty's
 * cube root (z = 3.72).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "support/scene_text.h"

#define GREY "void plastic m 0 0 5 .5 .5 .5 0 0\n"

enum { SIDE = 16, BINS = SIDE * SIDE, DRAWS = 100 * BINS };

/* Maps a point to two coordinates of [0,1), uniform by area. */
typedef void (*flatten)(struct orl_vec3 p, double ret_uv[2]);

struct kind {
    const char *text;
    double area;
    flatten uv;
    bool inwards;
};

static double angle_in_turns(double y, double x)
{
    const double t = atan2(y, x) / (2 * ORL_PI);
    return t < 0 ? t + 1 : t;
}

static void flatten_sphere(struct orl_vec3 p, double ret_uv[2])
{
    ret_uv[0] = 0.5 * (p.z / 2 + 1); /* Archimedes */
    ret_uv[1] = angle_in_turns(p.y, p.x);
}

static void flatten_cylinder(struct orl_vec3 p, double ret_uv[2])
{
    ret_uv[0] = p.z / 3;
    ret_uv[1] = angle_in_turns(p.y, p.x);
}

/* Radius from 1 down to 0.25: area below radius r is 1 - r^2 of 1 - 1/16. */
static void flatten_cone(struct orl_vec3 p, double ret_uv[2])
{
    ret_uv[0] = (1 - p.x * p.x - p.y * p.y) / (1 - 0.0625);
    ret_uv[1] = angle_in_turns(p.y, p.x);
}

static void flatten_ring(struct orl_vec3 p, double ret_uv[2])
{
    ret_uv[0] = (p.x * p.x + p.y * p.y - 0.25) / 2;
    ret_uv[1] = angle_in_turns(p.y, p.x);
}

static void flatten_rectangle(struct orl_vec3 p, double ret_uv[2])
{
    ret_uv[0] = p.x / 3;
    ret_uv[1] = p.y / 2;
}

static const struct kind kinds[] = {
    {GREY "m sphere s 0 0 4 0 0 0 2", 16 * ORL_PI, flatten_sphere, false},
    {GREY "m bubble s 0 0 4 0 0 0 2", 16 * ORL_PI, flatten_sphere, true},
    {GREY "m cylinder s 0 0 7 0 0 0 0 0 3 .5", 3 * ORL_PI, flatten_cylinder, false},
    {GREY "m tube s 0 0 7 0 0 0 0 0 3 .5", 3 * ORL_PI, flatten_cylinder, true},
    {GREY "m cone s 0 0 8 0 0 0 0 0 1 1 .25", ORL_PI * 1.25 * 1.25, flatten_cone, false},
    {GREY "m cup s 0 0 8 0 0 0 0 0 1 1 .25", ORL_PI * 1.25 * 1.25, flatten_cone, true},
    {GREY "m ring s 0 0 8 0 0 0 0 0 1 .5 1.5", 2 * ORL_PI, flatten_ring, false},
    {GREY "m polygon s 0 0 12 0 0 0 3 0 0 3 2 0 0 2 0", 6, flatten_rectangle, false},
    /* The polygon with redundant corners: more triangles, of all sizes. */
    {GREY "m polygon s 0 0 21 0 0 0 .1 0 0 3 0 0 3 1.9 0 3 2 0 1.5 2 0 0 2 0", 6, flatten_rectangle,
     false},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* Returns the 99.99 % quantile of chi-square with n degrees of freedom. */
static double chi_square_bound(double n)
{
    const double c = 2 / (9 * n), root = 1 - c + 3.72 * sqrt(c);
    return n * root * root * root;
}

static void sample_points(const struct orl_geometry *g, struct orl_random *random,
                          struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const double u0 = orl_random_uniform(random), u[2] = {u0, orl_random_uniform(random)};
    orl_facet_sample(g, 0, u, ret_point, ret_normal);
    *ret_point = orl_add(*ret_point, g->center);
}

static void test_uniform_by_area(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        struct orl_random random = orl_random_stream((uint64_t)k, ORL_PURPOSE_BENCH, 3);
        double count[BINS] = {0}, chi2 = 0;
        for (int i = 0; i < DRAWS; i++) {
            struct orl_vec3 p, n;
            double uv[2];
            sample_points(g, &random, &p, &n);
            kinds[k].uv(p, uv);
            const int x = (int)floor(uv[0] * SIDE), y = (int)floor(uv[1] * SIDE);
            /* Rounding may put a point of the rim slightly outside. */
            assert_true(uv[0] > -1e-9 && uv[0] < 1 + 1e-9 && uv[1] > -1e-9 && uv[1] < 1 + 1e-9);
            count[(x < 0      ? 0
                   : x < SIDE ? x
                              : SIDE - 1) *
                      SIDE +
                  (y < 0      ? 0
                   : y < SIDE ? y
                              : SIDE - 1)]++;
        }
        for (int b = 0; b < BINS; b++)
            chi2 += (count[b] - 100) * (count[b] - 100) / 100;
        assert_true(chi2 < chi_square_bound(BINS - 1));
        orl_geometry_free(g);
    }
}

static void test_area(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        assert_true(fabs(g->facets[0].area / kinds[k].area - 1) < 1e-12);
        orl_geometry_free(g);
    }
}

/* Points lie on the surface, with the normal of a ray hit there. */
static void test_on_the_surface(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        struct orl_random random = orl_random_stream((uint64_t)k, ORL_PURPOSE_BENCH, 4);
        int missed = 0;
        for (int i = 0; i < 2000; i++) {
            struct orl_vec3 p, n;
            struct orl_hit hit;
            sample_points(g, &random, &p, &n);
            assert_true(fabs(orl_length(n) - 1) < 1e-12);
            const struct orl_vec3 from = orl_sub(orl_madd(p, n, 0.01), g->center);
            if (!orl_geometry_intersect(g, from, orl_neg(n), 0.02, &hit)) {
                missed++;
                continue;
            }
            assert_true(hit.front);
            assert_true(orl_length(orl_sub(orl_add(hit.point, g->center), p)) < 1e-9);
            assert_true(orl_length(orl_sub(hit.normal, n)) < 1e-7);
        }
        /* Only a point within a float's rounding of an open rim may be missed. */
        assert_true(missed <= 1);
        orl_geometry_free(g);
    }
}

/* A sample at the ends of the unit square is on the surface too. */
static void test_corners_of_the_square(void **state)
{
    static const double last = 1 - 0x1p-53;
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        for (int i = 0; i < 4; i++) {
            const double u[2] = {i & 1 ? last : 0, i & 2 ? last : 0};
            struct orl_vec3 p, n;
            double uv[2];
            orl_facet_sample(g, 0, u, &p, &n);
            kinds[k].uv(orl_add(p, g->center), uv);
            assert_true(uv[0] > -1e-9 && uv[0] < 1 + 1e-9);
            assert_true(fabs(orl_length(n) - 1) < 1e-12);
        }
        orl_geometry_free(g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uniform_by_area),
        cmocka_unit_test(test_area),
        cmocka_unit_test(test_on_the_surface),
        cmocka_unit_test(test_corners_of_the_square),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
