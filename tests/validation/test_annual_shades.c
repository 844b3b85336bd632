/* Annual runs with shades, compared with those of scenes that contain the shade's state. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cli.h"
#include "support/extent.h"
#include "support/year.h"

enum { SAMPLES = 64, TEXT = 8192 };

/* A room with a window in the south and one in the north, and more materials for them. Its west
 * wall is separate, since it may have a third window. */
#define SHELL WALLS "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
#define WEST                                                                                       \
    "w polygon west 0 0 30 0 0 0 0 5 0 0 5 3 0 0 3 0 0 0 0 2 1 0 3 1 0 3 2 0 2 2 0 2 1\n"          \
    "clear polygon side 0 0 12 0 2 1 0 2 2 0 3 2 0 3 1\n"
#define WALLS                                                                                      \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid plastic e 0 0 5 .2 .2 .2 0 0\n"                       \
    "void glass clear 0 0 3 .9 .9 .9\nvoid glass tinted 0 0 3 .3 .3 .3\n"                          \
    "void glass dim 0 0 3 .6 .6 .6\n"                                                              \
    "void plastic black 0 0 5 0 0 0 0 0\n"                                                         \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"                                           \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 30 0 5 0 4 5 0 4 5 3 0 5 3 0 5 0 1 5 1 1 5 2.5 3 5 2.5 3 5 1 1 5 1\n"     \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"                                                          \
    "e polygon ground 0 0 12 -40 -40 -.3 40 -40 -.3 40 40 -.3 -40 40 -.3\n"
#define SOUTH(m) m " polygon front 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
#define NORTH(m) m " polygon back 0 0 12 1 5 1 3 5 1 3 5 2.5 1 5 2.5\n"
/* A facade north of the room that reflects the sun into its north window. */
#define FACADE                                                                                     \
    "void mirror m 0 0 3 .6 .6 .6\n"                                                               \
    "m polygon facade 0 0 12 -8 14 -.2 12 14 -.2 12 14 20 -8 14 20\n"
static const char room[] = SHELL SOUTH("clear") NORTH("clear");

static const struct year_site izmir = {38.42, 27.14, 2};
static const struct orl_sensor sensors[] = {
    {{2, .6, .8}, {0, 0, 1}}, {{1, 4, .8}, {0, 0, 1}}, {{2, 2.5, 1.2}, {0, -1, 0}}};
enum { SENSORS = 3 };

static char dim_name[] = "dim", front_name[] = "front", back_name[] = "back",
            clear_name[] = "clear", tinted_name[] = "tinted", open_word[] = "open",
            shut_word[] = "shut", south_word[] = "south", north_word[] = "north",
            blind_file[] = "blind.rad";
static char *front_list[] = {front_name}, *back_list[] = {back_name}, *blind_files[] = {blind_file};

static struct year_run usual(const char *scene)
{
    return (struct year_run){.scene = scene,
                             .site = izmir,
                             .sensors = sensors,
                             .n_sensors = SENSORS,
                             .samples = SAMPLES,
                             .photons = (uint32_t)extent(5000, 0),
                             .seed = 5};
}

static void assert_same(const float *a, const float *b, const struct orl_annual_result *year)
{
    assert_memory_equal(a, b, year->n_sensors * year->n_columns * sizeof *a);
}

/* A state that changes nothing gives the same bytes as no group. */
static void test_one_state(void **state)
{
    struct orl_shade_state states[] = {{.name = open_word}};
    const struct orl_window_group group = {
        .name = south_word, .windows = front_list, .n_windows = 1, .states = states, .n_states = 1};
    struct year_run run = usual(room);
    struct orl_annual_result bare = year_run(&run);
    (void)state;
    run.groups = &group;
    run.n_groups = 1;
    struct orl_annual_result grouped = year_run(&run);
    assert_int_equal(grouped.n_columns, bare.n_columns);
    assert_int_equal(grouped.n_runs, 1);
    assert_same(grouped.total, bare.total, &bare);
    assert_same(grouped.direct, bare.direct, &bare);
    assert_same(grouped.se, bare.se, &bare);
    orl_annual_done(&bare);
    orl_annual_done(&grouped);
}

/* Two groups of two states each, all four pairs in turn. Each hour equals, to the byte, that of the
 * scene written with the pair; direct light is that of the open states. */
static void test_two_groups(void **state)
{
    static const char *const written[4] = {room, SHELL SOUTH("tinted") NORTH("clear"),
                                           SHELL SOUTH("clear") NORTH("black"),
                                           SHELL SOUTH("tinted") NORTH("black")};
    struct orl_shade_state south[] = {{.name = open_word},
                                      {.name = shut_word, .material = tinted_name}};
    struct orl_shade_state north[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    unsigned char series[2][48];
    struct orl_window_group groups[] = {{.name = south_word,
                                         .windows = front_list,
                                         .n_windows = 1,
                                         .states = south,
                                         .n_states = 2,
                                         .series = series[0],
                                         .n_series = 48},
                                        {.name = north_word,
                                         .windows = back_list,
                                         .n_windows = 1,
                                         .states = north,
                                         .n_states = 2,
                                         .series = series[1],
                                         .n_series = 48}};
    struct year_run run = usual(room);
    struct orl_annual_result alone[4];
    (void)state;
    for (unsigned i = 0; i < 48; i++) {
        series[0][i] = i & 1;
        series[1][i] = i >> 1 & 1;
    }
    for (int i = 0; i < 4; i++) {
        run.scene = written[i];
        alone[i] = year_run(&run);
    }
    run.scene = room;
    run.groups = groups;
    run.n_groups = 2;
    struct orl_annual_result all = year_run(&run);
    assert_int_equal(all.n_runs, 4);
    assert_same(all.direct, alone[0].direct, &all);
    for (size_t c = 0; c < all.n_columns; c++) {
        const struct orl_annual_result *one = &alone[all.step_of_column[c] & 3];
        for (size_t at = c; at < SENSORS * all.n_columns; at += all.n_columns) {
            assert_true(all.total[at] == one->total[at]);
            assert_true(all.se[at] == one->se[at]);
        }
    }
    for (int i = 0; i < 4; i++)
        orl_annual_done(&alone[i]);
    orl_annual_done(&all);
}

/* A blind outside, from a state's file, from 10 to 14 h in March, counts as if it were in the
 * scene. */
static void test_geometry(void **state)
{
    static const char blind[] = "w polygon slat 0 0 12 .5 -.3 2.5 3.5 -.3 2.5 3.5 0 2.5 .5 0 2.5\n";
    struct orl_shade_state states[] = {{.name = open_word},
                                       {.name = shut_word, .files = blind_files, .n_files = 1}};
    struct orl_shade_span span = {3, 3, 10, 14, 1};
    const struct orl_window_group group = {
        .name = south_word, .states = states, .n_states = 2, .spans = &span, .n_spans = 1};
    char text[TEXT];
    struct year_run run = usual(room);
    (void)state;
    snprintf(text, sizeof text, "%s%s", room, blind);
    struct orl_annual_result bare = year_run(&run);
    run.scene = text;
    struct orl_annual_result shaded = year_run(&run);
    run.scene = room;
    run.resource_name = blind_file;
    run.resource_text = blind;
    run.groups = &group;
    run.n_groups = 1;
    struct orl_annual_result both = year_run(&run);
    size_t within = 0;
    for (size_t c = 0; c < both.n_columns; c++) {
        const struct orl_annual_step *step = &both.steps[both.step_of_column[c]];
        const bool shut = step->month == 3 && step->hour >= 10 && step->hour < 14;
        assert_int_equal(both.states[both.step_of_column[c]], shut);
        within += shut;
        for (size_t at = c; at < SENSORS * both.n_columns; at += both.n_columns)
            assert_true(both.total[at] == (shut ? shaded.total[at] : bare.total[at]));
    }
    assert_int_equal(within, 4);
    orl_annual_done(&bare);
    orl_annual_done(&shaded);
    orl_annual_done(&both);
}

/* Sensors are checked once per job, with the model of its first run: a shade between them and the
 * sensor outdoors would cause one more warning. */
static void test_sensors_checked_once(void **state)
{
    static const char shade[] = "w polygon shade 0 0 12 .1 .3 .1 3.9 .3 .1 3.9 .3 2.9 .1 .3 2.9\n";
    static const struct orl_sensor apart[] = {
        {{2, .6, .8}, {0, 0, 1}}, {{1, 4, .8}, {0, 0, 1}}, {{2, -1, .8}, {0, 0, 1}}};
    struct orl_shade_state states[] = {{.name = open_word},
                                       {.name = shut_word, .files = blind_files, .n_files = 1}};
    struct orl_shade_span span = {3, 3, 10, 14, 1};
    const struct orl_window_group group = {
        .name = south_word, .states = states, .n_states = 2, .spans = &span, .n_spans = 1};
    struct year_run run = usual(room);
    size_t n_outdoors = 0;
    (void)state;
    run.sensors = apart;
    run.samples = 32;
    run.resource_name = blind_file;
    run.resource_text = shade;
    run.groups = &group;
    run.n_groups = 1;
    struct orl_annual_result year = year_run(&run);
    assert_int_equal(year.n_runs, 2);
    for (size_t i = 0; i < year.n_warnings; i++)
        n_outdoors += strstr(year.warnings[i], "1 of 3 sensors lies outdoors") != NULL;
    assert_int_equal(n_outdoors, 1);
    orl_annual_done(&year);
}

/* The south blinds close when one of the grid's two points, half of them, has the sun; the bytes
 * are equal for 1, 2 and 7 threads. */
static void test_control_by_sun(void **state)
{
    struct orl_shade_state states[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    static char desks[] = "desks", wall[] = "wall";
    const struct orl_annual_grid grids[] = {{desks, 0, 2}, {wall, 2, 1}};
    struct orl_window_group group = {.name = south_word,
                                     .windows = front_list,
                                     .n_windows = 1,
                                     .states = states,
                                     .n_states = 2,
                                     .control = {ORL_SHADES_BY_SUN, .grid = desks, .above_lx = 1000,
                                                 .share_percent = 2, .state = 1}};
    struct year_run run = usual(room);
    struct orl_annual_result bare = year_run(&run), first = {0};
    size_t shut = 0;
    (void)state;
    run.grids = grids;
    run.n_grids = 2;
    run.groups = &group;
    run.n_groups = 1;
    static const uint32_t threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        run.threads = threads[i];
        struct orl_annual_result year = year_run(&run);
        if (i == 0) {
            first = year;
            continue;
        }
        assert_same(year.total, first.total, &first);
        assert_same(year.se, first.se, &first);
        assert_memory_equal(year.states, first.states, first.n_steps);
        orl_annual_done(&year);
    }
    for (size_t c = 0; c < first.n_columns; c++) {
        const size_t n = first.n_columns;
        const bool sunny = bare.direct[c] >= 1000 || bare.direct[n + c] >= 1000;
        assert_int_equal(first.states[first.step_of_column[c]], sunny);
        shut += sunny;
        if (sunny)
            assert_true(first.total[c] < bare.total[c]);
        else
            assert_true(first.total[c] == bare.total[c]);
    }
    assert_true(shut > 2 && shut < first.n_columns - 2);
    orl_annual_done(&bare);
    orl_annual_done(&first);
}

/* Groups of three states each: nine pairs in the hours of two days. */
struct three {
    struct orl_shade_state south[3], north[3];
    unsigned char series[2][48];
    struct orl_window_group groups[2];
};

static void make_three(struct three *t)
{
    *t = (struct three){.south = {{.name = open_word},
                                  {.name = shut_word, .material = tinted_name},
                                  {.name = dim_name, .material = dim_name}},
                        .north = {{.name = open_word},
                                  {.name = shut_word, .dark = true},
                                  {.name = dim_name, .material = dim_name}}};
    for (int i = 0; i < 48; i++) {
        t->series[0][i] = (unsigned char)(i % 3);
        t->series[1][i] = (unsigned char)(i / 3 % 3);
    }
    t->groups[0] = (struct orl_window_group){.name = south_word,
                                             .windows = front_list,
                                             .n_windows = 1,
                                             .states = t->south,
                                             .n_states = 3,
                                             .series = t->series[0],
                                             .n_series = 48};
    t->groups[1] = (struct orl_window_group){.name = north_word,
                                             .windows = back_list,
                                             .n_windows = 1,
                                             .states = t->north,
                                             .n_states = 3,
                                             .series = t->series[1],
                                             .n_series = 48};
}

/*
 * Nine pairs of states exceed the number of states per group, and one window is in no group: light
 * is the sum of three runs, one for each state. Each hour equals that of the scene written with the
 * pair, also by way of a glass facade opposite. Both have standard errors. Panes reflect each
 * other's light as in the same state: panes of 3 of 94 m2 that reflect 6 % less of their incident
 * light, from walls that reflect half, make 0.4 %. Squares of z are correlated by sensor, as in
 * test_annual.c.
 */
static void test_sum_of_groups(void **state)
{
    static const char *const souths[] = {"clear", "tinted", "dim"}, *const norths[] = {
                                                                        "clear", "black", "dim"};
    struct three three;
    struct year_run run = usual(WALLS WEST FACADE SOUTH("clear") NORTH("clear"));
    struct orl_annual_result alone[9];
    double squares = 0, worst = 0;
    size_t n = 0;
    (void)state;
    make_three(&three);
    run.samples = 1024;
    run.seed = 9;
    for (int i = 0; i < 9; i++) {
        char text[TEXT];
        snprintf(text, sizeof text,
                 WALLS WEST FACADE "%s polygon front 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
                                   "%s polygon back 0 0 12 1 5 1 3 5 1 3 5 2.5 1 5 2.5\n",
                 souths[i % 3], norths[i / 3]);
        struct year_run one = run;
        one.scene = text;
        alone[i] = year_run(&one);
    }
    run.groups = three.groups;
    run.n_groups = 2;
    struct orl_annual_result all = year_run(&run);
    assert_true(all.summed);
    assert_int_equal(all.n_runs, 3);
    assert_same(all.direct, alone[0].direct, &all);
    for (size_t c = 0; c < all.n_columns; c++) {
        const struct orl_annual_result *one = &alone[all.step_of_column[c] % 9];
        for (size_t at = c; at < SENSORS * all.n_columns; at += all.n_columns, n++) {
            const double lx = (double)one->total[at];
            const double z = ((double)all.total[at] - lx) /
                             hypot(hypot((double)all.se[at], (double)one->se[at]), 4e-3 * lx);
            squares += z * z;
            worst = fmax(worst, fabs(z));
            if (fabs(z) > 3)
                print_message("sensor %zu, column %zu, pair %u: %.2f +- %.2f, alone %.2f +- %.2f, "
                              "direct %.2f\n",
                              at / all.n_columns, c, all.step_of_column[c] % 9,
                              (double)all.total[at], (double)all.se[at], lx, (double)one->se[at],
                              (double)one->direct[at]);
        }
    }
    print_message("%zu sensor-hours: z rms %.2f, worst %.2f; %zu runs\n", n,
                  sqrt(squares / (double)n), worst, all.n_runs);
    assert_true(sqrt(squares / (double)n) < 1.5);
    assert_true(worst < 4.5);
    for (int i = 0; i < 9; i++)
        orl_annual_done(&alone[i]);
    orl_annual_done(&all);
}

/* The sum has the same bytes for 1, 2 and 7 threads. */
static void test_sum_by_threads(void **state)
{
    static const uint32_t threads[] = {1, 2, 7};
    struct three three;
    struct orl_annual_result first = {0};
    struct year_run run = usual(WALLS WEST SOUTH("clear") NORTH("clear"));
    (void)state;
    make_three(&three);
    run.groups = three.groups;
    run.n_groups = 2;
    for (int i = 0; i < 3; i++) {
        run.threads = threads[i];
        struct orl_annual_result year = year_run(&run);
        if (i == 0) {
            first = year;
            continue;
        }
        assert_same(year.total, first.total, &first);
        assert_same(year.se, first.se, &first);
        orl_annual_done(&year);
    }
    orl_annual_done(&first);
}

/* The light of each part is stored separately: a second run gives the same bytes without tracing a
 * path. */
static void test_sum_from_the_store(void **state)
{
    struct three three;
    struct year_run run = usual(WALLS WEST SOUTH("clear") NORTH("clear"));
    char folder[64];
    (void)state;
    make_three(&three);
    run.groups = three.groups;
    run.n_groups = 2;
    struct orl_annual_result plain = year_run(&run);
    cli_make_folder(folder);
    run.kept_in = folder;
    struct orl_annual_result first = year_run(&run), again = year_run(&run);
    assert_same(first.total, plain.total, &plain);
    assert_same(again.total, plain.total, &plain);
    assert_same(again.se, plain.se, &plain);
    assert_same(again.direct, plain.direct, &plain);
    assert_memory_equal(again.overcast, plain.overcast, SENSORS * sizeof *plain.overcast);
    assert_int_equal(again.reuse.of[ORL_ANNUAL_CACHE_PATHS].made, 0);
    assert_int_equal(again.reuse.of[ORL_ANNUAL_CACHE_PATHS].found, first.n_runs);
    cli_remove_folder(folder);
    orl_annual_done(&plain);
    orl_annual_done(&first);
    orl_annual_done(&again);
}

/* Rounds for a verdict keep the shades' states of all sensors from the first round. */
static void test_rounds(void **state)
{
    struct orl_shade_state states[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    const struct orl_window_group group = {
        .name = south_word,
        .windows = front_list,
        .n_windows = 1,
        .states = states,
        .n_states = 2,
        .control = {ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2, .state = 1}};
    struct orl_report_request report_request;
    struct orl_annual_target target;
    struct orl_annual_refinement refinement = {.asked = false};
    struct year_run run = usual(room);
    (void)state;
    run.groups = &group;
    run.n_groups = 1;
    run.samples = 32;
    struct orl_annual_result first = year_run(&run);
    double mean = 0; /* mean of the year's hours, near the target */
    for (size_t c = 0; c < first.n_columns; c++)
        mean += (double)first.total[first.n_columns + c] / (double)first.n_columns;
    assert_int_equal(orl_report_request_init(&report_request), 0);
    char text[64];
    snprintf(text, sizeof text, "least illuminance over the year >= %.3f",
             mean * (double)first.n_columns / 48);
    assert_int_equal(orl_annual_target_parse(text, &target, NULL), 0);
    report_request.until = &target;
    run.report_request = &report_request;
    run.ret_refinement = &refinement;
    struct orl_annual_result year = year_run(&run);
    assert_true(refinement.rounds > 1);
    assert_memory_equal(year.states, first.states, first.n_steps);
    assert_same(year.direct, first.direct, &first);
    report_request.until = NULL;
    orl_report_request_done(&report_request);
    orl_annual_done(&first);
    orl_annual_done(&year);
}

/* Each group's blinds follow the sun through its own windows: those in the north stay open. */
static void test_each_by_its_own_sun(void **state)
{
    struct orl_shade_state states[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    const struct orl_shade_control lm83 = {ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2,
                                           .state = 1};
    const struct orl_window_group groups[] = {{.name = south_word,
                                               .windows = front_list,
                                               .n_windows = 1,
                                               .states = states,
                                               .n_states = 2,
                                               .control = lm83},
                                              {.name = north_word,
                                               .windows = back_list,
                                               .n_windows = 1,
                                               .states = states,
                                               .n_states = 2,
                                               .control = lm83}};
    struct year_run run = usual(room);
    size_t shut = 0;
    (void)state;
    run.groups = groups;
    run.n_groups = 2;
    struct orl_annual_result year = year_run(&run);
    for (size_t i = 0; i < year.n_steps; i++) {
        shut += year.states[i];
        assert_int_equal(year.states[year.n_steps + i], 0);
    }
    assert_true(shut > 2);
    orl_annual_done(&year);
}

/* The open run, which the north's control needs, counts by its cost, not as one of all possible
 * runs, most of which are not needed. Progress never decreases, not even in the run of direct
 * sunlight. */
static void test_progress(void **state)
{
    struct orl_shade_state states[ORL_SHADES_MOST_STATES] = {{.name = open_word},
                                                             {.name = shut_word, .dark = true}};
    const struct orl_shade_control lm83 = {ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2,
                                           .state = 1};
    struct orl_window_group groups[] = {
        {.name = south_word, .windows = front_list, .n_windows = 1, .states = states},
        {.name = north_word, .windows = back_list, .n_windows = 1, .states = states}};
    struct year_progress progress = {.last = 0};
    struct year_run run = usual(room);
    char names[ORL_SHADES_MOST_STATES][24];
    (void)state;
    for (int i = 2; i < ORL_SHADES_MOST_STATES; i++) {
        snprintf(names[i], sizeof names[i], "state%d", i);
        states[i] = (struct orl_shade_state){.name = names[i], .dark = true};
    }
    for (int g = 0; g < 2; g++) {
        groups[g].n_states = ORL_SHADES_MOST_STATES;
        groups[g].control = lm83;
    }
    groups[1].control.kind = ORL_SHADES_BY_LIGHT;
    groups[1].control.above_lx = 1e6;
    run.groups = groups;
    run.n_groups = 2;
    run.progress = &progress;
    struct orl_annual_result year = year_run(&run);
    orl_annual_done(&year);
    assert_true(progress.runs >= 2);
    assert_int_equal(progress.falls, 0);
    assert_true(progress.after_first_run > 0.2 && progress.after_first_run < 0.6);
    assert_true(progress.last > 0.99);
}

/* Light that cannot be separated by groups is refused; the error names the surface or the place. */
static void test_what_does_not_add_up(void **state)
{
    static const char far[] = "w polygon awning 0 0 12 -9 -9 4 9 -9 4 9 -8 4 -9 -8 4\n";
    struct three three;
    struct orl_error err;
    struct orl_sensor outdoors = {{2, -3, 1}, {0, 0, 1}};
    struct year_run run = usual(WALLS WEST SOUTH("clear") NORTH("clear"));
    (void)state;
    make_three(&three);
    run.groups = three.groups;
    run.n_groups = 2;
    three.south[2].files = blind_files;
    three.south[2].n_files = 1;
    run.resource_name = blind_file;
    run.resource_text = far;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "'awning' of 'south'"));
    assert_string_equal(err.file, "blind.rad");
    three.south[2].n_files = 0;
    run.sensors = &outdoors;
    run.n_sensors = 1;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "outdoors"));
    run = usual(WALLS SOUTH("clear") NORTH("clear")); /* no west wall */
    run.groups = three.groups;
    run.n_groups = 2;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "enters the building other than through"));
}

/* State left by an interrupted year: stored rows of each run. */
struct restored {
    size_t done, asked;
    uint32_t rounds[8];
};

static void note_done(void *ctx, const struct orl_annual_chunk *chunk)
{
    struct restored *restored = ctx;
    assert_true(restored->done < 8);
    restored->rounds[restored->done++] = chunk->round;
}

static bool none_kept(void *ctx, struct orl_annual_chunk *chunk)
{
    (void)chunk;
    ((struct restored *)ctx)->asked++;
    return false;
}

static void test_kept_rows(void **state)
{
    struct orl_shade_state states[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    struct orl_shade_span span = {1, 12, 12, 24, 1};
    const struct orl_window_group group = {.name = south_word,
                                           .windows = front_list,
                                           .n_windows = 1,
                                           .states = states,
                                           .n_states = 2,
                                           .spans = &span,
                                           .n_spans = 1};
    struct restored restored = {0};
    const struct orl_annual_env env = {.restored = none_kept, .done = note_done, .ctx = &restored};
    struct year_run run = usual(room);
    (void)state;
    run.groups = &group;
    run.n_groups = 1;
    run.env = &env;
    struct orl_annual_result year = year_run(&run);
    assert_int_equal(restored.asked, 2);
    assert_int_equal(restored.done, 2);
    assert_true(restored.rounds[0] != restored.rounds[1]);
    orl_annual_done(&year);
}

static void test_mistakes(void **state)
{
    static char nothing[] = "nothing";
    static char *nothing_list[] = {nothing}, *clear_list[] = {clear_name};
    struct orl_shade_state plain[] = {{.name = open_word}},
                           swapped[] = {{.name = open_word, .material = nothing}},
                           two[] = {{.name = open_word}, {.name = shut_word, .dark = true}};
    unsigned char few[3] = {0, 1, 0};
    const struct orl_window_group windows = {.name = south_word,
                                             .windows = nothing_list,
                                             .n_windows = 1,
                                             .states = plain,
                                             .n_states = 1},
                                  material = {.name = south_word,
                                              .windows = front_list,
                                              .n_windows = 1,
                                              .states = swapped,
                                              .n_states = 1},
                                  series = {.name = south_word,
                                            .windows = front_list,
                                            .n_windows = 1,
                                            .states = two,
                                            .n_states = 2,
                                            .series = few,
                                            .n_series = 3},
                                  twice[] = {{.name = south_word,
                                              .windows = front_list,
                                              .n_windows = 1,
                                              .states = plain,
                                              .n_states = 1},
                                             {.name = north_word,
                                              .windows = clear_list,
                                              .n_windows = 1,
                                              .states = plain,
                                              .n_states = 1}};
    struct orl_error err;
    struct year_run run = usual(room);
    (void)state;
    run.n_groups = 1;
    run.groups = &windows;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_NOT_FOUND);
    assert_non_null(strstr(err.message, "'nothing'"));
    run.groups = &material;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_NOT_FOUND);
    assert_non_null(strstr(err.message, "no material 'nothing'"));
    run.groups = &series;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "3 states"));
    run.groups = twice;
    run.n_groups = 2;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "'front'"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_state),      cmocka_unit_test(test_two_groups),
        cmocka_unit_test(test_geometry),       cmocka_unit_test(test_sensors_checked_once),
        cmocka_unit_test(test_control_by_sun), cmocka_unit_test(test_sum_of_groups),
        cmocka_unit_test(test_sum_by_threads), cmocka_unit_test(test_sum_from_the_store),
        cmocka_unit_test(test_rounds),         cmocka_unit_test(test_each_by_its_own_sun),
        cmocka_unit_test(test_progress),       cmocka_unit_test(test_what_does_not_add_up),
        cmocka_unit_test(test_kept_rows),      cmocka_unit_test(test_mistakes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
