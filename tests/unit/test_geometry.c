/*
 * Rays against surfaces: closed forms for curved ones, closed meshes without leaks, translation
 * invariance, and no false hits at slivers.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/geometry/coincidence/coincident.h"
#include "scene/geometry/geometry.h"
#include "support/meshes.h"
#include "support/scene_text.h"

#define GREY MESH_GREY

/* ---- Curved surfaces --------------------------------------------------------------------------
 *
 * Rays are shot at known points of a surface: from point p back along a direction, so that the hit
 * is p unless something nearer is in the way (which convexity excludes).
 */

/* One kind of surface in its own frame: a point, its outward normal, and whether p is on the
 * surface. */
struct curved {
    const char *text;
    bool inverted; /* true if the normal points inwards */
    /* Computes a point and its outward normal for two uniform numbers. */
    void (*at)(double u, double v, struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal);
};

static void sphere_at(double u, double v, struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const double z = 2 * u - 1, s = sqrt(1 - z * z), phi = 2 * ORL_PI * v;
    *ret_normal = orl_v3(s * cos(phi), s * sin(phi), z);
    *ret_point = orl_madd(orl_v3(1, -2, 3), *ret_normal, 0.75);
}

static void cylinder_at(double u, double v, struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const struct orl_vec3 a = orl_v3(0, 0, 1), d = orl_v3(2, 1, 2);
    const struct orl_frame frame = orl_frame_about(orl_normalize(d));
    const double phi = 2 * ORL_PI * v;
    *ret_normal = orl_to_world(&frame, orl_v3(cos(phi), sin(phi), 0));
    *ret_point = orl_madd(orl_madd(a, d, u), *ret_normal, 0.5);
}

/* A cone from radius 1 at the origin to 0.25 at (0, 0, 2), with the tip cut off. */
static void cone_at(double u, double v, struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const double r = 1 - 0.75 * u, phi = 2 * ORL_PI * v;
    *ret_point = orl_v3(r * cos(phi), r * sin(phi), 2 * u);
    *ret_normal = orl_normalize(orl_v3(cos(phi), sin(phi), 0.375));
}

static void ring_at(double u, double v, struct orl_vec3 *ret_point, struct orl_vec3 *ret_normal)
{
    const struct orl_frame frame = orl_frame_about(orl_normalize(orl_v3(1, 1, 1)));
    const double r = 0.5 + u, phi = 2 * ORL_PI * v;
    *ret_normal = frame.n;
    *ret_point =
        orl_add(orl_v3(0, 0, 5), orl_to_world(&frame, orl_v3(r * cos(phi), r * sin(phi), 0)));
}

static const struct curved kinds[] = {
    {GREY "m sphere s 0 0 4 1 -2 3 .75", false, sphere_at},
    {GREY "m bubble s 0 0 4 1 -2 3 .75", true, sphere_at},
    {GREY "m cylinder s 0 0 7 0 0 1 2 1 3 .5", false, cylinder_at},
    {GREY "m tube s 0 0 7 0 0 1 2 1 3 .5", true, cylinder_at},
    {GREY "m cone s 0 0 8 0 0 0 0 0 2 1 .25", false, cone_at},
    {GREY "m cup s 0 0 8 0 0 0 0 0 2 1 .25", true, cone_at},
    {GREY "m ring s 0 0 8 0 0 5 1 1 1 .5 1.5", false, ring_at},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

/*
 * Shoots a ray at p along the normal, from a distance `away` on the outer or the inner side: it
 * hits p first, because nothing is in between. Tolerances: origins and directions are rounded to
 * floats to find the surface, but the hit is computed in double from the same ray: 1e-9 of the
 * distance.
 */
static void check_head_on(const struct orl_geometry *g, const struct curved *kind, double u,
                          double v, double away)
{
    struct orl_vec3 p, n;
    struct orl_hit hit;
    kind->at(u, v, &p, &n);
    p = orl_sub(p, g->center);
    const struct orl_vec3 from = orl_madd(p, n, away);
    const struct orl_vec3 d = orl_normalize(orl_sub(p, from));
    const struct orl_vec3 front = kind->inverted ? orl_neg(n) : n;
    assert_true(orl_geometry_intersect(g, from, d, INFINITY, &hit));
    assert_true(fabs(hit.distance - fabs(away)) < 1e-9 * (1 + fabs(away)));
    assert_true(orl_length(orl_sub(hit.point, p)) < 1e-9 * (1 + fabs(away)));
    assert_true(orl_length(orl_sub(hit.normal, front)) < 1e-8 * (1 + fabs(away)));
    assert_int_equal(hit.facet, 0);
    assert_int_equal(hit.front, orl_dot(d, front) < 0);
    /* The position along the axis and the angle about it are the numbers that the point was made
     * from. */
    double uv[2];
    orl_hit_uv(g, &hit, uv);
    assert_true(fabs(uv[1] - u) < 1e-8 * (1 + fabs(away)));
    assert_true(fabs(remainder(uv[0] - v, 1)) < 1e-8 * (1 + fabs(away)));
    assert_true(orl_geometry_occluded(g, from, d, INFINITY));
    /* Slightly before p, and slightly behind it, the ray hits nothing. */
    assert_false(orl_geometry_occluded(g, from, d, fabs(away) * 0.999));
    const struct orl_vec3 left = orl_hit_ray_origin(g, &hit, orl_neg(d));
    assert_false(orl_geometry_occluded(g, left, orl_neg(d), 0.2));
}

static void test_curved_head_on(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        struct orl_random random = orl_random_stream((uint64_t)k, ORL_PURPOSE_BENCH, 2);
        for (int i = 0; i < 2000; i++) {
            const double u = 0.001 + 0.998 * orl_random_uniform(&random);
            const double v = orl_random_uniform(&random);
            check_head_on(g, &kinds[k], u, v, 0.01 + 0.2 * orl_random_uniform(&random));
            check_head_on(g, &kinds[k], u, v, -0.21 + 0.2 * orl_random_uniform(&random));
            check_head_on(g, &kinds[k], u, v, 100 * orl_random_uniform(&random) + 0.01);
        }
        orl_geometry_free(g);
    }
}

/* Nothing extends beyond the rims: rays just outside of u's range pass. */
static void test_rims(void **state)
{
    (void)state;
    for (int k = 2; k < KINDS; k++) {
        struct orl_geometry *g = scene_geometry(kinds[k].text);
        for (int i = 0; i < 200; i++) {
            const double v = i / 200.0, ends[2] = {-0.001, 1.001};
            for (int e = 0; e < 2; e++) {
                struct orl_vec3 p, n;
                kinds[k].at(ends[e], v, &p, &n);
                const struct orl_vec3 from = orl_sub(orl_madd(p, n, 0.1), g->center);
                assert_false(orl_geometry_occluded(g, from, orl_neg(n), 0.15));
            }
        }
        orl_geometry_free(g);
    }
}

/* A sphere hit off centre, from a million radii away and from inside, by the closed form. */
static void test_sphere_closed_form(void **state)
{
    struct orl_geometry *g = scene_geometry(GREY "m sphere s 0 0 4 0 0 0 2");
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (int i = 0; i < 20000; i++) {
        const double far = i % 4 == 0 ? 1e3 : i % 4 == 1 ? 10 : 1.5;
        const struct orl_vec3 from = orl_scale(mesh_direction(&random), far);
        const struct orl_vec3 aim =
            orl_scale(mesh_direction(&random), 1.9 * orl_random_uniform(&random));
        const struct orl_vec3 d = orl_normalize(orl_sub(aim, from));
        const double h = orl_dot(from, d);
        const double root = sqrt(h * h - orl_dot(from, from) + 4);
        const double t = far > 2 ? -h - root : -h + root;
        struct orl_hit hit;
        assert_true(orl_geometry_intersect(g, from, d, INFINITY, &hit));
        /* The reference itself has cancellation: far^2 in double. */
        assert_true(fabs(hit.distance - t) < 1e-13 * far * far + 1e-9);
        assert_true(fabs(orl_length(hit.point) - 2) < 1e-11 * far);
        assert_int_equal(hit.front, far > 2);
    }
    orl_geometry_free(g);
}

/* ---- Leaks ------------------------------------------------------------------------------------
 */

/* Rays from inside, aimed at edges, corners and random points: all hit. */
static void check_closed(const char *text)
{
    struct orl_geometry *g = scene_geometry(text);
    assert_int_equal(mesh_leaks(g, 500000, 5), 0);
    orl_geometry_free(g);
}

static void test_no_leaks(void **state)
{
    char *sphere = mesh_icosphere();
    (void)state;
    check_closed(MESH_BOX);
    check_closed(sphere);
    free(sphere);
}

/*
 * Paths that start on the surface, as photons do after a bounce, stay inside: no leak in 2e5
 * bounces, corners included.
 */
static void test_no_leaks_on_bounce(void **state)
{
    char *sphere = mesh_icosphere();
    const char *const texts[3] = {MESH_BOX, sphere, GREY "m bubble s 0 0 4 0 0 0 1"};
    (void)state;
    for (int t = 0; t < 3; t++) {
        struct orl_geometry *g = scene_geometry(texts[t]);
        assert_int_equal(mesh_leaks_on_bounce(g, 200000, 6), 0);
        orl_geometry_free(g);
    }
    free(sphere);
}

/* ---- Translation ----------------------------------------------------------------------------- */

/* 1e5 m away, the same rays hit the same points, within the resolution of doubles at 1e5 (1e-10).
 */
static void test_shifted(void **state)
{
    static const char shape[] = "m polygon p 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0\n"
                                "m sphere s 0 0 4 1 1 1 .5\n"
                                "m cylinder c 0 0 7 3 2 0 3 2 2 .25\n"
                                "m ring r 0 0 8 2 1.5 2.5 0 0 -1 0 .3\n";
    char near_text[512], far_text[512];
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, 0);
    int hits = 0;
    (void)state;
    snprintf(near_text, sizeof near_text, GREY "%s", shape);
    snprintf(far_text, sizeof far_text,
             GREY "m polygon p 0 0 12 100000 -100000 0 100004 -100000 0 100004 -99997 0 100000 "
                  "-99997 0\n"
                  "m sphere s 0 0 4 100001 -99999 1 .5\n"
                  "m cylinder c 0 0 7 100003 -99998 0 100003 -99998 2 .25\n"
                  "m ring r 0 0 8 100002 -99998.5 2.5 0 0 -1 0 .3\n");
    struct orl_geometry *here = scene_geometry(near_text), *there = scene_geometry(far_text);
    for (int i = 0; i < 20000; i++) {
        const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
        const struct orl_vec3 from = orl_v3(4 * u - 2, 3 * v - 1.5, 2 * (i % 9) / 9.0 - 1);
        const struct orl_vec3 d = mesh_direction(&random);
        struct orl_hit a, b;
        const bool met = orl_geometry_intersect(here, from, d, INFINITY, &a);
        const bool also = orl_geometry_intersect(there, from, d, INFINITY, &b);
        assert_int_equal(met, also);
        if (!met)
            continue;
        hits++;
        assert_int_equal(a.facet, b.facet);
        assert_true(fabs(a.distance - b.distance) < 1e-7);
        assert_true(orl_length(orl_sub(a.point, b.point)) < 1e-7);
    }
    assert_true(hits > 5000);
    orl_geometry_free(here);
    orl_geometry_free(there);
}

/* ---- Slivers ----------------------------------------------------------------------------------
 */

/*
 * Needles of 1e-7 m width and triangles of no area in front of a wall, a speck beside a plain of 1
 * km. A ray that passes them hits the wall, at the right distance.
 */
static void test_slivers(void **state)
{
    static const char text[] =
        GREY "m polygon needle 0 0 9 0 0 1  1 0 1  0.5 1e-7 1\n"
             "m polygon line 0 0 9 0 0.5 1  1 0.5 1  0.25 0.5 1\n"
             "m polygon dot 0 0 9 .3 .3 1  .3 .3 1  .3 .3 1\n"
             "m polygon speck 0 0 9 .2 .2 1  .2001 .2 1  .2 .2001 1\n"
             "m polygon plain 0 0 12 -500 -500 0 500 -500 0 500 500 0 -500 500 0\n";
    struct orl_geometry *g = scene_geometry(text);
    struct orl_random random = orl_random_stream(8, ORL_PURPOSE_BENCH, 0);
    (void)state;
    /* The line and the dot have no area and are dropped by the parser. */
    assert_int_equal(g->n_facets, 3);
    for (int i = 0; i < 50000; i++) {
        const struct orl_vec3 from =
            orl_sub(orl_v3(orl_random_uniform(&random), orl_random_uniform(&random), 2), g->center);
        const struct orl_vec3 file = orl_add(from, g->center);
        struct orl_hit hit;
        assert_true(orl_geometry_intersect(g, from, orl_v3(0, 0, -1), INFINITY, &hit));
        /* Rays are floats, 4e-8 of the 500 m about the centre: places have an error of up to 3e-5
         * m. */
        const bool at_speck =
            file.x > 0.1999 && file.x < 0.2002 && file.y > 0.1999 && file.y < 0.2002;
        if (file.y < 1e-4 || at_speck)
            continue;
        assert_int_equal(hit.facet, 2);
        assert_true(fabs(hit.distance - 2) < 1e-9);
    }
    orl_geometry_free(g);
}

/* The speck is hit from far away. */
static void test_tiny_beside_huge(void **state)
{
    struct orl_geometry *g =
        scene_geometry(GREY "m polygon speck 0 0 12 .2 .2 1  .21 .2 1  .21 .21 1 .2 .21 1\n"
                            "m polygon plain 0 0 12 -500 -500 0 500 -500 0 500 500 0 -500 500 0\n");
    struct orl_hit hit;
    (void)state;
    const struct orl_vec3 from = orl_sub(orl_v3(.205, .205, 100), g->center);
    assert_true(orl_geometry_intersect(g, from, orl_v3(0, 0, -1), INFINITY, &hit));
    assert_int_equal(hit.facet, 0);
    assert_true(fabs(hit.distance - 99) < 1e-9);
    orl_geometry_free(g);
}

/* ---- Texture coordinates ----------------------------------------------------------------------
 */

/* The barycentric coordinates give the place of the hit, also if a coincident facet that faces the
 * other way has been hit instead. */
static void check_shares(const struct orl_geometry *g, const struct orl_hit *hit)
{
    double uv[2];
    orl_hit_uv(g, hit, uv);
    const struct orl_triangle t = orl_triangle_get(g, hit->triangle);
    const struct orl_vec3 there = orl_add(orl_scale(t.a, 1 - uv[0] - uv[1]),
                                          orl_add(orl_scale(t.b, uv[0]), orl_scale(t.c, uv[1])));
    assert_int_equal(orl_triangle_facet(g, hit->triangle), hit->facet);
    assert_true(uv[0] > -1e-6 && uv[1] > -1e-6 && uv[0] + uv[1] < 1 + 1e-6);
    assert_true(orl_length(orl_sub(there, hit->point)) < 1e-12);
    assert_int_equal(hit->instance, 0);
}

static void test_triangle_shares(void **state)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    struct orl_parsed_scene d =
        scene_parse_text(GREY "m polygon l 0 0 18 0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0\n"
                              "void plastic n 0 0 5 .2 .2 .2 0 0\n"
                              "n polygon k 0 0 18 0 0 0 0 2 0 1 2 0 1 1 0 2 1 0 2 0 0\n",
                         NULL, NULL);
    struct orl_geometry *g;
    struct orl_error err;
    int met[2] = {0, 0};
    (void)state;
    assert_int_equal(orl_coincident_resolve(&d, &err), 0);
    assert_int_equal(orl_geometry_new(&d, &g, &err), 0);
    for (int i = 0; i < 2000; i++) {
        const double x = 2 * orl_random_uniform(&random), y = 2 * orl_random_uniform(&random);
        const double z = i % 2 ? 1 : -1;
        struct orl_hit hit;
        if (!orl_geometry_intersect(g, orl_sub(orl_v3(x, y, z), g->center), orl_v3(0, 0, -z), 2,
                                    &hit))
            continue;
        check_shares(g, &hit);
        assert_true(hit.front);
        met[hit.facet]++;
    }
    assert_true(met[0] > 500 && met[1] > 500);
    orl_geometry_free(g);
    orl_parsed_scene_done(&d);
}

/* A sensor within a rounded digit above or under the floor has a free view upwards. One that is
 * really under a sheet sees the sheet; one that faces down is never moved up. */
static void test_sensors_on_a_floor(void **state)
{
    static const struct {
        double z, facing;
        bool on; /* true if nothing is between the sensor and what it faces */
    } sensors[] = {{1, 1, true},         {1 + 3e-6, 1, true},  {1 - 3e-6, 1, true},
                   {1 - 9e-5, 1, true},  {1 - 2e-4, 1, false}, {1 - 3e-6, -1, true},
                   {1 + 3e-6, -1, true}, {1 + 9e-5, -1, true}, {1 + 2e-4, -1, false}};
    struct orl_parsed_scene d = scene_parse_text("void plastic m 0 0 5 .5 .5 .5 0 0\n"
                                                 "m polygon p 0 0 12 -9 -9 1 9 -9 1 9 9 1 -9 9 1\n",
                                                 NULL, NULL);
    struct orl_geometry *g;
    struct orl_error err;
    (void)state;
    assert_int_equal(orl_geometry_new(&d, &g, &err), 0);
    for (size_t i = 0; i < sizeof sensors / sizeof *sensors; i++) {
        const struct orl_vec3 at = orl_sub(orl_v3(.3, .2, sensors[i].z), g->center);
        const struct orl_vec3 facing = orl_v3(0, 0, sensors[i].facing);
        const struct orl_vec3 from = orl_offset_from_surface(g, at, facing);
        struct orl_hit hit;
        assert_true(orl_dot(orl_sub(from, at), facing) < 3e-4);
        if (orl_geometry_intersect(g, from, facing, 1, &hit) == sensors[i].on)
            fail_msg("z %.9g, facing %g", sensors[i].z, sensors[i].facing);
    }
    orl_geometry_free(g);
    orl_parsed_scene_done(&d);
}

/* A field of squares of two triangles each: shared corners are stored once, at their written
 * places. */
static void test_shared_corners(void **state)
{
    enum { ACROSS = 40, SQUARES = ACROSS * ACROSS };
    static char text[SQUARES * 2 * 80];
    char *end = text + sprintf(text, "%s", GREY);
    for (int i = 0; i < SQUARES; i++) {
        const int x = i % ACROSS, y = i / ACROSS;
        const int z[4] = {x * y % 7, (x + 1) * y % 7, (x + 1) * (y + 1) % 7, x * (y + 1) % 7};
        end += sprintf(end, "m polygon a 0 0 9 %d %d %d %d %d %d %d %d %d\n", x, y, z[0], x + 1, y,
                       z[1], x + 1, y + 1, z[2]);
        end += sprintf(end, "m polygon b 0 0 9 %d %d %d %d %d %d %d %d %d\n", x, y, z[0], x + 1,
                       y + 1, z[2], x, y + 1, z[3]);
    }
    struct orl_parsed_scene d = scene_parse_text(text, NULL, NULL);
    struct orl_geometry *g = NULL;
    assert_int_equal(orl_geometry_new(&d, &g, NULL), 0);
    assert_int_equal(orl_geometry_count_triangles(g), 2 * SQUARES);
    assert_true((double)g->n_quads < 1.01 * SQUARES);
    assert_true(g->n_corners >= (ACROSS + 1) * (ACROSS + 1));
    assert_true((double)g->n_corners <
                1.1 * (ACROSS + 1) * (ACROSS + 1)); /* a few duplicates are not detected */
    for (size_t i = 0; i < orl_geometry_triangles_end(g); i++) {
        const struct orl_surface *s = &d.surfaces[g->facets[orl_triangle_facet(g, i)].surface];
        double nearest[3] = {INFINITY, INFINITY, INFINITY};
        const struct orl_triangle t = orl_triangle_get(g, i);
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 9; k++)
            nearest[k / 3] =
                fmin(nearest[k / 3],
                     orl_length(orl_sub(orl_sub(s->vertices[k % 3], g->center), corners[k / 3])));
        for (int k = 0; k < 3; k++)
            assert_true(nearest[k] == 0);
    }
    orl_geometry_free(g);
    orl_parsed_scene_done(&d);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_curved_head_on),
        cmocka_unit_test(test_rims),
        cmocka_unit_test(test_sphere_closed_form),
        cmocka_unit_test(test_no_leaks),
        cmocka_unit_test(test_no_leaks_on_bounce),
        cmocka_unit_test(test_shifted),
        cmocka_unit_test(test_slivers),
        cmocka_unit_test(test_tiny_beside_huge),
        cmocka_unit_test(test_triangle_shares),
        cmocka_unit_test(test_shared_corners),
        cmocka_unit_test(test_sensors_on_a_floor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
