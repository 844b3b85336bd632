/* When a room is in use: by the clock, or by a file. */
#include <oriel/annual_metrics.h>

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "metrics/annual/calendar.h"

void orl_occupancy_init(struct orl_occupancy *occupancy)
{
    *occupancy = (struct orl_occupancy){
        .from_h = 8, .to_h = 18, .days = 0x7f, .first_day = ORL_FIRST_DAY_OF_WEATHER};
}

void orl_occupancy_mark(const struct orl_occupancy *occupancy, const struct orl_annual_steps *steps,
                        unsigned char *ret_marks)
{
    const double from = occupancy->from_h, to = occupancy->to_h;
    for (uint32_t i = 0; i < steps->count; i++) {
        const double hour = orl_calendar_hour_of(steps, i);
        const unsigned day = (i / (24 * steps->per_hour) + occupancy->first_day) % 7;
        const bool within = to >= from ? hour >= from && hour < to : hour >= from || hour < to;
        ret_marks[i] = within && (occupancy->days >> day & 1);
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

enum { MOST_FIELDS = 4 };

struct reading {
    const char *name;
    const struct orl_annual_steps *steps;
    unsigned char *marks;
    struct orl_annual_steps lines; /* the year in steps of a line each */
    uint32_t count;
    int fields; /* of a line, all alike; 0: none was read yet */
    int line;   /* in the file */
    bool has_words;
    struct orl_error *err;
};

static int complain(const struct reading *r, int code, const char *what)
{
    orl_error_set(r->err, code, "%s", what);
    orl_error_at(r->err, r->name, r->line, NULL);
    return code;
}

/* The numbers of a line, between commas, semicolons or space; -1: something else. */
static int split(const char *text, size_t size, double ret_values[MOST_FIELDS])
{
    static const char between[] = ",; \t\r";
    int n = 0;
    for (size_t at = 0; at < size;) {
        size_t length = 0;
        while (at + length < size && !memchr(between, text[at + length], sizeof between - 1))
            length++;
        if (length > 0 && (n == MOST_FIELDS ||
                           orl_number_read(text + at, length, &ret_values[n++]) != ORL_NUMBER_OK))
            return -1;
        at += length + 1;
    }
    return n;
}

/* How fine the file is, by its first line's hour: 0.5, or 0.25 for half hours. */
static int find_resolution(struct reading *r, double hour)
{
    const double per_hour = hour > 0 && hour < 0.5 ? round(0.5 / hour) : 1;
    if (per_hour != 1 && per_hour != r->steps->per_hour)
        return complain(r, ORL_ERR_RANGE, "the file's steps are not those of the year");
    r->lines.per_hour = (uint32_t)per_hour;
    r->lines.count = r->steps->count / r->steps->per_hour * (uint32_t)per_hour;
    return 0;
}

static int check_time(struct reading *r, const double values[MOST_FIELDS])
{
    int code = r->count == 0 ? find_resolution(r, values[2]) : 0;
    if (code < 0)
        return code;
    const struct orl_calendar_day day = orl_calendar_day_of(&r->lines, r->count);
    const double middle = orl_calendar_hour_of(&r->lines, r->count);
    if (values[0] == day.month && values[1] == day.day &&
        fabs(values[2] - middle) <= 0.5 / r->lines.per_hour + 1e-6)
        return 0;
    complain(r, ORL_ERR_RANGE, "this is not the time of the line");
    orl_error_hint(r->err, "%d,%d,%g is wanted here: month, day, hour of the middle", day.month,
                   day.day, middle);
    return ORL_ERR_RANGE;
}

/* The first field is a number, maybe "nan" or "inf", or a misspelt one. */
static bool begins_number(const char *text, size_t size)
{
    const char c = text[0];
    double value;
    size_t length = 0;
    while (length < size && !strchr(", \t\r;", text[length]))
        length++;
    return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-' || c == ' ' || c == '\t' ||
           orl_number_read(text, length, &value) != ORL_NUMBER_NOT_ONE;
}

static int read_line(struct reading *r, const char *text, size_t size)
{
    double values[MOST_FIELDS];
    const int n = split(text, size, values);
    if (n == 0 || (size > 0 && text[0] == '#'))
        return 0;
    if (n < 0 && r->count == 0 && !r->has_words && !begins_number(text, size)) {
        r->has_words = true;
        return 0;
    }
    if (n != 1 && n != MOST_FIELDS)
        return complain(r, ORL_ERR_SYNTAX, "one number is wanted, or \"month,day,hour,value\"");
    if (r->fields != 0 && n != r->fields)
        return complain(r, ORL_ERR_SYNTAX,
                        "lines of one number and \"month,day,hour,value\" are mixed");
    r->fields = n;
    if (r->count == r->steps->count)
        return complain(r, ORL_ERR_RANGE, "the file has more lines than the year has steps");
    const int code = n == MOST_FIELDS ? check_time(r, values) : 0;
    if (code == 0)
        r->marks[r->count++] = values[n - 1] > 0;
    return code;
}

/* Hours to the steps of each, from the last one on. */
static void stretch(unsigned char *marks, const struct orl_annual_steps *steps)
{
    for (uint32_t i = steps->count; i-- > 0;)
        marks[i] = marks[i / steps->per_hour];
}

static int complain_count(const struct reading *r)
{
    orl_error_set(r->err, ORL_ERR_RANGE, "the file has %u lines, and the year %u steps", r->count,
                  r->steps->count);
    orl_error_at(r->err, r->name, 0, NULL);
    orl_error_hint(r->err, "a line for each hour of the weather file's year is wanted: %u",
                   r->steps->count / r->steps->per_hour);
    return ORL_ERR_RANGE;
}

int orl_occupancy_read(const char *name, const char *text, size_t size,
                       const struct orl_annual_steps *steps, unsigned char *ret_marks,
                       struct orl_error *err)
{
    struct reading r = {.name = name, .steps = steps, .marks = ret_marks, .err = err};
    int code = 0;
    const bool marked = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0; /* UTF-8's mark */
    for (size_t at = marked ? 3 : 0; at < size && code == 0;) {
        const char *end = memchr(text + at, '\n', size - at);
        const size_t length = end ? (size_t)(end - (text + at)) : size - at;
        r.line++;
        code = read_line(&r, text + at, length);
        at += length + 1;
    }
    if (code < 0)
        return code;
    if (r.count != steps->count && r.count * (uint64_t)steps->per_hour != steps->count)
        return complain_count(&r);
    if (r.count != steps->count)
        stretch(ret_marks, steps);
    return 0;
}
