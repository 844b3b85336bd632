/*
 * Footprints against known areas: whole discs, halves at an edge, quarters in a corner, discs cut
 * by a wall, adjacent tiles, a gap between two plates.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "photon/surface/footprint.h"
#include "support/scene_text.h"

#define GREY "void plastic w 0 0 5 .5 .5 .5 0 0\n"

static struct orl_lit_scene *lit_scene_of(const char *scene)
{
    return build_lit_scene(scene, NULL, NULL, NULL);
}

/* Returns the share of the disc that the footprint at a place of the scene covers. */
static double share_at(const struct orl_lit_scene *lit_scene, struct orl_vec3 place,
                       struct orl_vec3 normal, double radius)
{
    struct orl_surface_point surface_point;
    struct orl_footprint footprint;
    assert_true(orl_surface_point_find(lit_scene, orl_sub(place, lit_scene->geometry->center),
                                       normal, 1e-4, &surface_point));
    orl_footprint_make(&surface_point, radius, &footprint);
    const double share = orl_footprint_area(&footprint, radius) / (ORL_PI * radius * radius);
    if (orl_surface_point_is_clear(&surface_point, radius))
        assert_true(share > 1 - 1e-9);
    return share;
}

/* Returns the share of a disc on one side of a straight line at distance / radius. */
static double segment(double distance)
{
    return 1 - (acos(distance) - distance * sqrt(1 - distance * distance)) / ORL_PI;
}

static const struct orl_vec3 up = {0, 0, 1};

static void edges_and_corners(void **state)
{
    struct orl_lit_scene *lit_scene =
        lit_scene_of(GREY "w polygon f 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0\n");
    (void)state;
    assert_true(fabs(share_at(lit_scene, orl_v3(2, 1.5, 0), up, 1) - 1) < 1e-9);
    assert_true(fabs(share_at(lit_scene, orl_v3(2, 0, 0), up, 0.5) - 0.5) < 1e-3);
    assert_true(fabs(share_at(lit_scene, orl_v3(0, 0, 0), up, 0.5) - 0.25) < 1e-3);
    for (double d = 0.05; d < 1; d += 0.1)
        assert_true(fabs(share_at(lit_scene, orl_v3(2, 0.5 * d, 0), up, 0.5) - segment(d)) < 2e-4);
    orl_lit_scene_free(lit_scene);
}

static void walls(void **state)
{
    struct orl_lit_scene *lit_scene =
        lit_scene_of(GREY "w polygon f 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
                          "w polygon on 0 0 12 2 0 0 2 4 0 2 4 3 2 0 3\n"
                          "w polygon off 0 0 12 0 2 .01 4 2 .01 4 2 3 0 2 3\n"
                          "w polygon ramp 0 0 12 0 3 0 4 3 0 4 4 .3 0 4 .3\n");
    (void)state;
    for (double d = 0.05; d < 1; d += 0.1) {
        assert_true(fabs(share_at(lit_scene, orl_v3(2 + 0.5 * d, 0.9, 0), up, 0.5) - segment(d)) <
                    2e-4);
        assert_true(fabs(share_at(lit_scene, orl_v3(1, 2 - 0.5 * d, 0), up, 0.5) - segment(d)) <
                    2e-4);
    }
    orl_lit_scene_free(lit_scene);
}

static void tiles_and_gaps(void **state)
{
    struct orl_lit_scene *lit_scene = lit_scene_of(GREY "!genbox w a 1 1 1 | xform -a 3 -t 1 0 0\n"
                                                        "!genbox w b 3 1 1 | xform -t 0 1.1 0\n");
    (void)state;
    /* Three adjacent boxes have one common top; the fourth is beyond a gap. */
    assert_true(fabs(share_at(lit_scene, orl_v3(1.02, 0.5, 1), up, 0.4) - 1) < 1e-9);
    assert_true(fabs(share_at(lit_scene, orl_v3(1.5, 0.9, 1), up, 0.5) - segment(0.2)) < 2e-4);
    orl_lit_scene_free(lit_scene);
}

/* Computes moments of a disc cut by straight lines, by the midpoints of a million small squares. */
static struct orl_moments brute_force(const struct orl_footprint *footprint, double radius)
{
    enum { SIDE = 1000 };
    const double step = 2 * radius / SIDE;
    struct orl_moments m = {0};
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = (i % SIDE + 0.5) * step - radius, y = (i / SIDE + 0.5) * step - radius;
        const struct orl_frame *frame = &footprint->frame;
        const struct orl_vec3 chord = orl_madd(orl_scale(frame->u, x), frame->v, y);
        if (x * x + y * y > radius * radius || !orl_footprint_contains(footprint, chord))
            continue;
        const struct orl_moments one = {1, x, y, x * x, x * y, y * y};
        m = orl_moments_add(&m, &one, step * step);
    }
    return m;
}

/* Squares on a border are counted or not: an error of a few of a thousand rows. */
static void assert_moments(const struct orl_lit_scene *lit_scene, struct orl_vec3 place,
                           double radius)
{
    struct orl_surface_point surface_point;
    struct orl_footprint footprint;
    assert_true(orl_surface_point_find(lit_scene, orl_sub(place, lit_scene->geometry->center), up,
                                       1e-4, &surface_point));
    orl_footprint_make(&surface_point, 0.5, &footprint);
    const struct orl_moments m = orl_footprint_moments(&footprint, radius);
    const struct orl_moments b = brute_force(&footprint, radius);
    const double r3 = radius * radius * radius, r4 = r3 * radius, off = 2e-3;
    assert_true(fabs(m.area - orl_footprint_area(&footprint, radius)) < 1e-12);
    assert_true(fabs(m.area - b.area) < off * radius * radius);
    assert_true(fabs(m.x - b.x) < off * r3 && fabs(m.y - b.y) < off * r3);
    assert_true(fabs(m.xx - b.xx) < off * r4 && fabs(m.yy - b.yy) < off * r4);
    assert_true(fabs(m.xy - b.xy) < off * r4);
}

static void moments(void **state)
{
    struct orl_lit_scene *lit_scene =
        lit_scene_of(GREY "w polygon f 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0\n"
                          "w polygon on 0 0 12 2 0 0 3 3 0 3 3 3 2 0 3\n");
    (void)state;
    assert_moments(lit_scene, orl_v3(1, 1.5, 0), 0.5);
    assert_moments(lit_scene, orl_v3(0, 0, 0), 0.5);
    assert_moments(lit_scene, orl_v3(1, 0.01, 0), 0.3);
    assert_moments(lit_scene, orl_v3(1.9, 0.1, 0), 0.5);
    assert_moments(lit_scene, orl_v3(2.6, 1.3, 0), 0.5);
    const struct orl_moments disc = orl_disc_moments(2);
    assert_true(fabs(disc.area - 4 * ORL_PI) < 1e-12 && fabs(disc.xx - 4 * ORL_PI) < 1e-12);
    orl_lit_scene_free(lit_scene);
}

static void curves(void **state)
{
    struct orl_lit_scene *lit_scene = lit_scene_of(GREY "w sphere s 0 0 4 0 0 0 1\n"
                                                        "w cylinder c 0 0 7 3 0 0 3 0 2 .5\n");
    (void)state;
    assert_true(fabs(share_at(lit_scene, orl_v3(0, 0, 1), up, 0.3) - 1) < 1e-9);
    /* Beyond 28 degrees a sphere counts as another sheet: a cap of chord 0.484. */
    assert_true(fabs(share_at(lit_scene, orl_v3(0, 0, 1), up, 1) - 0.2341) < 0.01);
    /* Half a disc at the end of the tube. */
    assert_true(fabs(share_at(lit_scene, orl_v3(3.5, 0, 2), orl_v3(1, 0, 0), 0.1) - 0.5) < 0.01);
    orl_lit_scene_free(lit_scene);
}

static void joined(void **state)
{
    struct orl_lit_scene *lit_scene =
        lit_scene_of(GREY "w polygon f 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
                          "w polygon wall 0 0 12 2 0 0 2 2 0 2 2 3 2 0 3\n");
    const struct orl_vec3 moved = lit_scene->geometry->center;
    struct orl_surface_point surface_point;
    (void)state;
    assert_true(orl_surface_point_find(lit_scene, orl_sub(orl_v3(1.9, 1, 0), moved), up, 1e-4,
                                       &surface_point));
    assert_false(orl_surface_point_unoccluded(&surface_point, orl_sub(orl_v3(2.1, 1, 0), moved)));
    assert_true(orl_surface_point_unoccluded(&surface_point, orl_sub(orl_v3(1, 3, 0), moved)));
    orl_lit_scene_free(lit_scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_and_corners),
        cmocka_unit_test(walls),
        cmocka_unit_test(tiles_and_gaps),
        cmocka_unit_test(moments),
        cmocka_unit_test(curves),
        cmocka_unit_test(joined),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
