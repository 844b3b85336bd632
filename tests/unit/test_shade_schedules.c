/* Hourly states of shades, from tables. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/limits.h>

static char file_name[] = "s.csv", group_name[] = "south", open_name[] = "open",
            blinds_name[] = "blinds, half";

/* Reads a table for the group, which has two states. The caller frees the series. */
static int read_text(const char *text, unsigned char **ret_series, size_t *ret_count,
                     struct orl_error *err)
{
    static const char *const names[] = {file_name};
    const struct orl_file contents[] = {{text, strlen(text), NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_shade_state states[2] = {{.name = open_name}, {.name = blinds_name}};
    struct orl_window_group group = {
        .name = group_name, .states = states, .n_states = 2, .schedule_file = file_name};
    struct orl_annual_request request = {.groups = &group, .n_groups = 1};
    const int code = orl_annual_schedules_read(&request, &files, err);
    *ret_series = group.series;
    *ret_count = group.n_series;
    return code;
}

static void test_tables(void **state)
{
    static const char *const texts[] = {
        "0\n1\n1\n0\n",
        "# a remark\n\nstate\nopen\n\"blinds, half\"\r\n1\nOPEN",
        "month,day,south,north\n1,1,0,1\n1,1,1,0\n1,1,\"Blinds, half\",1\n1,1,open,1\n",
        "month , \"shades of south\"\n1, open\n1, 1\n1, 1\n1,0\n",
    };
    static const unsigned char expected[4] = {0, 1, 1, 0};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        unsigned char *series;
        size_t count;
        struct orl_error err = {0};
        if (read_text(texts[i], &series, &count, &err) < 0)
            fail_msg("case %zu: %s", i, err.message);
        assert_int_equal(count, 4);
        assert_memory_equal(series, expected, 4);
        free(series);
    }
}

static void test_what_is_wrong(void **state)
{
    static const struct {
        const char *text, *says;
        int code, line;
    } cases[] = {
        {"", "empty", ORL_ERR_SYNTAX, 0},
        {"# nothing\n", "empty", ORL_ERR_SYNTAX, 0},
        {"nan\n0\n", "no state 'nan'", ORL_ERR_RANGE, 1}, /* a data row, not a heading */
        {"inf\n0\n", "no state 'inf'", ORL_ERR_RANGE, 1},
        {"7\n0\n", "no state '7'", ORL_ERR_RANGE, 1},
        {"0\n2\n", "no state '2'", ORL_ERR_RANGE, 2},
        {"0\nshut\n", "no state 'shut'", ORL_ERR_RANGE, 2},
        {"0\n-1\n", "no state '-1'", ORL_ERR_RANGE, 2},
        {"north,east\n0,1\n", "named 'south'", ORL_ERR_SYNTAX, 1},
        {"north,south\n0,1\n\n0\n", "too short", ORL_ERR_SYNTAX, 4},
        {"north,south\n0,\n", "no state ''", ORL_ERR_RANGE, 2},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned char *series;
        size_t count;
        struct orl_error err = {0};
        assert_int_equal(read_text(cases[i].text, &series, &count, &err), cases[i].code);
        free(series);
        assert_string_equal(err.file, file_name);
        assert_int_equal(err.line, cases[i].line);
        if (!strstr(err.message, cases[i].says))
            fail_msg("case %zu: %s", i, err.message);
    }
}

/* A table with more rows than a year can have is refused. */
static void test_limit(void **state)
{
    enum { ROWS = ORL_LIMIT_YEAR_ROWS + 1 };
    char *text = malloc(2 * ROWS + 1);
    unsigned char *series;
    size_t count;
    struct orl_error err = {0};
    (void)state;
    assert_non_null(text);
    for (size_t i = 0; i < ROWS; i++)
        memcpy(text + 2 * i, "1\n", 2);
    text[2 * ROWS] = '\0';
    assert_int_equal(read_text(text, &series, &count, &err), ORL_ERR_LIMIT);
    free(series);
    text[2 * ROWS - 2] = '\0';
    assert_int_equal(read_text(text, &series, &count, &err), 0);
    assert_int_equal(count, ROWS - 1);
    free(series);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_what_is_wrong),
        cmocka_unit_test(test_limit),
    };
    return cmocka_run_group_tests_name("shade_schedules", tests, NULL, NULL);
}
