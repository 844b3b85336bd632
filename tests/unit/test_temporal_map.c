/* A year as a carpet plot: positions of days and hours, gaps, the legend. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "chart/charts.h"
#include "support/cli.h"
#include "support/scratch.h"

/* Returns the map as an SVG, which the caller frees. */
static char *draw_map(const struct orl_temporal_map *map)
{
    assert_int_equal(orl_temporal_map_write(map, ORL_CANVAS_SVG, scratch_path("a.svg"), NULL), 0);
    char *text = cli_read_file(scratch_path(""), "a.svg");
    assert_non_null(text);
    return text;
}

static size_t count_substrings(const char *text, const char *part)
{
    size_t n = 0;
    for (const char *at = strstr(text, part); at; at = strstr(at + 1, part))
        n++;
    return n;
}

static float *make_values(size_t n, float value)
{
    float *values = malloc(n * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < n; i++)
        values[i] = value;
    return values;
}

/* In a constant year every day is one box; each hour that differs makes two more. */
static void test_boxes(void **state)
{
    float *values = make_values(8760, 150);
    struct orl_temporal_map map = {
        .title = "Even", .unit = "lx", .steps = {8760, 1}, .values = values, .top = 300};
    char *plain = draw_map(&map);
    (void)state;
    values[24 * 40 + 12] = 300;
    char *spot = draw_map(&map);
    assert_int_equal(count_substrings(spot, "<polygon") + count_substrings(spot, "<path") +
                         count_substrings(spot, "<rect"),
                     count_substrings(plain, "<polygon") + count_substrings(plain, "<path") +
                         count_substrings(plain, "<rect") + 2);
    values[24 * 40 + 12] = 150;
    for (int i = 0; i < 24; i++)
        values[24 * 40 + i] = ORL_SUN_DOWN;
    char *night = draw_map(&map);
    assert_int_equal(count_substrings(night, "<polygon") + count_substrings(night, "<path") +
                         count_substrings(night, "<rect"),
                     count_substrings(plain, "<polygon") + count_substrings(plain, "<path") +
                         count_substrings(plain, "<rect") - 1);
    free(plain);
    free(spot);
    free(night);
    free(values);
}

static void test_words(void **state)
{
    float *values = make_values(17568, 42000);
    struct orl_temporal_map map = {
        .title = "A leap year of half hours", .unit = "lx", .steps = {17568, 2}, .values = values};
    char *text = draw_map(&map);
    (void)state;
    assert_non_null(strstr(text, ">A leap year of half hours</text>"));
    assert_non_null(strstr(text, ">Jan</text>"));
    assert_non_null(strstr(text, ">Dec</text>"));
    assert_non_null(strstr(text, ">18:00</text>"));
    assert_non_null(strstr(text, ">50000 lx +</text>")); /* the next round number, and more */
    assert_non_null(strstr(text, ">10000</text>"));
    free(text);
    map.logarithmic = true;
    map.top = 3000;
    text = draw_map(&map);
    assert_non_null(strstr(text, ">3000 lx</text>"));
    assert_non_null(strstr(text, ">1000</text>"));
    assert_non_null(strstr(text, ">300</text>"));
    assert_non_null(strstr(text, ">3</text>"));
    assert_null(strstr(text, ">1</text>"));
    free(text);
    free(values);
}

/* A year without any light, or any measurement, still has a scale. */
static void test_nothing_to_show(void **state)
{
    static const float fills[] = {0, ORL_SUN_DOWN, NAN};
    (void)state;
    for (size_t i = 0; i < sizeof fills / sizeof *fills; i++) {
        float *values = make_values(8760, fills[i]);
        const struct orl_temporal_map map = {
            .title = "Nothing", .unit = "lx", .steps = {8760, 1}, .values = values};
        char *text = draw_map(&map);
        assert_non_null(strstr(text, ">1 lx +</text>"));
        assert_null(strstr(text, "nan"));
        free(text);
        free(values);
    }
}

/* Hours of use have their lines: from 8 and to 18 on most days. */
static void test_use(void **state)
{
    float *values = make_values(8760, 1);
    unsigned char marks[8760];
    struct orl_occupancy use;
    struct orl_temporal_map map = {
        .title = "Use", .unit = "lx", .steps = {8760, 1}, .values = values, .top = 2};
    char *without = draw_map(&map);
    (void)state;
    orl_occupancy_init(&use);
    use.days = 0x1f;
    orl_occupancy_mark(&use, &map.steps, marks);
    map.marks = marks;
    char *with = draw_map(&map);
    const size_t dashes = count_substrings(with, "stroke=\"#ffffff\"") -
                          count_substrings(without, "stroke=\"#ffffff\"");
    assert_true(dashes > 2 * 50 && dashes < 2 * 100 && dashes % 2 == 0);
    free(with);
    free(without);
    free(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_boxes, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_words, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_nothing_to_show, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_use, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
