/* States of window groups by the hour, from tables. */
#include <oriel/annual_report.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/number.h"

enum { MOST_ROWS = 35136 /* a leap year's quarters of hours */, NAME_SIZE = 80 };

struct table {
    const char *name, *at, *end;
    int line;
    const struct orl_window_group *group;
    size_t column; /* the group's */
    struct orl_error *err;
};

/* ---- Lines and fields ------------------------------------------------------------------------ */

struct span {
    const char *text;
    size_t length;
};

static struct span trim(struct span s)
{
    for (; s.length > 0 && (*s.text == ' ' || *s.text == '\t'); s.text++)
        s.length--;
    while (s.length > 0 && strchr(" \t\r", s.text[s.length - 1]))
        s.length--;
    return s;
}

/* The next line that is neither empty nor a remark; false: there is none. */
static bool next_line(struct table *t, struct span *ret_line)
{
    while (t->at < t->end) {
        const char *newline = memchr(t->at, '\n', (size_t)(t->end - t->at));
        const char *stop = newline ? newline : t->end;
        *ret_line = trim((struct span){t->at, (size_t)(stop - t->at)});
        t->at = newline ? newline + 1 : t->end;
        t->line++;
        if (ret_line->length > 0 && ret_line->text[0] != '#')
            return true;
    }
    return false;
}

/* Takes a field off a line, without its quotes; false: there is none left. */
static bool next_field(struct span *line, struct span *ret_field)
{
    if (!line->text)
        return false;
    const bool quoted = line->length > 0 && line->text[0] == '"';
    const char *from = line->text + quoted, *stop = line->text + line->length;
    const char *quote = quoted ? memchr(from, '"', (size_t)(stop - from)) : NULL;
    const char *comma =
        memchr(quote ? quote : line->text, ',', (size_t)(stop - (quote ? quote : line->text)));
    const char *to = quote ? quote : comma ? comma : stop;
    *ret_field =
        trim((struct span){quote ? from : line->text, (size_t)(to - (quote ? from : line->text))});
    *line = comma ? (struct span){comma + 1, (size_t)(stop - comma - 1)} : (struct span){NULL, 0};
    if (comma)
        for (; line->length > 0 && *line->text == ' '; line->text++)
            line->length--;
    return true;
}

static bool is_word(struct span field, const char *word)
{
    return field.length == strlen(word) && strncasecmp(field.text, word, field.length) == 0;
}

/* ---- States ---------------------------------------------------------------------------------- */

static int fail(const struct table *t, int code, const char *what, struct span field)
{
    const int length = field.length < NAME_SIZE ? (int)field.length : NAME_SIZE;
    orl_error_set(t->err, code, "%s '%.*s'", what, length, field.text ? field.text : "");
    orl_error_at(t->err, t->name, t->line, "schedule");
    return code;
}

/* A state by its name, or by its number from 0. */
static bool find_state(const struct orl_window_group *group, struct span field,
                       unsigned char *ret_state)
{
    int number = -1;
    for (size_t i = 0; i < group->n_states; i++)
        if (group->states[i].name && is_word(field, group->states[i].name)) {
            *ret_state = (unsigned char)i;
            return true;
        }
    if (orl_number_read_int(field.text, field.length, &number) != ORL_NUMBER_OK || number < 0 ||
        (size_t)number >= group->n_states)
        return false;
    *ret_state = (unsigned char)number;
    return true;
}

/* The group's column, by a first line that names it. The heading of a single column may be any word
 * but a number. */
static int find_column(struct table *t, bool *ret_is_head)
{
    struct table ahead = *t;
    struct span line, field, first = {"", 0};
    char shades[NAME_SIZE];
    unsigned char state;
    double number;
    size_t columns = 0;
    snprintf(shades, sizeof shades, "shades of %s", t->group->name);
    if (!next_line(&ahead, &line))
        return fail(t, ORL_ERR_SYNTAX, "the table is empty: no state of", first);
    for (; next_field(&line, &field); columns++) {
        if (columns == 0)
            first = field;
        if (is_word(field, t->group->name) || is_word(field, shades)) {
            t->column = columns;
            *ret_is_head = true;
            return 0;
        }
    }
    *ret_is_head = !find_state(t->group, first, &state) &&
                   orl_number_read(first.text, first.length, &number) == ORL_NUMBER_NOT_ONE;
    t->column = 0;
    t->line = ahead.line;
    const int code = columns == 1 ? 0
                                  : fail(t, ORL_ERR_SYNTAX, "no column of the table is named",
                                         (struct span){t->group->name, strlen(t->group->name)});
    t->line = 0;
    return code;
}

static int read_row(const struct table *t, struct span line, unsigned char *ret_state)
{
    struct span field = {NULL, 0};
    for (size_t i = 0; i <= t->column; i++)
        if (!next_field(&line, &field))
            return fail(t, ORL_ERR_SYNTAX, "the line is too short: no state of",
                        (struct span){t->group->name, strlen(t->group->name)});
    return find_state(t->group, field, ret_state)
               ? 0
               : fail(t, ORL_ERR_RANGE, "the group has no state", field);
}

static int read_rows(struct table *t, unsigned char *states, size_t *ret_count)
{
    struct span line;
    bool is_head = false;
    int code = find_column(t, &is_head);
    if (code == 0 && is_head)
        next_line(t, &line);
    while (code == 0 && next_line(t, &line)) {
        if (*ret_count == MOST_ROWS)
            return fail(t, ORL_ERR_LIMIT, "a year has no more than 35136 rows, not", line);
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
    struct table table = {.name = group->schedule_file,
                          .at = file.data,
                          .end = file.data + file.size,
                          .group = group,
                          .err = err};
    free(group->series);
    group->n_series = 0;
    group->series = calloc(MOST_ROWS, 1);
    code = group->series ? read_rows(&table, group->series, &group->n_series)
                         : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
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
