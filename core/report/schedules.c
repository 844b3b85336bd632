/* Reads the states of window groups by hour from tables. */
#include <oriel/annual/annual_report.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

#include "base/text/words.h"

enum { MOST_ROWS = ORL_LIMIT_YEAR_ROWS, NAME_SIZE = 80 };

struct table {
    struct orl_scanner scanner;
    const struct orl_window_group *group;
    char separator;
    size_t column;    /* the group's column */
    size_t n_columns; /* columns of the first line */
    struct orl_error *err;
};

/* Reads the next line that is neither empty nor a comment; returns false at the end. */
static bool next_line(struct table *t, struct orl_slice *ret_line)
{
    while (orl_scanner_line(&t->scanner, ret_line)) {
        *ret_line = orl_slice_trim(*ret_line);
        if (ret_line->length > 0 && ret_line->text[0] != '#')
            return true;
    }
    return false;
}

/* ---- States ---------------------------------------------------------------------------------- */

static int fail_in_table(const struct table *t, int code, const char *what, struct orl_slice field)
{
    const int length = field.length < NAME_SIZE ? (int)field.length : NAME_SIZE;
    orl_error_set(t->err, code, "%s '%.*s'", what, length, field.text ? field.text : "");
    orl_error_at(t->err, t->scanner.name, t->scanner.line, "schedule");
    return code;
}

/* Finds a state by its name, or by its number from 0. */
static bool find_state(const struct orl_window_group *group, struct orl_slice field,
                       unsigned char *ret_state)
{
    int number = -1;
    for (size_t i = 0; i < group->n_states; i++)
        if (group->states[i].name && orl_slice_is_nocase(field, group->states[i].name)) {
            *ret_state = (unsigned char)i;
            return true;
        }
    if (orl_number_read_int(field.text, field.length, &number) != ORL_NUMBER_OK || number < 0 ||
        (size_t)number >= group->n_states)
        return false;
    *ret_state = (unsigned char)number;
    return true;
}

static int fail_no_line(const struct table *t)
{
    orl_error_set(t->err, ORL_ERR_SYNTAX, "the table is empty: it has no state of '%s'",
                  t->group->name);
    orl_error_at(t->err, t->scanner.name, 0, "schedule");
    return ORL_ERR_SYNTAX;
}

static int fail_no_column(const struct table *t)
{
    return fail_in_table(t, ORL_ERR_SYNTAX, "no column of the table is named",
                         (struct orl_slice){t->group->name, strlen(t->group->name)});
}

/* Finds the group's column by a first line that names it. The heading of a single column may be any
 * word that is no number. */
static int find_column(struct table *t, bool *ret_is_head)
{
    struct table ahead = *t;
    struct orl_slice line, field, first = {"", 0};
    char shades[NAME_SIZE];
    unsigned char state;
    double number;
    bool named = false;
    snprintf(shades, sizeof shades, "shades of %s", t->group->name);
    if (!next_line(&ahead, &line))
        return fail_no_line(t);
    t->separator = orl_slice_before(line, ',').length == line.length &&
                           orl_slice_before(line, ';').length < line.length
                       ? ';'
                       : ',';
    while (orl_slice_take_cell(&line, t->separator, &field)) {
        if (t->n_columns == 0)
            first = field;
        if (!named &&
            (orl_slice_is_nocase(field, t->group->name) || orl_slice_is_nocase(field, shades))) {
            t->column = t->n_columns;
            named = true;
        }
        t->n_columns++;
    }
    *ret_is_head =
        named || (!find_state(t->group, first, &state) &&
                  orl_number_read(first.text, first.length, &number) == ORL_NUMBER_INVALID);
    return named || t->n_columns == 1 ? 0 : fail_no_column(&ahead);
}

/* Refuses a line with too many fields, which a decimal comma may cause. */
static int refuse_fields(const struct table *t, struct orl_slice line)
{
    fail_in_table(t, ORL_ERR_SYNTAX, "the line has more fields than the first:", line);
    orl_error_hint(t->err, orl_slice_is_decimal_comma(line)
                               ? "this is a decimal comma, and states are names or whole numbers"
                               : "put double quotes around texts that contain a comma");
    return ORL_ERR_SYNTAX;
}

static int read_row(const struct table *t, struct orl_slice line, unsigned char *ret_state)
{
    struct orl_slice rest = line, field, state = {NULL, 0};
    size_t n = 0;
    for (; orl_slice_take_cell(&rest, t->separator, &field); n++) {
        if (n == t->column)
            state = field;
        if (n >= t->n_columns && field.length > 0)
            return refuse_fields(t, line);
    }
    if (n <= t->column)
        return fail_in_table(t, ORL_ERR_SYNTAX, "the line is too short: no state of",
                             (struct orl_slice){t->group->name, strlen(t->group->name)});
    if (find_state(t->group, state, ret_state))
        return 0;
    fail_in_table(t, ORL_ERR_RANGE, "the group has no state", state);
    if (state.length == 0)
        orl_error_hint(t->err, "this is an empty cell: write a state's name or number");
    else if (orl_slice_is_decimal_comma(state))
        orl_error_hint(t->err, "this is a decimal comma, and states are names or whole numbers");
    return ORL_ERR_RANGE;
}

static int read_rows(struct table *t, unsigned char *states, size_t *ret_count)
{
    struct orl_slice line;
    bool is_head = false;
    int code = find_column(t, &is_head);
    if (code == 0 && is_head)
        next_line(t, &line);
    while (code == 0 && next_line(t, &line)) {
        if (*ret_count == MOST_ROWS)
            return fail_in_table(t, ORL_ERR_LIMIT,
                                 "a year has at most 52704 rows, and the first extra one is", line);
        code = read_row(t, line, &states[(*ret_count)++]);
    }
    return code;
}

/* ---- Files ----------------------------------------------------------------------------------- */

static int read_group(struct orl_window_group *group, const struct orl_files *files,
                      struct orl_error *err)
{
    struct orl_file file;
    int code = files->open(files->ctx, group->schedule_file, &file, err);
    if (code < 0)
        return code;
    struct table table = {.group = group, .err = err};
    free(group->series);
    group->n_series = 0;
    group->series = calloc(MOST_ROWS, 1);
    if (!group->series)
        orl_error_set(err, code = ORL_ERR_NOMEM, "out of memory");
    if (code == 0)
        code = orl_scanner_init(&table.scanner, group->schedule_file, file.data, file.size, 0, err);
    if (code == 0)
        code = read_rows(&table, group->series, &group->n_series);
    files->close(files->ctx, &file);
    return code;
}

int orl_annual_schedules_read(struct orl_annual_request *request, const struct orl_files *files,
                              struct orl_error *err)
{
    int code = 0;
    for (size_t g = 0; g < request->n_groups && code == 0; g++)
        if (request->groups[g].schedule_file)
            code = read_group(&request->groups[g], files, err);
    return code;
}
