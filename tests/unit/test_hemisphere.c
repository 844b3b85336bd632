/* Hemispheres of rays at a place: their mean radiance and its error, and distances. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "render/technique/photon_maps.h"
#include "support/room.h"

static struct orl_lit_scene *make_lit_scene(const char *text)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene = build_lit_scene(text, NULL, NULL, pool);
    orl_thread_pool_stop(pool);
    return lit_scene;
}

/* Sets up gathering without photon maps. */
static void init(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                 struct orl_search *search)
{
    const struct orl_photon_map *const maps[ORL_MAP_KINDS] = {NULL};
    assert_int_equal(
        orl_gather_init(gather, lit_scene, &orl_indirect_gathered, maps, NULL, 1, NULL, search), 0);
}

/* ---- A window -------------------------------------------------------------------------------- */

enum { ROWS = 6, COLUMNS = 20, TIMES = 400 };

/* A square of 60 cm at 2 m, so bright that it gives most of the light, in a dim sky. */
static const char window[] =
    "void glow dim 0 0 4 .005 .005 .005 0\ndim source sky 0 0 4 0 0 1 180\n"
    "void glow g 0 0 4 1 1 1 0\n"
    "g polygon window 0 0 12 .3 -.3 2 .3 .3 2 .9 .3 2 .9 -.3 2\n";

/* Returns the form factor of the rectangle from 0 to x and 0 to y above a place, at height 1. */
static double corner_factor(double x, double y)
{
    const double a = sqrt(1 + x * x), b = sqrt(1 + y * y);
    return (x / a * atan(y / a) + y / b * atan(x / b)) / (2 * ORL_PI);
}

/*
 * Adaptive rays, sent where neighbours differ, keep the mean. Their error is far below that of as
 * many random rays, which have almost three times as much. The estimated error is right within the
 * scatter of the squares.
 */
static void test_window(void **state)
{
    struct orl_lit_scene *lit_scene = make_lit_scene(window);
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_gather gather;
    const double factor = 2 * (corner_factor(0.45, 0.15) - corner_factor(0.15, 0.15));
    const double truth = ORL_PI * (factor + (1 - factor) * 0.005);
    const struct orl_shading_point place = {.point = orl_neg(lit_scene->geometry->center),
                                            .normal = orl_v3(0, 0, 1)};
    double sum = 0, squares = 0, stated = 0;
    (void)state;
    assert_non_null(search);
    init(&gather, lit_scene, search);
    for (uint64_t i = 0; i < TIMES; i++) {
        struct orl_random random = orl_random_stream(1, ORL_PURPOSE_RECORD, i);
        const struct orl_hemisphere h =
            orl_gather_hemisphere(&gather, &place, ROWS, COLUMNS, NULL, &random, search);
        const double off = orl_luma(h.irradiance) - truth;
        sum += off / TIMES;
        squares += off * off / TIMES;
        stated += h.ray_error / TIMES;
    }
    const double rays = (double)search->health.rays / TIMES;
    const double by_chance = ORL_PI * 0.995 * sqrt(factor * (1 - factor) / rays);
    print_message("%.0f rays: off by %.2f %% (bias %.2f, said %.2f), %.2f of what chance does\n",
                  rays, 100 * sqrt(squares) / truth, 100 * sum / truth, 100 * stated / truth,
                  sqrt(squares) / by_chance);
    assert_true(fabs(sum) < 4 * sqrt(squares / TIMES));
    assert_true(squares < stated * stated * (1 + 4 * sqrt(2.0 / TIMES)));
    assert_true(sqrt(squares) < 0.5 * by_chance);
    orl_gather_done(&gather);
    orl_lit_scene_free(lit_scene);
    free(search);
}

/* ---- A facade -------------------------------------------------------------------------------- */

/*
 * From a place before a room some rays go in through the pane. Their distance from the pane to a
 * wall is not the distance of anything from the place.
 */
static void test_facade(void **state)
{
    struct orl_lit_scene *lit_scene =
        make_lit_scene(ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE);
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_gather gather;
    const struct orl_shading_point place = {
        .point = orl_sub(orl_v3(2, -8, 1.5), lit_scene->geometry->center),
        .normal = orl_v3(0, 1, 0),
        .outside = true};
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_RECORD, 0);
    (void)state;
    assert_non_null(search);
    init(&gather, lit_scene, search);
    const struct orl_hemisphere h =
        orl_gather_hemisphere(&gather, &place, 3 * ROWS, 2 * COLUMNS, NULL, &random, search);
    assert_true(search->health.rays > 10); /* some rays went in */
    assert_true(h.least_distance >= 8);
    orl_gather_done(&gather);
    orl_lit_scene_free(lit_scene);
    free(search);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_window),
        cmocka_unit_test(test_facade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
