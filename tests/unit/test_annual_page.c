/* The page of a grid, for a hand-made year. Nothing overlaps; verdicts of the whole building and
 * warnings are visible; no large part of the page is blank. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/thread_pool.h>

#include "chart/charts.h"
#include "support/cli.h"
#include "support/hand_year.h"
#include "support/room.h"
#include "support/scratch.h"

enum { NORTH, SOUTH }; /* NORTH: two sensors, no map; SOUTH: four sensors, a map */

struct year {
    const char *title;
    struct orl_annual_grid grids[2];
    struct orl_sensor sensors[HAND_YEAR_SENSORS];
    struct orl_annual_request request;
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_annual_plans *plans;
};

/* ---- Years ----------------------------------------------------------------------------------- */

static double clock_s(void *ctx)
{
    (void)ctx;
    return 0;
}

static void make_plans(struct year *y)
{
    static const char scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static const char *const names[] = {"room.rad"};
    static char name[] = "room.rad", *scene_files[] = {name};
    const struct orl_file content = {scene, strlen(scene), NULL};
    struct orl_memory_files memory = {names, &content, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    atomic_bool cancel = false;
    struct orl_error err = {0};
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    const struct orl_run_env env = {
        .pool = pool, .files = &files, .cancel = &cancel, .now_s = clock_s};
    y->request.scene_files = scene_files;
    y->request.n_scene_files = 1;
    if (orl_annual_plans_new(&y->request, &y->report, &env, &y->plans, &err) < 0)
        fail_msg("%s", err.message);
    orl_thread_pool_stop(pool);
}

static void take_rules(struct orl_report_request *report_request, const char *name)
{
    const struct orl_annual_rule *first;
    size_t n;
    assert_int_equal(orl_annual_rules_find(name, &first, &n, NULL), 0);
    report_request->rules = realloc(report_request->rules,
                                    (report_request->n_rules + n) * sizeof *report_request->rules);
    assert_non_null(report_request->rules);
    for (size_t i = 0; i < n; i++)
        report_request->rules[report_request->n_rules++] = first[i];
}

/* Builds the sensors of a room `across` by `down` metres. `rules` ends with NULL. */
static void make_year(struct year *y, double across, double down, const char *const *rules)
{
    memset(y, 0, sizeof *y);
    hand_year_make(&y->result, false);
    y->request = hand_year_request(y->grids);
    for (int i = 0; i < HAND_YEAR_SENSORS; i++)
        y->sensors[i] = (struct orl_sensor){
            {0.5 + across / 2 * (i % 2), 0.5 + down / 2 * (double)(i / 2), 0.8}, {0, 0, 1}};
    y->request.sensors = y->sensors;
    static char weather[] = "place.epw";
    y->request.weather_file = weather;
    y->result.site.latitude_deg = 52;
    assert_int_equal(orl_report_request_init(&y->report_request), 0);
    for (; *rules; rules++)
        take_rules(&y->report_request, *rules);
    y->report = hand_year_report(&y->request, &y->result, &y->report_request);
    make_plans(y);
}

static void free_year(struct year *y)
{
    orl_annual_plans_free(y->plans);
    orl_annual_report_done(&y->report);
    orl_report_request_done(&y->report_request);
    hand_year_free(&y->result);
}

/* Draws the page of a grid; returns its SVG, which the caller frees. */
static char *draw_page(const struct year *y, size_t grid)
{
    const struct orl_annual_page page = {.title = y->title,
                                         .request = &y->request,
                                         .report_request = &y->report_request,
                                         .result = &y->result,
                                         .report = &y->report,
                                         .plans = y->plans,
                                         .grid = grid};
    struct orl_error err = {0};
    if (orl_annual_page_write(&page, ORL_CANVAS_SVG, scratch_path("a.svg"), &err) < 0)
        fail_msg("%s", err.message);
    char *text = cli_read_file(scratch_path(""), "a.svg");
    assert_non_null(text);
    return text;
}

/* ---- Texts of a page ------------------------------------------------------------------------- */

enum { MOST_TEXTS = 512 };

/* A horizontal text: its left end, base line and size. */
struct text {
    double x, y, width, height;
    char words[160];
};

static double number_of(const char *tag, const char *attribute)
{
    const char *at = strstr(tag, attribute);
    assert_non_null(at);
    return strtod(at + strlen(attribute), NULL);
}

static size_t list_texts(const char *svg, struct text *ret_texts)
{
    size_t n = 0;
    for (const char *at = strstr(svg, "<text "); at; at = strstr(at + 1, "<text ")) {
        const char *words = strchr(at, '>') + 1, *end = strchr(words, '<');
        assert_true(n < MOST_TEXTS && end);
        struct text *t = &ret_texts[n++];
        *t = (struct text){.x = number_of(at, " x=\""),
                           .y = number_of(at, " y=\""),
                           .width = number_of(at, "textLength=\""),
                           .height = 0.72 * number_of(at, "font-size=\"")};
        snprintf(t->words, sizeof t->words, "%.*s", (int)(end - words), words);
    }
    return n;
}

/* Returns true if texts are closer than four units between lines, or two between words of one
 * line. */
static bool touch(const struct text *a, const struct text *b)
{
    return a->x < b->x + b->width + 2 && b->x < a->x + a->width + 2 &&
           a->y - a->height < b->y + 4 && b->y - b->height < a->y + 4;
}

static void assert_texts_are_apart(const char *svg)
{
    static struct text texts[MOST_TEXTS];
    const size_t n = list_texts(svg, texts);
    assert_true(n > 40);
    for (size_t i = 0; i < n; i++) {
        if (texts[i].y > 1358 - 20 || texts[i].x + texts[i].width > 960)
            fail_msg("'%s' at %g, %g is off the page", texts[i].words, texts[i].x, texts[i].y);
        for (size_t k = i + 1; k < n; k++)
            if (touch(&texts[i], &texts[k]))
                fail_msg("'%s' and '%s' touch at y = %g and %g", texts[i].words, texts[k].words,
                         texts[i].y, texts[k].y);
    }
}

static size_t count_substrings(const char *text, const char *part)
{
    size_t n = 0;
    for (const char *at = strstr(text, part); at; at = strstr(at + 1, part))
        n++;
    return n;
}

static int by_height(const void *a, const void *b)
{
    const double x = ((const struct text *)a)->y, y = ((const struct text *)b)->y;
    return (x > y) - (x < y);
}

static char *warnings[] = {
    (char[]){"grid 'south': 1 of 4 sensors lies outdoors, and the others in a closed space"},
    (char[]){"grid 'North / \"old\"': 2 of 2 sensors: the sensor lies in the plane of a surface; "
             "the first, number 1 at (-8, 0, 0.8), 0 m from 'TestRoom_1_2bb15971..Face3' "
             "(model/scene/envelope.rad:40): the side it measures is random; move it at least "
             "0.0007 m away from the surface"},
    (char[]){"a texture is missing"},
    (char[]){"no light ever reaches 3 sensors: check that they are not inside an object"}};

/* ---- Tests ----------------------------------------------------------------------------------- */

static const char *const long_list[] = {"LEED", "EN 17037", NULL};

/* Wide, square and tall rooms, with a full list of targets and without any: no texts overlap. */
static void test_nothing_covers_anything(void **state)
{
    static const double sizes[][2] = {{16, 4}, {6, 4}, {4, 4}, {3, 9}};
    static const char *const none[] = {NULL};
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int list = 0; list < 2; list++) {
            struct year y;
            make_year(&y, sizes[i][0], sizes[i][1], list ? long_list : none);
            char *page = draw_page(&y, SOUTH);
            assert_non_null(strstr(page, "facing up"));
            assert_texts_are_apart(page);
            free(page);
            free_year(&y);
        }
}

/* The number below the top of the scale does not touch it: 10000 and 15000. */
static void test_numbers_of_the_scale_are_apart(void **state)
{
    static const float factors[] = {1, 1.5F, 2, 3, 5, 7.5F};
    static const char *const none[] = {NULL};
    (void)state;
    for (size_t i = 0; i < sizeof factors / sizeof *factors; i++) {
        struct year y;
        make_year(&y, 6, 4, none);
        for (size_t k = 0; k < HAND_YEAR_SENSORS * y.result.n_columns; k++)
            y.result.total[k] = 9999 * factors[i];
        char *page = draw_page(&y, NORTH);
        assert_texts_are_apart(page);
        free(page);
        free_year(&y);
    }
}

/* Gives the verdicts of all grids together unique values: 900 %, 901 % and so on. Returns their
 * number. */
static size_t mark_verdicts_of_all(struct year *y)
{
    size_t n = 0;
    for (size_t i = 0; i < y->report.n_verdicts; i++)
        if (y->report.verdicts[i].grid == ORL_ALL_GRIDS)
            y->report.verdicts[i].area.value =
                (struct orl_annual_value){900 + (double)n++, NAN, NAN};
    return n;
}

/* The page of each grid has all lines of both lists. */
static void test_verdicts_of_the_building(void **state)
{
    struct year y;
    (void)state;
    make_year(&y, 6, 4, long_list);
    const size_t n = mark_verdicts_of_all(&y);
    assert_true(n > 8);
    for (size_t grid = 0; grid < 2; grid++) {
        char *page = draw_page(&y, grid), wanted[32];
        for (size_t i = 0; i < n; i++) {
            snprintf(wanted, sizeof wanted, ">%zu.0 %%<", 900 + i);
            assert_non_null(strstr(page, wanted));
        }
        assert_int_equal(count_substrings(page, "sDA300/50 &gt;= 75 %"), 2);
        assert_null(strstr(page, "in result.json"));
        assert_non_null(strstr(page, ">Targets, all grids together<"));
        assert_texts_are_apart(page);
        free(page);
    }
    free_year(&y);
}

/* A reason shared by several verdicts is written once, and below only the verdicts it belongs to.
 */
static void test_reasons_are_written_once(void **state)
{
    static const char *const leed[] = {"LEED", NULL};
    static const char *const notes[] = {"one", "one", "one", ""};
    struct year y;
    (void)state;
    make_year(&y, 6, 4, leed);
    for (size_t i = 0, n = 0; i < y.report.n_verdicts; i++)
        if (y.report.verdicts[i].grid == NORTH)
            snprintf(y.report.verdicts[i].note, ORL_VERDICT_NOTE, "%s", notes[n++ % 4]);
        else
            snprintf(y.report.verdicts[i].note, ORL_VERDICT_NOTE, "number %zu", i);
    char *page = draw_page(&y, NORTH);
    assert_int_equal(count_substrings(page, ">these 3: one<"), 1);
    assert_int_equal(count_substrings(page, ">one<"), 0);
    assert_int_equal(count_substrings(page, ">number "), 4);
    assert_non_null(strstr(page, ">LEED v4.1, 1 point: sDA300/50 &gt;= 40 %: "));
    assert_texts_are_apart(page);
    free(page);
    free_year(&y);
}

/* A list that is too long for the page: targets of rules are omitted, but no rule is. */
static void test_many_rules(void **state)
{
    static const char *const longer[] = {"LEED", "EN 17037", "BREEAM", "WELL", NULL};
    struct year y;
    (void)state;
    make_year(&y, 6, 4, longer);
    assert_true(y.report_request.n_rules > 20);
    y.result.warnings = warnings;
    y.result.n_warnings = sizeof warnings / sizeof *warnings;
    for (size_t grid = 0; grid < 2; grid++) {
        char *page = draw_page(&y, grid), wanted[96];
        for (size_t i = 0; i < y.report_request.n_rules; i++) {
            snprintf(wanted, sizeof wanted, ">%s: ", y.report_request.rules[i].name);
            if (count_substrings(page, wanted) != 2)
                fail_msg("%zu times '%s'", count_substrings(page, wanted), wanted);
        }
        assert_null(strstr(page, " more, in result.json"));
        assert_non_null(strstr(page, ">values of the targets are in result.json<"));
        assert_texts_are_apart(page);
        free(page);
    }
    y.result.warnings = NULL;
    free_year(&y);
}

/* If even the shortened list does not fit, the rest is counted, and nothing leaves the page. */
static void test_far_too_many_targets(void **state)
{
    enum { MANY = 300 };
    static const char *const none[] = {NULL};
    struct year y;
    (void)state;
    make_year(&y, 6, 4, none);
    struct orl_annual_verdict *verdicts = calloc(2 * MANY, sizeof *verdicts);
    assert_non_null(verdicts);
    for (size_t i = 0; i < 2 * MANY; i++) {
        assert_int_equal(orl_annual_target_parse("sDA >= 50 %", &verdicts[i].target, NULL), 0);
        verdicts[i].grid = i < MANY ? SOUTH : ORL_ALL_GRIDS;
    }
    free(y.report.verdicts);
    y.report.verdicts = verdicts;
    y.report.n_verdicts = 2 * MANY;
    char *page = draw_page(&y, SOUTH), wanted[64];
    snprintf(wanted, sizeof wanted, ">and %zu more, in result.json<",
             2 * MANY - count_substrings(page, "sDA &gt;= 50 %"));
    assert_non_null(strstr(page, wanted));
    assert_non_null(strstr(page, "facing up"));
    assert_texts_are_apart(page);
    free(page);
    free_year(&y);
}

/* A page without a map has a table of the sensors instead, and the year moves up. */
static void test_no_part_is_blank(void **state)
{
    static struct text texts[MOST_TEXTS];
    static const char *const leed[] = {"LEED", NULL};
    struct year y;
    (void)state;
    make_year(&y, 6, 4, leed);
    char *page = draw_page(&y, NORTH);
    const size_t n = list_texts(page, texts);
    qsort(texts, n, sizeof *texts, by_height);
    for (size_t i = 1; i < n; i++)
        if (texts[i].y - texts[i - 1].y > 120)
            fail_msg("%g units are blank above '%s'", texts[i].y - texts[i - 1].y, texts[i].words);
    assert_non_null(strstr(page, "(0.5, 0.5, 0.8)"));
    assert_non_null(strstr(page, "(3.5, 0.5, 0.8)"));
    assert_texts_are_apart(page);
    free(page);
    free_year(&y);
}

/* The grid's warnings come first, then the job's; those of other grids stay on their pages. */
static void test_warnings_are_in_view(void **state)
{
    struct year y;
    (void)state;
    make_year(&y, 6, 4, long_list);
    char *page = draw_page(&y, SOUTH);
    assert_null(strstr(page, ">Warnings<"));
    free(page);
    y.result.warnings = warnings;
    y.result.n_warnings = sizeof warnings / sizeof *warnings;
    page = draw_page(&y, SOUTH);
    assert_non_null(strstr(page, ">Warnings<"));
    assert_non_null(strstr(page, "1 of 4 sensors lies outdoors"));
    assert_non_null(strstr(page, "a texture is missing"));
    assert_non_null(strstr(page, "no light ever reaches 3 sensors"));
    assert_null(strstr(page, "the side it measures"));
    assert_null(strstr(page, "more warnings"));
    assert_texts_are_apart(page);
    free(page);
    page = draw_page(&y, NORTH);
    assert_null(strstr(page, "outdoors"));
    assert_true(strstr(page, "2 of 2 sensors: ") < strstr(page, "a texture is missing"));
    assert_non_null(strstr(page, "away from the surface<")); /* the end, wrapped */
    assert_texts_are_apart(page);
    free(page);
    y.result.warnings = NULL;
    free_year(&y);
}

/* Long words are cut to the page's width, with a note that says where to read them. */
static void test_long_words_are_cut(void **state)
{
    enum { LONG = 900 };
    static char words[LONG + 1], *one[] = {words};
    struct year y;
    (void)state;
    for (int i = 0; i < LONG; i++)
        words[i] = i % 7 == 6 ? ' ' : 'm';
    make_year(&y, 6, 4, long_list);
    y.title = words;
    y.result.warnings = one;
    y.result.n_warnings = 1;
    char *page = draw_page(&y, SOUTH);
    assert_non_null(strstr(page, ">result.json has the full warnings<"));
    assert_texts_are_apart(page);
    free(page);
    y.result.warnings = NULL;
    free_year(&y);
}

/* Many long warnings leave room for the rest of the page, and the omitted ones are counted. */
static void test_many_warnings(void **state)
{
    enum { MANY = 300, LONG = 900 };
    static char words[LONG + 1], *many[MANY];
    struct year y;
    (void)state;
    for (int i = 0; i < LONG; i++)
        words[i] = i < LONG / 2 && i % 7 == 6 ? ' ' : 'm';
    for (int i = 0; i < MANY; i++)
        many[i] = words;
    make_year(&y, 6, 4, long_list);
    y.result.warnings = many;
    y.result.n_warnings = MANY;
    char *page = draw_page(&y, SOUTH);
    const char *more = strstr(page, "more warnings, in result.json<");
    assert_non_null(more);
    assert_int_equal(count_substrings(page, "more warnings"), 1);
    assert_non_null(strstr(page, "facing up")); /* the maps are still there */
    assert_texts_are_apart(page);
    free(page);
    y.result.warnings = NULL;
    free_year(&y);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_nothing_covers_anything, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_numbers_of_the_scale_are_apart, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_verdicts_of_the_building, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_reasons_are_written_once, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_many_rules, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_far_too_many_targets, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_no_part_is_blank, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_warnings_are_in_view, scratch_set_up,
                                        scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_long_words_are_cut, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_many_warnings, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
