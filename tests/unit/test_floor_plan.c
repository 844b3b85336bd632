/* Floor plans of scenes: lengths and places of lines, bounds, and the lines kept if there are too
 * many. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include <oriel/job/floor_plan.h>

static const char room[] = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
                           "grey polygon floor 0 0 12 1 2 0 4 2 0 4 6 0 1 6 0\n"
                           "grey polygon west 0 0 12 1 2 0 1 6 0 1 6 3 1 2 3\n"
                           "grey polygon north 0 0 12 1 6 0 4 6 0 4 6 3 1 6 3\n"
                           "grey polygon sill 0 0 12 4 2 0 4 2 1 4 6 1 4 6 0\n";

static void cut(const char *text, double height, struct orl_floor_plan *ret_plan)
{
    static const char *const names[] = {"room.rad"};
    const struct orl_file content = {text, strlen(text), NULL};
    struct orl_memory_files memory = {names, &content, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_error err;
    if (orl_scene_floor_plan(names, 1, &files, height, ret_plan, &err))
        fail_msg("%s", err.message);
}

static double length_of(const struct orl_floor_plan *plan)
{
    double sum = 0;
    for (size_t i = 0; i < plan->count; i++)
        sum += hypot(plan->lines[i][2] - plan->lines[i][0], plan->lines[i][3] - plan->lines[i][1]);
    return sum;
}

static void test_a_room(void **state)
{
    static const double heights[] = {0.5, 2, 4}, lengths[] = {11, 7, 0};
    struct orl_floor_plan plan;
    (void)state;
    for (int i = 0; i < 3; i++) {
        cut(room, heights[i], &plan);
        assert_true(fabs(length_of(&plan) - lengths[i]) < 1e-5);
        assert_true(plan.height == heights[i] && !plan.more);
        for (size_t k = 0; k < plan.count; k++) {
            const double *line = plan.lines[k];
            assert_true(line[0] > 1 - 1e-5 && line[0] < 4 + 1e-5);
            assert_true(line[1] > 2 - 1e-5 && line[1] < 6 + 1e-5);
        }
        orl_floor_plan_done(&plan);
    }
    cut(room, NAN, &plan);
    assert_true(fabs(plan.height - 1.5) < 1e-5);
    assert_true(fabs(plan.low[1] - 2) < 1e-5 && fabs(plan.high[2] - 3) < 1e-5);
    orl_floor_plan_done(&plan);
}

/* The short sides of columns are dropped first: a wall stays. */
static void test_too_many(void **state)
{
    enum { COLUMNS = 5000 };
    struct orl_floor_plan plan;
    char *text = malloc(sizeof room + 2 * COLUMNS * 90);
    (void)state;
    assert_non_null(text);
    strcpy(text, room);
    char *end = text + strlen(text);
    for (int i = 0; i < COLUMNS; i++)
        end += sprintf(end, "grey polygon c%d 0 0 9 %d .1 0 %d .2 0 %d .1 9\n", i, 10 + i, 10 + i,
                       10 + i);
    cut(text, 0.5, &plan);
    assert_true(!plan.more && plan.count > COLUMNS);
    orl_floor_plan_done(&plan);
    for (int i = 0; i < COLUMNS; i++)
        end += sprintf(end, "grey polygon d%d 0 0 9 %d .3 0 %d .4 0 %d .3 9\n", i, 10 + i, 10 + i,
                       10 + i);
    cut(text, 0.5, &plan);
    assert_true(plan.more);
    assert_int_equal(plan.count, ORL_FLOOR_PLAN_LINES);
    assert_true(hypot(plan.lines[0][2] - plan.lines[0][0], plan.lines[0][3] - plan.lines[0][1]) >
                0.5);
    orl_floor_plan_done(&plan);
    free(text);
}

static void test_nothing(void **state)
{
    struct orl_floor_plan plan;
    (void)state;
    cut("void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 180\n", NAN, &plan);
    assert_int_equal(plan.count, 0);
    assert_true(plan.height == 0 && !plan.more);
    orl_floor_plan_done(&plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_room),
                                       cmocka_unit_test(test_too_many),
                                       cmocka_unit_test(test_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
