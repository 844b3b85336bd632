/*
 * Sensors outdoors, in solids, in other rooms and below floors give warnings with their numbers.
 * Sensors on surfaces, in rooms with inner panes, in open models and on terrain do not. The check
 * has a limit of rays, can be cancelled, and does not depend on the number of threads.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/thread_pool.h>

#include "light/enclosures.h"
#include "run/diagnostics/diagnostics.h"
#include "support/scene_text.h"

/* A room of 4 x 4 x 3 m, its front wall with a hole of 2 x 1 m, the pane in the hole, a ground
 * below, and a box of 0.5 x 0.5 x 2 m in a corner. */
#define LOOK "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 .9 .9 .9\n"
#define SHELL                                                                                      \
    "w polygon floor 0 0 12 -2 0 0 -2 4 0 2 4 0 2 0 0\n"                                           \
    "w polygon roof 0 0 12 -2 0 3 2 0 3 2 4 3 -2 4 3\n"                                            \
    "w polygon back 0 0 12 -2 4 0 -2 4 3 2 4 3 2 4 0\n"                                            \
    "w polygon left 0 0 12 -2 0 0 -2 0 3 -2 4 3 -2 4 0\n"                                          \
    "w polygon right 0 0 12 2 0 0 2 4 0 2 4 3 2 0 3\n"
#define FRONT                                                                                      \
    "w polygon front 0 0 30 -2 0 0 2 0 0 2 0 3 -2 0 3 -2 0 0 -1 0 1 -1 0 2 1 0 2 1 0 1 -1 0 1\n"
#define PANE "p polygon pane 0 0 12 -1 0 1 1 0 1 1 0 2 -1 0 2\n"
#define INNER_PANE "p polygon inner 0 0 12 -1 .02 1 1 .02 1 1 .02 2 -1 .02 2\n"
#define GROUND "w ring ground 0 0 8 0 0 -.2 0 0 1 0 100\n"
#define BOX "!genbox w box .5 .5 2 | xform -t 1.4 3.4 0\n"
/* A second room of the same size beyond the right wall, with a pane of its own. */
#define SECOND                                                                                     \
    "w polygon floor2 0 0 12 2 0 0 2 4 0 6 4 0 6 0 0\n"                                            \
    "w polygon roof2 0 0 12 2 0 3 6 0 3 6 4 3 2 4 3\n"                                             \
    "w polygon back2 0 0 12 2 4 0 2 4 3 6 4 3 6 4 0\n"                                             \
    "w polygon right2 0 0 12 6 0 0 6 4 0 6 4 3 6 0 3\n"                                            \
    "w polygon front2 0 0 30 2 0 0 6 0 0 6 0 3 2 0 3 2 0 0 3 0 1 3 0 2 5 0 2 5 0 1 3 0 1\n"        \
    "p polygon pane2 0 0 12 3 0 1 5 0 1 5 0 2 3 0 2\n"
static const char room[] = LOOK SHELL FRONT PANE GROUND BOX;

enum { MOST = 128 };

struct told {
    char text[4096];
    size_t count;
    struct orl_sensor sensors[MOST];
    size_t n;
};

static void warn(void *ctx, const char *text)
{
    struct told *told = ctx;
    const size_t at = strlen(told->text);
    snprintf(told->text + at, sizeof told->text - at, "%s\n", text);
    told->count++;
}

static void add_sensor(struct told *told, double x, double y, double z, struct orl_vec3 direction)
{
    assert_true(told->n < MOST);
    told->sensors[told->n++] = (struct orl_sensor){orl_v3(x, y, z), direction};
}

/* Returns rows of sensors that face up, half a metre apart. */
static struct told grid(double x, double y, double z, int columns, int rows)
{
    struct told told = {.n = 0};
    for (int i = 0; i < columns * rows; i++)
        add_sensor(&told, x + 0.5 * (i % columns), y + 0.5 * (double)(i / columns), z,
                   orl_v3(0, 0, 1));
    return told;
}

/* Checks the ranges with one thread and with three, which must agree. */
static void check_ranges(struct told *told, const char *scene, struct orl_sensor_check *check)
{
    struct told again = {.n = 0};
    struct orl_thread_pool *pool = orl_thread_pool_start(3);
    struct orl_lit_scene *lit_scene = build_lit_scene(scene, NULL, NULL, pool);
    check->scene = lit_scene->scene;
    check->sensors = told->sensors;
    check->warn = warn;
    check->ctx = &again;
    check->pool = pool;
    assert_int_equal(orl_run_check_sensor_spaces(check), 0);
    check->ctx = told;
    check->pool = NULL;
    assert_int_equal(orl_run_check_sensor_spaces(check), 0);
    assert_string_equal(again.text, told->text);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

static struct orl_sensor_check check_spaces(struct told *told, const char *scene)
{
    const struct orl_sensor_range range = {"desks", 0, told->n};
    struct orl_sensor_check check = {.ranges = &range, .n_ranges = 1};
    check_ranges(told, scene, &check);
    check.ranges = NULL;
    return check;
}

static void assert_silent(struct told told, const char *scene)
{
    check_spaces(&told, scene);
    assert_string_equal(told.text, "");
}

static void assert_warns(struct told told, const char *scene, const char *wanted)
{
    check_spaces(&told, scene);
    if (told.count != 1 || !strstr(told.text, wanted))
        fail_msg("expected \"%s\" alone in:\n%s", wanted, told.text);
}

static void test_right_places(void **state)
{
    struct told on_walls = {.n = 0};
    (void)state;
    assert_silent(grid(-1.7, 0.3, 0.8, 6, 7), room);
    assert_silent(grid(-1.7, 0.3, 0, 6, 7), room);    /* on the floor */
    assert_silent(grid(-2, 0, 0.8, 6, 7), room);      /* some in the planes of walls */
    assert_silent(grid(1.15, 3.15, 2, 2, 2), room);   /* one on the box */
    assert_silent(grid(-1.7, -10, 0.8, 6, 7), room);  /* all outdoors */
    assert_silent(grid(-1.7, -10, -0.2, 6, 7), room); /* on the ground */
    for (int i = 0; i < 12; i++)
        add_sensor(&on_walls, -2, 0.3 * (i + 1), 1, orl_v3(1, 0, 0));
    assert_silent(on_walls, room);
}

static void test_misplaced(void **state)
{
    struct told told = grid(-1.7, 0.3, 0.8, 6, 7);
    const size_t n = told.n;
    (void)state;
    add_sensor(&told, -2.1, 2, 0.8, orl_v3(0, 0, 1));
    add_sensor(&told, 0, 2, -0.1, orl_v3(0, 0, 1));
    assert_warns(told, room,
                 "grid 'desks': 2 of 44 sensors lie outdoors, and the others in a closed space: "
                 "numbers 43-44 (from 1), the first at (-2.1, 2, 0.8) behind 'left' (");
    told.n = n;
    add_sensor(&told, 1.6, 3.6, 0.8, orl_v3(0, 0, 1));
    assert_warns(told, room,
                 "1 of 43 sensors lies in closed spaces without windows, such as a "
                 "solid or a wall, and the others do not: number 43 (from 1)");
    assert_warns(grid(-1.7, 0.3, -0.1, 6, 7), room,
                 "42 of 42 sensors lie just below the floor of a room: numbers 1-42 (from 1), "
                 "the first at (-1.7, 0.3, -0.1) behind 'floor' (");
}

static void test_rooms(void **state)
{
    static const char rooms[] = LOOK SHELL FRONT PANE SECOND GROUND;
    struct told told = grid(-1.7, 0.3, 0.8, 6, 7);
    (void)state;
    add_sensor(&told, 3, 2, 0.8, orl_v3(0, 0, 1));
    assert_warns(told, rooms,
                 "1 of 43 sensors lies in a different closed space from the others: "
                 "number 43 (from 1), the first at (3, 2, 0.8) behind 'right' (");
    assert_silent(grid(-1.7, 0.3, 0.8, 15, 7), rooms); /* in both rooms, on purpose */
}

/* With panes but no walls, nothing determines the outdoors. */
static void test_open_models(void **state)
{
    static const char panes[] = LOOK SHELL FRONT PANE INNER_PANE GROUND;
    static const char no_pane[] = LOOK SHELL FRONT GROUND, no_front[] = LOOK SHELL PANE GROUND BOX;
    struct told told = grid(-1.7, 0.3, 0.8, 6, 7);
    const size_t n = told.n;
    (void)state;
    add_sensor(&told, 0, 0.01, 1.5, orl_v3(0, -1, 0));
    assert_silent(told, panes); /* between the panes */
    told.n = n;
    add_sensor(&told, 0, -3, 0.8, orl_v3(0, 0, 1));
    assert_warns(told, no_pane, "number 43 (from 1)"); /* in front of an unglazed window */
    assert_silent(told, no_front);
    add_sensor(&told, 1.6, 3.6, 0.8, orl_v3(0, 0, 1));
    assert_warns(told, no_front, "number 44 (from 1)"); /* within the box */
}

/* Hills of 1 m: no straight line over them connects sensors in the valleys. */
static void test_terrain(void **state)
{
    char text[8192] = LOOK;
    struct told told = {.n = 0};
    (void)state;
    for (int i = 0; i < 20; i++) {
        const size_t at = strlen(text);
        const int low = i % 2, high = 1 - low;
        snprintf(text + at, sizeof text - at,
                 "w polygon hill%d 0 0 12 %d -20 %d %d -20 %d %d 20 %d %d 20 %d\n", i, i, low,
                 i + 1, high, i + 1, high, i, low);
        add_sensor(&told, i + 0.4, 3, 0.55 + (low ? 0.1 : -0.1), orl_v3(0, 0, 1));
    }
    assert_silent(told, text);
}

/* Long lists of numbers are shortened. */
static void test_numbers(void **state)
{
    struct told told = {.n = 0};
    (void)state;
    for (int i = 0; i < 100; i++)
        add_sensor(&told, i % 5 == 4 ? -3 : -1.5, 0.1 + 0.03 * i, 0.8, orl_v3(0, 0, 1));
    assert_warns(told, room,
                 "20 of 100 sensors lie outdoors, and the others in a closed space: "
                 "numbers 5, 10, 15, 20, 25, 30, 35, 40 and 12 more (from 1)");
}

/* ---- Limits ---------------------------------------------------------------------------------- */

/* A room above the sensors, with a floor of two triangles: each is explored once, not at each
 * change between them. */
static void test_alternating_facets(void **state)
{
    static const char raised[] = LOOK "w polygon floor1 0 0 9 0 0 1 10 0 1 10 10 1\n"
                                      "w polygon floor2 0 0 9 0 0 1 10 10 1 0 10 1\n"
                                      "w polygon roof 0 0 12 0 0 5 0 10 5 10 10 5 10 0 5\n"
                                      "w polygon west 0 0 12 0 0 1 0 10 1 0 10 5 0 0 5\n"
                                      "w polygon east 0 0 12 10 0 1 10 0 5 10 10 5 10 10 1\n"
                                      "p polygon south 0 0 12 0 0 1 0 0 5 10 0 5 10 0 1\n"
                                      "w polygon north 0 0 12 0 10 1 10 10 1 10 10 5 0 10 5\n";
    struct told told = {.n = 0};
    (void)state;
    for (int i = 0; i < MOST; i++) {
        const double across = 0.05 * i;
        add_sensor(&told, i % 2 ? across + 1 : across + 2, i % 2 ? across + 2 : across + 1, 0.8,
                   orl_v3(0, 0, 1));
    }
    const uint64_t rays = check_spaces(&told, raised).rays;
    assert_non_null(strstr(told.text, "128 of 128 sensors lie just below the floor"));
    assert_in_range(rays, MOST, 2 * MOST + 3 * 512);
}

enum { CELLS = 6, GRIDS = 40 };

/* Adds cells of 1 m, closed by walls and a roof of glass, each with a sensor. */
static void add_cells(struct told *told, char *text, size_t size)
{
    size_t at = (size_t)snprintf(text, size,
                                 LOOK "w polygon floor 0 0 12 0 0 0 0 %d 0 %d %d 0 %d 0 0\n"
                                      "p polygon roof 0 0 12 0 0 1 %d 0 1 %d %d 1 0 %d 1\n",
                                 CELLS, CELLS, CELLS, CELLS, CELLS, CELLS, CELLS, CELLS);
    for (int i = 0; i <= CELLS; i++)
        at += (size_t)snprintf(text + at, size - at,
                               "w polygon x%d 0 0 12 %d 0 0 %d %d 0 %d %d 1 %d 0 1\n"
                               "w polygon y%d 0 0 12 0 %d 0 %d %d 0 %d %d 1 0 %d 1\n",
                               i, i, i, CELLS, i, CELLS, i, i, i, CELLS, i, CELLS, i, i);
    for (int i = 0; i < CELLS * CELLS; i++)
        add_sensor(told, i % CELLS + 0.5, (double)(i / CELLS) + 0.5, 0.5, orl_v3(0, 0, 1));
}

/* One limit for all grids; grids that reach it are named, and later ones are still checked. */
static void test_limit_of_rays(void **state)
{
    enum { RAYS = 20000, MOST_OF_A_GRID = 4096 + 16 * CELLS * CELLS };
    char text[8192];
    struct told told = {.n = 0};
    struct orl_sensor_range ranges[GRIDS + 1];
    struct orl_sensor_check limited = {.ranges = ranges, .n_ranges = GRIDS + 1, .most_rays = RAYS};
    (void)state;
    add_cells(&told, text, sizeof text);
    for (int i = 0; i < GRIDS; i++)
        ranges[i] = (struct orl_sensor_range){"cells", 0, told.n};
    ranges[GRIDS] = (struct orl_sensor_range){"last", told.n, 41};
    for (int i = 0; i < 40; i++)
        add_sensor(&told, 0.1 + 0.02 * i, 0.4, 0.5, orl_v3(0, 0, 1));
    add_sensor(&told, -3, 0.5, 0.5, orl_v3(0, 0, 1));
    check_ranges(&told, text, &limited);
    assert_in_range(limited.rays, RAYS, RAYS + (GRIDS + 2) * MOST_OF_A_GRID);
    assert_int_equal(told.count, 2);
    assert_non_null(strstr(told.text, "grid 'last': 1 of 41 sensors lies outdoors"));
    assert_non_null(strstr(told.text, "in the grids 'cells', 'cells', 'cells', 'cells', 'cells' "
                                      "and "));
}

static void test_cancellation(void **state)
{
    const atomic_bool cancel = true;
    struct told told = grid(-1.7, 0.3, -0.1, 6, 7);
    const struct orl_sensor_range range = {"desks", 0, told.n};
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene = build_lit_scene(room, NULL, NULL, pool);
    struct orl_sensor_check cancelled = {.scene = lit_scene->scene,
                                         .sensors = told.sensors,
                                         .ranges = &range,
                                         .n_ranges = 1,
                                         .pool = pool,
                                         .warn = warn,
                                         .ctx = &told};
    struct orl_ray_budget budget = {.pool = pool, .left = 1000000};
    (void)state;
    orl_thread_pool_set_cancel(pool, &cancel);
    assert_int_equal(orl_run_check_sensor_spaces(&cancelled), ORL_ERR_CANCELLED);
    assert_int_equal(cancelled.rays, 0);
    assert_int_equal(told.count, 0);
    while (orl_ray_budget_take(&budget))
        assert_in_range(budget.traced, 1, 1024);
    assert_true(budget.cancelled);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_right_places),
        cmocka_unit_test(test_misplaced),
        cmocka_unit_test(test_rooms),
        cmocka_unit_test(test_open_models),
        cmocka_unit_test(test_terrain),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_alternating_facets),
        cmocka_unit_test(test_limit_of_rays),
        cmocka_unit_test(test_cancellation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
