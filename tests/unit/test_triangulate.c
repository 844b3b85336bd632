/*
 * Polygons into triangles: the area is the polygon's, and rays hit exactly what lies inside.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/random.h"
#include "scene/triangulate.h"
#include "support/scene_text.h"

enum { MOST = 512 };

/* A polygon in its own plane. */
struct outline {
    double xy[MOST][2];
    uint32_t n;
};

static void add(struct outline *o, double x, double y)
{
    assert_true(o->n < MOST);
    o->xy[o->n][0] = x;
    o->xy[o->n][1] = y;
    o->n++;
}

static double area_of(const struct outline *o)
{
    double twice = 0;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * twice;
}

/* Even-odd rule; seams are walked twice and so cancel. */
static bool inside(const struct outline *o, double x, double y)
{
    bool in = false;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            in = !in;
    }
    return in;
}

/* Distance from a point to the outline. */
static double clearance(const struct outline *o, double x, double y)
{
    double best = INFINITY;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        const double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
        double t = l2 > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / l2 : 0;
        t = fmin(fmax(t, 0), 1);
        best = fmin(best, hypot(x - a[0] - t * dx, y - a[1] - t * dy));
    }
    return best;
}

/* A frame tilted any way: nothing may depend on axes. */
static struct orl_frame tilted(void)
{
    return orl_frame_about(orl_normalize(orl_v3(0.3, -0.5, 0.8)));
}

static struct orl_vec3 lift(const struct orl_frame *frame, double x, double y)
{
    return orl_to_world(frame, orl_v3(x, y, 0));
}

/* The triangles' areas sum to the outline's, and each is counter-clockwise. */
static void check_triangles(const struct outline *o)
{
    const struct orl_frame frame = tilted();
    struct orl_vec3 vertices[MOST];
    uint32_t triples[MOST][3];
    double sum = 0;
    for (uint32_t i = 0; i < o->n; i++)
        vertices[i] = lift(&frame, o->xy[i][0], o->xy[i][1]);
    const int n = orl_triangulate(vertices, o->n, frame.n, triples);
    assert_true(n >= 1 && (uint32_t)n <= o->n - 2);
    for (int i = 0; i < n; i++) {
        const struct orl_vec3 a = vertices[triples[i][0]];
        const double twice = orl_dot(
            orl_cross(orl_sub(vertices[triples[i][1]], a), orl_sub(vertices[triples[i][2]], a)),
            frame.n);
        assert_true(twice > 0);
        sum += 0.5 * twice;
    }
    /* Coordinates of order one in double, some hundred products. */
    assert_true(fabs(sum - area_of(o)) <= 1e-11 * fabs(area_of(o)));
}

/*
 * The same polygon, shot at through a grid: hit exactly when inside. Places within 1e-5 of the
 * outline are left out, for rays are floats.
 */
static void check_coverage(const struct outline *o)
{
    enum { SIDE = 97 };
    const struct orl_frame frame = tilted();
    char *text = malloc(64 + MOST * 100);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    assert_non_null(text);
    size_t at =
        (size_t)sprintf(text, "void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon p 0 0 %u", 3 * o->n);
    for (uint32_t i = 0; i < o->n; i++) {
        const struct orl_vec3 v = lift(&frame, o->xy[i][0], o->xy[i][1]);
        at += (size_t)sprintf(text + at, "\n%.17g %.17g %.17g", v.x, v.y, v.z);
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], o->xy[i][k]);
            high[k] = fmax(high[k], o->xy[i][k]);
        }
    }
    struct orl_geometry *g = scene_geometry(text);
    assert_true(fabs(g->facets[0].area - fabs(area_of(o))) < 1e-9 * fabs(area_of(o)));
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = low[0] + (high[0] - low[0]) * ((i % SIDE + 0.5) / SIDE * 1.1 - 0.05);
        const double y = low[1] + (high[1] - low[1]) * ((i / SIDE + 0.5) / SIDE * 1.1 - 0.05);
        const struct orl_vec3 from = orl_sub(orl_madd(lift(&frame, x, y), frame.n, 2), g->center);
        struct orl_hit hit;
        if (clearance(o, x, y) < 1e-5 * (high[0] - low[0]))
            continue;
        const bool met = orl_geometry_intersect(g, from, orl_neg(frame.n), 10, &hit);
        assert_int_equal(met, inside(o, x, y));
        assert_true(!met || fabs(hit.distance - 2) < 1e-6);
    }
    orl_geometry_free(g);
    free(text);
}

static void check(const struct outline *o)
{
    check_triangles(o);
    check_coverage(o);
}

static void from_list(struct outline *o, const double (*xy)[2], uint32_t n)
{
    o->n = 0;
    for (uint32_t i = 0; i < n; i++)
        add(o, xy[i][0], xy[i][1]);
}

static void test_convex(void **state)
{
    struct outline o = {.n = 0};
    (void)state;
    for (int i = 0; i < 17; i++)
        add(&o, cos(2 * ORL_PI * i / 17), sin(2 * ORL_PI * i / 17));
    check(&o);
}

static void test_concave(void **state)
{
    static const double comb[][2] = {{0, 0}, {7, 0}, {7, 3}, {6, 3}, {6, 1}, {5, 1},
                                     {5, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {2, 3},
                                     {2, 1}, {1, 1}, {1, 3}, {0, 3}};
    static const double arrow[][2] = {{0, 0}, {2, 1}, {0, 2}, {0.9, 1}};
    struct outline o;
    (void)state;
    from_list(&o, comb, 16);
    check(&o);
    from_list(&o, arrow, 4);
    check(&o);
}

/*
 * A wall with two windows, twenty corners: each hole is joined to the outline by a seam walked
 * there and back, the second seam leaving from a corner of the first hole, which it touches.
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
    from_list(&o, wall, 20);
    assert_true(fabs(area_of(&o) - 28) < 1e-12);
    check(&o);
}

/* Two holes hung on the same corner of the outline, one after the other. */
static void test_two_seams_at_one_corner(void **state)
{
    static const double plate[][2] = {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {1, 2},
                                      {1, 3}, {2, 3}, {2, 2}, {1, 2}, {0, 0}, {3, 1},
                                      {3, 2}, {4, 2}, {4, 1}, {3, 1}};
    struct outline o;
    (void)state;
    from_list(&o, plate, 16);
    assert_true(fabs(area_of(&o) - 34) < 1e-12);
    check(&o);
}

/* A frame: outline and hole nearly as large, seam between neighbouring corners. */
static void test_thin_frame(void **state)
{
    static const double frame[][2] = {{0, 0},       {1, 0},       {1, 1},       {0, 1},
                                      {0, 0},       {0.01, 0.01}, {0.01, 0.99}, {0.99, 0.99},
                                      {0.99, 0.01}, {0.01, 0.01}};
    struct outline o;
    (void)state;
    from_list(&o, frame, 10);
    check(&o);
}

static void test_collinear_and_duplicates(void **state)
{
    static const double square[][2] = {{0, 0}, {0.5, 0}, {1, 0}, {1, 0}, {1, 0.2}, {1, 0.7},
                                       {1, 1}, {0.3, 1}, {0, 1}, {0, 1}, {0, 1},   {0, 0.4}};
    static const double spike[][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {1, 1}, {0, 1}};
    struct outline o;
    (void)state;
    from_list(&o, square, 12);
    check(&o);
    from_list(&o, spike, 7);
    check(&o);
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
            add(&o, r * cos(phi), r * sin(phi));
        }
        if (seed % 10 == 0)
            check(&o);
        else
            check_triangles(&o);
    }
}

/* A wall of many windows on seams from one corner of the outline to the next hole, in a chain. */
static void test_many_holes(void **state)
{
    enum { HOLES = 24 };
    struct outline o = {.n = 0};
    (void)state;
    add(&o, 0, 0);
    add(&o, 2 * HOLES + 1, 0);
    add(&o, 2 * HOLES + 1, 3);
    add(&o, 0, 3);
    add(&o, 0, 0);
    /* Out along the sills, around each hole but for its sill; back along the sills. */
    for (int i = 0; i < HOLES; i++) {
        add(&o, 2 * i + 1, 1);
        add(&o, 2 * i + 1, 2);
        add(&o, 2 * i + 2, 2);
        add(&o, 2 * i + 2, 1);
    }
    for (int i = HOLES; i-- > 0;) {
        if (i < HOLES - 1)
            add(&o, 2 * i + 2, 1);
        add(&o, 2 * i + 1, 1);
    }
    assert_true(fabs(area_of(&o) - (3.0 * (2 * HOLES + 1) - HOLES)) < 1e-9);
    check(&o);
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
