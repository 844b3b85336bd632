/* Views out of a room, compared with angles and distances in closed form. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/annual/annual_report.h>

#define MATERIALS                                                                                  \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass g 0 0 3 .9 .9 .9\nvoid glass h 0 0 3 .9 .9 "    \
    ".9\nvoid trans t 0 0 7 .8 .8 .8 0 0 .7 .5\n"
/* 6 m wide, 6 deep, 3 high; the case adds its south side. */
#define ROOM                                                                                       \
    "w polygon floor 0 0 12 -3 0 0 3 0 0 3 6 0 -3 6 0\n"                                           \
    "w polygon north 0 0 12 -3 6 0 3 6 0 3 6 3 -3 6 3\n"                                           \
    "w polygon west 0 0 12 -3 0 0 -3 6 0 -3 6 3 -3 0 3\n"                                          \
    "w polygon east 0 0 12 3 0 0 3 6 0 3 6 3 3 0 3\n"
#define CEILING "w polygon ceiling 0 0 12 -3 0 3 3 0 3 3 6 3 -3 6 3\n"
#define LAWN "w polygon lawn 0 0 12 -500 -500 0 500 -500 0 500 -.01 0 -500 -.01 0\n"

enum { TEXT = 1 << 14 };

struct text {
    char bytes[TEXT];
    size_t length;
};

static void add_text(struct text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void add_text(struct text *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    text->length +=
        (size_t)vsnprintf(text->bytes + text->length, TEXT - text->length, format, args);
    va_end(args);
    assert_true(text->length < TEXT);
}

/* Adds a rectangle in the plane of y. */
static void add_upright(struct text *text, const char *modifier, double y, const double x[2],
                        const double z[2])
{
    static int number = 0;
    add_text(text, "%s polygon p%d 0 0 12 %g %g %g %g %g %g %g %g %g %g %g %g\n", modifier,
             number++, x[0], y, z[0], x[1], y, z[0], x[1], y, z[1], x[0], y, z[1]);
}

/* The south side with panes of glass, one above the other, and wall around them. */
struct pane {
    double low, high;
    const char *glass;
};
static void add_south(struct text *text, double width, const struct pane *panes, size_t n)
{
    const double half = width / 2;
    double below = 0;
    add_upright(text, "w", 0, (double[2]){-3, -half}, (double[2]){0, 3});
    add_upright(text, "w", 0, (double[2]){half, 3}, (double[2]){0, 3});
    for (size_t i = 0; i <= n; i++) {
        add_upright(text, "w", 0, (double[2]){-half, half},
                    (double[2]){below, i < n ? panes[i].low : 3});
        if (i < n)
            add_upright(text, panes[i].glass, 0, (double[2]){-half, half},
                        (double[2]){panes[i].low, panes[i].high});
        below = i < n ? panes[i].high : 3;
    }
}

static struct text room(double width, const struct pane *panes, size_t n)
{
    struct text text = {.length = 0};
    add_text(&text, MATERIALS ROOM CEILING LAWN);
    add_south(&text, width, panes, n);
    return text;
}

static const struct pane usual = {0.9, 2.4, "g"};

static double no_clock(void *ctx)
{
    (void)ctx;
    return 0;
}

static int try_look(const struct text *scene, const struct orl_view_out_request *view_out_request,
                    uint32_t pool, struct orl_view_out *ret_views, struct orl_error *err)
{
    static char scene_name[] = "scene.rad";
    static char *scene_names[] = {scene_name};
    static const char *const names[] = {scene_name};
    const struct orl_file contents[] = {{scene->bytes, scene->length, NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    atomic_bool cancel = false;
    const struct orl_run_env env = {
        .pool = orl_thread_pool_start(pool), .files = &files, .cancel = &cancel, .now_s = no_clock};
    const struct orl_annual_request request = {.scene_files = scene_names, .n_scene_files = 1};
    const int code = orl_view_out_compute(view_out_request, &request, &env, ret_views, err);
    orl_thread_pool_stop(env.pool);
    return code;
}

static struct orl_view_out view_out_at(const struct text *scene, double x, double y)
{
    static char name[] = "eye";
    struct orl_named_point eye = {name, {x, y, 1.2}};
    const struct orl_view_out_request view_out_request = {
        .points = &eye, .n_points = 1, .above_sensors = NAN};
    struct orl_view_out view = {0};
    struct orl_error err = {0};
    if (try_look(scene, &view_out_request, 2, &view, &err) < 0)
        fail_msg("%s", err.message);
    return view;
}

/* Asserts an angle; each edge is known to half a column. */
static void assert_angle(double found, double expected)
{
    if (!(fabs(found - expected) <= 0.2501))
        fail_msg("%.4f degrees for %.4f", found, expected);
}

static double between(double x, double y, double from, double to)
{
    return (atan2(to - x, y) - atan2(from - x, y)) / ORL_DEG_TO_RAD;
}

#define ALL (ORL_VIEW_SKY | ORL_VIEW_LANDSCAPE | ORL_VIEW_GROUND)

/* A view to the horizon: the angle is the window's, and determines the level. */
static void test_open_view(void **state)
{
    static const struct {
        double width, x, y;
        enum orl_view_level level;
    } cases[] = {{3.2, 0, 3, ORL_VIEW_HIGH},
                 {3, 0, 3, ORL_VIEW_MEDIUM},
                 {3, -2, 4, ORL_VIEW_MEDIUM},
                 {1, 1, 3, ORL_VIEW_MINIMUM},
                 {0.7, 0, 3, ORL_VIEW_NONE}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct text scene = room(cases[i].width, &usual, 1);
        const struct orl_view_out view = view_out_at(&scene, cases[i].x, cases[i].y);
        assert_angle(view.sight_angle_deg,
                     between(cases[i].x, cases[i].y, -cases[i].width / 2, cases[i].width / 2));
        assert_true(isinf(view.distance_m));
        assert_int_equal(view.layers, ALL);
        assert_int_equal(view.level, cases[i].level);
    }
}

/* A wall across the whole view at that distance, and no sky; 3.2 m of window are wide enough. */
static void test_distance(void **state)
{
    static const struct {
        double distance;
        enum orl_view_level level;
    } cases[] = {{60, ORL_VIEW_MEDIUM},
                 {20.01, ORL_VIEW_MEDIUM},
                 {19.9, ORL_VIEW_MINIMUM},
                 {6.01, ORL_VIEW_MINIMUM},
                 {5.9, ORL_VIEW_NONE}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double beyond = cases[i].distance + 5;
        struct text scene = room(3.2, &usual, 1);
        add_upright(&scene, "w", -cases[i].distance, (double[2]){-beyond, beyond},
                    (double[2]){0, beyond});
        const struct orl_view_out view = view_out_at(&scene, 0.7, 3);
        assert_true(fabs(view.distance_m - cases[i].distance) < 1e-4 * cases[i].distance);
        assert_true((view.layers & ORL_VIEW_LANDSCAPE) && !(view.layers & ORL_VIEW_SKY));
        /* From 1.2 m over the sill of 0.9 m, 3 m away: the lawn from 9 m on. */
        assert_int_equal((view.layers & ORL_VIEW_GROUND) != 0, cases[i].distance > 10);
        assert_int_equal(view.level, cases[i].level);
    }
}

/* A major layer fills more than half of the view, and is not below the eye. */
static void test_what_is_major(void **state)
{
    const double half = 1.6, y = 3;
    (void)state;
    for (int share = 40; share <= 60; share += 20) {
        struct text scene = room(2 * half, &usual, 1);
        const double from = atan2(half, y), to = from - 2 * from * share / 100;
        add_upright(&scene, "w", -30, (double[2]){-100, -(y + 30) * tan(to)}, (double[2]){0, 500});
        const struct orl_view_out view = view_out_at(&scene, 0, y);
        assert_true(share < 50 ? isinf(view.distance_m) : fabs(view.distance_m - 30) < 0.01);
        assert_angle(view.sight_angle_deg, between(0, y, -half, half));
    }
    struct text scene = room(2 * half, &usual, 1);
    add_upright(&scene, "w", -30, (double[2]){-500, 500}, (double[2]){0, 1.1});
    assert_true(isinf(view_out_at(&scene, 0, y).distance_m));
}

/* Sky alone is no view, and neither is a roof light. */
static void test_sky_alone(void **state)
{
    const struct pane high = {1.8, 2.4, "g"};
    const struct text scene = room(3.2, &high, 1);
    const struct orl_view_out view = view_out_at(&scene, 0, 3);
    struct text roof = {.length = 0};
    (void)state;
    assert_int_equal(view.layers, ORL_VIEW_SKY);
    assert_true(view.sight_angle_deg == 0 && view.level == ORL_VIEW_NONE);
    add_text(&roof, MATERIALS ROOM "g polygon ceiling 0 0 12 -3 0 3 3 0 3 3 6 3 -3 6 3\n");
    add_south(&roof, 1, NULL, 0);
    const struct orl_view_out up = view_out_at(&roof, 0, 3);
    assert_int_equal(up.layers, ORL_VIEW_SKY);
    assert_true(up.sight_angle_deg == 0 && up.level == ORL_VIEW_NONE);
}

/* The lower pane shows lawn and horizon, the upper one sky: they are one opening with a bar between
 * them, and two with a wall. */
static void test_bars(void **state)
{
    static const double bars[] = {0.2, 0.4};
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct pane panes[2] = {{0.5, 1.22, "g"}, {1.22 + bars[i], 2.6, "g"}};
        struct text scene = room(3.2, panes, 2);
        add_upright(&scene, "w", -60, (double[2]){-500, 500}, (double[2]){0, 5});
        const struct orl_view_out view = view_out_at(&scene, 0, 3);
        assert_int_equal(view.level, i == 0 ? ORL_VIEW_HIGH : ORL_VIEW_MEDIUM);
        assert_int_equal((view.layers & ORL_VIEW_SKY) != 0, i == 0);
    }
}

/* Paper is no opening, and neither is a pane behind a shutter or one that is not named. */
static void test_what_is_no_opening(void **state)
{
    const struct pane paper = {0.9, 2.4, "t"};
    const struct text papered = room(3.2, &paper, 1);
    struct text shut = room(3.2, &usual, 1);
    (void)state;
    assert_int_equal(view_out_at(&papered, 0, 3).layers, 0);
    add_upright(&shut, "w", -0.2, (double[2]){-500, 500}, (double[2]){-1, 500});
    assert_int_equal(view_out_at(&shut, 0, 3).layers, 0);
}

static void test_names(void **state)
{
    static char h[] = "h", lawn[] = "lawn", nothing[] = "nothing", name[] = "eye";
    char *openings[] = {h}, *ground[] = {lawn}, *bad[] = {nothing};
    const struct pane panes[2] = {{0.9, 1.3, "g"}, {1.7, 2.4, "h"}};
    const struct text scene = room(3.2, panes, 2);
    struct orl_named_point eye = {name, {0, 3, 1.2}};
    struct orl_view_out_request view_out_request = {
        .points = &eye, .n_points = 1, .above_sensors = NAN, .openings = openings, .n_openings = 1};
    struct orl_view_out view = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(try_look(&scene, &view_out_request, 1, &view, &err), 0);
    assert_int_equal(view.layers, ORL_VIEW_SKY);
    view_out_request.n_openings = 0;
    view_out_request.ground = ground;
    view_out_request.n_ground = 1;
    assert_int_equal(try_look(&scene, &view_out_request, 1, &view, &err), 0);
    assert_int_equal(view.layers, ALL);
    view_out_request.ground = bad;
    assert_int_equal(try_look(&scene, &view_out_request, 1, &view, &err), ORL_ERR_NOT_FOUND);
    assert_non_null(strstr(err.message, "nothing"));
    view_out_request.n_points = ORL_VIEW_OUT_MOST_POINTS + 1;
    assert_int_equal(try_look(&scene, &view_out_request, 1, &view, &err), ORL_ERR_LIMIT);
}

/* Hills that are not named as ground are landscape. */
static void test_what_is_ground(void **state)
{
    struct text scene = {.length = 0};
    (void)state;
    add_text(&scene, MATERIALS ROOM CEILING);
    add_south(&scene, 3.2, &usual, 1);
    add_text(&scene, "w polygon hill 0 0 12 -500 -500 90 500 -500 90 500 -.01 -.1 -500 -.01 -.1\n");
    const struct orl_view_out view = view_out_at(&scene, 0, 3);
    assert_int_equal(view.layers & ORL_VIEW_GROUND, 0);
    assert_int_equal(view.layers & ORL_VIEW_LANDSCAPE, ORL_VIEW_LANDSCAPE);
}

/* The bytes are equal for any number of threads. */
static void test_pool_sizes(void **state)
{
    static char name[] = "eye";
    struct orl_named_point eyes[5] = {{0}};
    const struct text scene = room(3.2, &usual, 1);
    const struct orl_view_out_request view_out_request = {
        .points = eyes, .n_points = 5, .above_sensors = NAN};
    struct orl_view_out one[5], three[5];
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 5; i++)
        eyes[i] = (struct orl_named_point){name, {i - 2.0, 1 + i, 1.2}};
    assert_int_equal(try_look(&scene, &view_out_request, 1, one, &err), 0);
    assert_int_equal(try_look(&scene, &view_out_request, 3, three, &err), 0);
    for (int i = 0; i < 5; i++) {
        assert_true(one[i].sight_angle_deg == three[i].sight_angle_deg);
        assert_true(one[i].distance_m == three[i].distance_m);
        assert_int_equal(one[i].layers, three[i].layers);
    }
}

/* Exactly 75 % of the area is enough. */
static void test_shares(void **state)
{
    static const enum orl_view_level levels[4] = {ORL_VIEW_HIGH, ORL_VIEW_MEDIUM, ORL_VIEW_MEDIUM,
                                                  ORL_VIEW_NONE};
    struct orl_annual_grid grid = {NULL, 0, 4};
    double area[4] = {1, 1, 1, 1};
    struct orl_view_out *views = calloc(4, sizeof *views);
    struct orl_annual_report report = {.grids = &grid, .n_grids = 1, .n_sensors = 4, .area = area};
    const struct orl_report_request report_request = {.view_out = {.above_sensors = 0.4}};
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 4; i++)
        views[i].level = levels[i];
    assert_int_equal(orl_annual_report_add_views(&report_request, views, 4, &report, &err), 0);
    assert_true(report.view_shares[0].percent[0] == 75 && report.view_shares[0].percent[1] == 75 &&
                report.view_shares[0].percent[2] == 25);
    assert_int_equal(report.view_shares[0].level, ORL_VIEW_MEDIUM);
    free(report.views);
    free(report.view_shares);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_view),
        cmocka_unit_test(test_distance),
        cmocka_unit_test(test_what_is_major),
        cmocka_unit_test(test_sky_alone),
        cmocka_unit_test(test_bars),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_what_is_no_opening),
        cmocka_unit_test(test_what_is_ground),
        cmocka_unit_test(test_pool_sizes),
        cmocka_unit_test(test_shares),
    };
    return cmocka_run_group_tests_name("view_out", tests, NULL, NULL);
}
