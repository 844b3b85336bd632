/*
 * Points outside a sealed building: in the open, in the room, and between nearly closed slats and
 * the pane behind them, from which hardly a ray leaves the scene.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include <oriel/base/thread_pool.h>

#include "support/scene_text.h"

enum { SLATS = 10, COLUMNS = 9, ROWS = 9, RAYS = 32 };

/* A room with a pane of 2 x 1 m; a frame .2 m deep around it; slats across the frame. */
static const char around[] =
    "void glow sky 0 0 4 1 1 1 0\nsky source d 0 0 4 0 0 1 360\n"
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 .9 .9 .9\n"
    "w polygon floor 0 0 12 -2 0 0 -2 4 0 2 4 0 2 0 0\n"
    "w polygon roof 0 0 12 -2 0 3 2 0 3 2 4 3 -2 4 3\n"
    "w polygon back 0 0 12 -2 4 0 -2 4 3 2 4 3 2 4 0\n"
    "w polygon left 0 0 12 -2 0 0 -2 0 3 -2 4 3 -2 4 0\n"
    "w polygon right 0 0 12 2 0 0 2 4 0 2 4 3 2 0 3\n"
    "w polygon front 0 0 30 -2 0 0 2 0 0 2 0 3 -2 0 3 -2 0 0 -1 0 1 -1 0 2 1 0 2 1 0 1 -1 0 1\n"
    "p polygon pane 0 0 12 -1 0 1 1 0 1 1 0 2 -1 0 2\n"
    "w polygon sill 0 0 12 -1 0 1 1 0 1 1 -.2 1 -1 -.2 1\n"
    "w polygon head 0 0 12 -1 0 2 -1 -.2 2 1 -.2 2 1 0 2\n"
    "w polygon west 0 0 12 -1 0 1 -1 -.2 1 -1 -.2 2 -1 0 2\n"
    "w polygon east 0 0 12 1 0 1 1 0 2 1 -.2 2 1 -.2 1\n";

/* Writes the scene; slats are .12 m wide, .1 m apart, 75 degrees from horizontal. */
static char *write_scene(void)
{
    const double y = 0.06 * cos(1.309), z = 0.06 * sin(1.309);
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    assert_non_null(f);
    fputs(around, f);
    for (int i = 0; i < SLATS; i++) {
        const double at = 1.05 + 0.1 * i;
        fprintf(f, "w polygon slat%d 0 0 12 -1 %g %g 1 %g %g 1 %g %g -1 %g %g\n", i, -0.2 - y,
                at - z, -0.2 - y, at - z, -0.2 + y, at + z, -0.2 + y, at + z);
    }
    assert_int_equal(fclose(f), 0);
    return text;
}

/* Returns true if some of many uniform directions leave the scene unobstructed. */
static bool sees_out(const struct orl_lit_scene *lit_scene, struct orl_vec3 point)
{
    for (int i = 0; i < RAYS; i++) {
        const double z = 1 - (2 * i + 1.0) / RAYS, s = sqrt(1 - z * z);
        const double phi = 2.399963229728653 * i;
        if (!orl_geometry_occluded(lit_scene->geometry, point,
                                   orl_v3(s * cos(phi), s * sin(phi), z), INFINITY))
            return true;
    }
    return false;
}

static void test_outside(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(2);
    char *const text = write_scene();
    struct orl_lit_scene *lit_scene = build_lit_scene(text, NULL, NULL, pool);
    const struct orl_vec3 center = lit_scene->geometry->center;
    unsigned blind = 0;
    (void)state;
    assert_int_equal(lit_scene->n_ports, 1);
    assert_false(lit_scene->open);
    assert_true(orl_lit_scene_is_outside(lit_scene, orl_sub(orl_v3(0, -3, 1), center)));
    for (int i = 0; i < COLUMNS; i++)
        for (int k = 0; k < ROWS; k++) {
            const double x = -0.8 + 0.2 * i, z = 1.1 + 0.1 * k;
            const struct orl_vec3 between = orl_sub(orl_v3(x, -0.08, z), center);
            blind += !sees_out(lit_scene, between);
            assert_true(orl_lit_scene_is_outside(lit_scene, between));
            assert_false(
                orl_lit_scene_is_outside(lit_scene, orl_sub(orl_v3(x, 0.05 + 0.4 * i, z), center)));
        }
    print_message("from %u of %d places between slats and pane no ray leaves the scene\n", blind,
                  COLUMNS * ROWS);
    assert_true(blind > 0);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_outside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
