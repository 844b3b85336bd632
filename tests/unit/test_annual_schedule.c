/* States of window groups: time rules, and controls by hand-made arrays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "annual/shades/shaded_year.h"

static char name[] = "g", room[] = "room", desks[] = "Desks";

/* Decides the states with all sensors (rows of lx) counted. */
static void decide(const struct orl_annual_request *request,
                   const struct orl_shade_control *control, const float *lx, size_t columns,
                   bool *ret_closed)
{
    struct orl_shade_count count;
    struct orl_arrays arrays = {.failed = false};
    assert_int_equal(orl_shade_count_init(&count, &arrays, columns), 0);
    for (size_t i = 0; i < request->n_sensors; i++)
        orl_shade_count_add(&count, request, control, i, lx + i * columns);
    orl_shade_count_end(&count, request, control);
    memcpy(ret_closed, count.closed, columns * sizeof *ret_closed);
    orl_arrays_free(&arrays);
}

/* LM-83's trigger: more than 2 % of the points have 1000 lx or more; both bounds are met exactly.
 */
static void test_lm83(void **state)
{
    enum { POINTS = 50, COLUMNS = 5 };
    static const struct orl_shade_control lm83 = {ORL_SHADES_BY_SUN, .above_lx = 1000,
                                                  .share_percent = 2, .state = 1};
    const struct orl_annual_request request = {.n_sensors = POINTS};
    float direct[POINTS * COLUMNS] = {0};
    bool closed[COLUMNS];
    (void)state;
    direct[0] = 5000; /* one of 50 is 2 %, and not more */
    direct[1] = direct[7 * COLUMNS + 1] = 1000;
    direct[2] = 1000;
    direct[9 * COLUMNS + 2] = nextafterf(1000, 0);
    for (int i = 0; i < POINTS; i++)
        direct[i * COLUMNS + 3] = 999;
    decide(&request, &lm83, direct, COLUMNS, closed);
    assert_false(closed[0]);
    assert_true(closed[1]);
    assert_false(closed[2]);
    assert_false(closed[3]);
    assert_false(closed[4]);
}

/* Any of several grids closes the blinds, or only the named one; names ignore case. */
static void test_grids(void **state)
{
    struct orl_annual_grid grids[] = {{room, 0, 99}, {desks, 99, 1}};
    static char lower[] = "desks";
    const struct orl_annual_request request = {.n_sensors = 100, .grids = grids, .n_grids = 2};
    struct orl_shade_control control = {ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2,
                                        .state = 1};
    float direct[200] = {0};
    bool closed[2];
    (void)state;
    direct[198] = 2000;                       /* a sensor of the desk */
    direct[1] = direct[3] = direct[5] = 2000; /* 3 of 99 in the room */
    decide(&request, &control, direct, 2, closed);
    assert_true(closed[0] && closed[1]);
    control.grid = lower;
    decide(&request, &control, direct, 2, closed);
    assert_true(closed[0] && !closed[1]);
    control.grid = room;
    decide(&request, &control, direct, 2, closed);
    assert_true(!closed[0] && closed[1]);
}

/* With an illuminance control one sensor is enough, and a value equal to the bound counts. */
static void test_illuminance(void **state)
{
    struct orl_annual_grid grids[] = {{room, 0, 1}, {desks, 1, 2}};
    const struct orl_annual_request request = {.n_sensors = 3, .grids = grids, .n_grids = 2};
    const struct orl_shade_control control = {ORL_SHADES_BY_LIGHT, .grid = desks, .above_lx = 2000,
                                              .share_percent = 2, .state = 1};
    const float total[] = {9000, 9000, 1999, 500, 100, 2000};
    bool closed[2];
    (void)state;
    decide(&request, &control, total, 2, closed);
    assert_true(!closed[0] && closed[1]);
}

/* The first rule that contains the hour applies; rules may span New Year and midnight; one end of
 * a span is included, the other is not. */
static void test_spans(void **state)
{
    struct orl_shade_span spans[] = {{11, 2, 0, 24, 1}, {1, 12, 22, 6, 2}, {6, 6, 10, 14, 3}};
    struct orl_shade_state states[4] = {{.name = name}};
    struct orl_window_group group = {
        .name = name, .states = states, .n_states = 4, .spans = spans, .n_spans = 3};
    const struct orl_annual_request request = {.groups = &group, .n_groups = 1};
    struct orl_annual_step steps[] = {
        {.month = 11, .hour = 12}, {.month = 2, .hour = 12},  {.month = 3, .hour = 12},
        {.month = 12, .hour = 23}, {.month = 6, .hour = 23},  {.month = 6, .hour = 5.5},
        {.month = 6, .hour = 6},   {.month = 6, .hour = 10},  {.month = 6, .hour = 13.5},
        {.month = 6, .hour = 14},  {.month = 10, .hour = 22}, {.month = 7, .hour = 12}};
    static const unsigned char wanted[] = {1, 1, 0, 1, 2, 2, 0, 3, 3, 0, 2, 0};
    unsigned char found[12];
    const struct orl_annual_result result = {.steps = steps, .n_steps = 12};
    (void)state;
    assert_int_equal(orl_shades_schedule(&request, &result, found, NULL), 0);
    assert_memory_equal(found, wanted, sizeof wanted);
    group.spans = NULL;
    group.n_spans = 0;
    group.series = (unsigned char *)(uintptr_t)wanted;
    group.n_series = 12;
    memset(found, 9, sizeof found);
    assert_int_equal(orl_shades_schedule(&request, &result, found, NULL), 0);
    assert_memory_equal(found, wanted, sizeof wanted);
    /* States follow the file's rows, whose last four are the first steps of the year. */
    struct orl_annual_result moved = result;
    moved.n_moved = 4;
    assert_int_equal(orl_shades_schedule(&request, &moved, found, NULL), 0);
    assert_memory_equal(found, wanted + 8, 4);
    assert_memory_equal(found + 4, wanted, 8);
    group.n_series = 11;
    assert_int_equal(orl_shades_schedule(&request, &result, found, NULL), ORL_ERR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lm83),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_illuminance),
        cmocka_unit_test(test_spans),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
