/* Steps of a year that count: periods, and hours of use of a room. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_metrics.h>
#include <oriel/base/scanner.h>

#include "base/text/words.h"
#include "metrics/annual/annual_figures.h"

enum { YEAR_H = 8760, LEAP_YEAR_H = 8784, MOST_STEPS_AN_HOUR = 60 };

int orl_annual_steps_check(const struct orl_annual_steps *steps, struct orl_error *err)
{
    if (steps->per_hour >= 1 && steps->per_hour <= MOST_STEPS_AN_HOUR &&
        (steps->count == YEAR_H * steps->per_hour || steps->count == LEAP_YEAR_H * steps->per_hour))
        return 0;
    return orl_error_set(
        err, ORL_ERR_RANGE,
        "%u steps, %u per hour, are not a year: it has %d hours, or %d with 29 February",
        steps->count, steps->per_hour, YEAR_H, LEAP_YEAR_H);
}

struct orl_calendar_day orl_calendar_day_of(const struct orl_annual_steps *steps, uint32_t step)
{
    static const int lengths[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const bool leap = steps->count > YEAR_H * steps->per_hour;
    int day = (int)(step / (24 * steps->per_hour)), month = 0;
    while (month < 11 && day >= lengths[month] + (leap && month == 1)) {
        day -= lengths[month] + (leap && month == 1);
        month++;
    }
    return (struct orl_calendar_day){month + 1, day + 1};
}

double orl_calendar_hour_of(const struct orl_annual_steps *steps, uint32_t step)
{
    return (step % (24 * steps->per_hour) + 0.5) / steps->per_hour;
}

const char *orl_annual_when_name(enum orl_annual_when when)
{
    static const char *const names[ORL_WHEN_COUNT] = {"occupied", "daylight", "year"};
    return names[when];
}

/* ---- Daylight hours -------------------------------------------------------------------------- */

struct ranked {
    double light;
    uint32_t step;
};

static int brighter_first(const void *a, const void *b)
{
    const struct ranked *x = a, *y = b;
    if (x->light != y->light)
        return x->light > y->light ? -1 : 1;
    return x->step < y->step ? -1 : 1;
}

int orl_annual_daylight_mark(const double *global, const unsigned char *measured,
                             const struct orl_annual_steps *steps, unsigned char *ret_marks,
                             struct orl_error *err)
{
    struct ranked *all = calloc(steps->count, sizeof *all);
    uint32_t n = 0;
    if (!all)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory ranking a year's hours");
    for (uint32_t i = 0; i < steps->count; i++)
        if (!measured || measured[i])
            all[n++] = (struct ranked){global[i], i};
    qsort(all, n, sizeof *all, brighter_first);
    memset(ret_marks, 0, steps->count);
    for (uint32_t i = 0; i < n / 2; i++)
        ret_marks[all[i].step] = 1;
    free(all);
    return 0;
}

/* ---- Periods --------------------------------------------------------------------------------- */

int orl_annual_period_make(const unsigned char *marks, const struct orl_annual_steps *steps,
                           const uint32_t *step_of, size_t n, struct orl_annual_period *ret_period,
                           struct orl_error *err)
{
    struct orl_annual_period period = {.columns = calloc(n + 1, sizeof *period.columns),
                                       .step_h = 1.0 / steps->per_hour};
    uint64_t counted = marks ? 0 : steps->count;
    if (!period.columns)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (uint32_t i = 0; marks && i < steps->count; i++)
        counted += marks[i] != 0;
    for (size_t i = 0; i < n; i++)
        if (!marks || marks[step_of[i]])
            period.columns[period.n_columns++] = (uint32_t)i;
    period.hours = (double)counted / steps->per_hour;
    *ret_period = period;
    return 0;
}

void orl_annual_period_done(struct orl_annual_period *period)
{
    if (!period)
        return;
    free(period->columns);
    *period = (struct orl_annual_period){.columns = NULL};
}

/* ---- Hours of use, by weekdays and hours ----------------------------------------------------- */

void orl_occupancy_init(struct orl_occupancy *occupancy)
{
    *occupancy = (struct orl_occupancy){
        .from_h = 8, .to_h = 18, .days = 0x7f, .first_day = ORL_FIRST_DAY_OF_WEATHER};
}

/* Returns 0 Monday ... 6 Sunday. */
static unsigned weekday_of(const struct orl_occupancy *occupancy,
                           const struct orl_annual_steps *steps, uint32_t day)
{
    const uint32_t days = steps->count / (24 * steps->per_hour), weeks_d = 7 * 53;
    const bool is_before = occupancy->begins_day > 0 && day >= occupancy->begins_day;
    return (day + occupancy->first_day + (is_before ? weeks_d - days : 0)) % 7;
}

void orl_occupancy_mark(const struct orl_occupancy *occupancy, const struct orl_annual_steps *steps,
                        unsigned char *ret_marks)
{
    const double from = occupancy->from_h, to = occupancy->to_h;
    for (uint32_t i = 0; i < steps->count; i++) {
        const double hour = orl_calendar_hour_of(steps, i);
        const unsigned day = weekday_of(occupancy, steps, i / (24 * steps->per_hour));
        const bool within = to >= from ? hour >= from && hour < to : hour >= from || hour < to;
        ret_marks[i] = within && (occupancy->days >> day & 1);
    }
}

/* ---- Hours of use, from a file --------------------------------------------------------------- */

enum { MOST_FIELDS = 4 };

struct occupancy_reader {
    struct orl_scanner scanner;
    const struct orl_annual_steps *steps;
    unsigned char *marks;
    struct orl_annual_steps lines; /* year divided into one step per line */
    uint32_t count;
    int fields; /* fields per line, the same in all lines; 0: no line was read yet */
    bool has_words;
    struct orl_error *err;
};

static int report_line_error(const struct occupancy_reader *r, int code, const char *what)
{
    return orl_scanner_fail(&r->scanner, code, r->err, "%s", what);
}

/* Finds the resolution of the file from the hour of its first line: 0.5 for hours, 0.25 for half
 * hours. */
static int find_resolution(struct occupancy_reader *r, double hour)
{
    const double per_hour = hour > 0 && hour < 0.5 ? round(0.5 / hour) : 1;
    if (per_hour != 1 && per_hour != r->steps->per_hour)
        return report_line_error(r, ORL_ERR_RANGE, "the file's time steps differ from the year's");
    r->lines.per_hour = (uint32_t)per_hour;
    r->lines.count = r->steps->count / r->steps->per_hour * (uint32_t)per_hour;
    return 0;
}

static int check_time(struct occupancy_reader *r, const double values[MOST_FIELDS])
{
    int code = r->count == 0 ? find_resolution(r, values[2]) : 0;
    if (code < 0)
        return code;
    const struct orl_calendar_day day = orl_calendar_day_of(&r->lines, r->count);
    const double middle = orl_calendar_hour_of(&r->lines, r->count);
    if (values[0] == day.month && values[1] == day.day &&
        fabs(values[2] - middle) <= 0.5 / r->lines.per_hour + 1e-6)
        return 0;
    report_line_error(r, ORL_ERR_RANGE, "the line has the wrong time");
    orl_error_hint(r->err, "%d,%d,%g is expected here: month, day, hour at the middle of the step",
                   day.month, day.day, middle);
    return ORL_ERR_RANGE;
}

/* Returns true if the first field is a number, including "nan", "inf" and misspelt numbers. */
static bool begins_number(struct orl_slice line)
{
    struct orl_cells cells;
    struct orl_slice cell = {NULL, 0};
    double value;
    orl_cells_init(&cells, line);
    if (!orl_cells_next(&cells, &cell) || cell.length == 0)
        return true;
    const char c = cell.text[0];
    return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-' ||
           orl_number_read(cell.text, cell.length, &value) != ORL_NUMBER_INVALID;
}

/* Splits a line into numbers separated by commas, semicolons or blanks. Returns their count, or an
 * error. */
static int split_line(struct occupancy_reader *r, struct orl_slice line,
                      double ret_values[MOST_FIELDS])
{
    struct orl_cells cells;
    struct orl_slice cell;
    double value = 0;
    int n = 0;
    orl_cells_init(&cells, line);
    for (; orl_cells_next(&cells, &cell); n++) {
        const int code = orl_scanner_number(&r->scanner, cell, NULL, &value, r->err);
        if (code < 0)
            return code;
        if (n < MOST_FIELDS)
            ret_values[n] = value;
    }
    if (n == 2 && orl_slice_is_decimal_comma(line))
        return orl_scanner_number(&r->scanner, line, NULL, &value, r->err);
    return n;
}

static int read_line(struct occupancy_reader *r, struct orl_slice line)
{
    double values[MOST_FIELDS] = {0};
    line = orl_slice_trim(line);
    if (line.length == 0 || line.text[0] == '#')
        return 0;
    if (r->count == 0 && !r->has_words && !begins_number(line)) {
        r->has_words = true;
        return 0;
    }
    const int n = split_line(r, line, values);
    if (n < 0)
        return n;
    if (n != 1 && n != MOST_FIELDS)
        return report_line_error(r, ORL_ERR_SYNTAX,
                                 "one number is expected, or \"month,day,hour,value\"");
    if (r->fields != 0 && n != r->fields)
        return report_line_error(r, ORL_ERR_SYNTAX,
                                 "lines of one number and \"month,day,hour,value\" are mixed");
    r->fields = n;
    if (r->count == r->steps->count)
        return report_line_error(r, ORL_ERR_RANGE,
                                 "the file has more lines than the year has steps");
    const int code = n == MOST_FIELDS ? check_time(r, values) : 0;
    if (code == 0)
        r->marks[r->count++] = values[n - 1] > 0;
    return code;
}

static int report_line_count(const struct occupancy_reader *r)
{
    orl_error_set(r->err, ORL_ERR_RANGE, "the file has %u lines, but the year has %u steps",
                  r->count, r->steps->count);
    orl_error_at(r->err, r->scanner.name, 0, NULL);
    orl_error_hint(r->err, "give one line per hour of the weather file's year: %u",
                   r->steps->count / r->steps->per_hour);
    return ORL_ERR_RANGE;
}

int orl_occupancy_read(const char *name, const char *text, size_t size,
                       const struct orl_annual_steps *steps, unsigned char *ret_marks,
                       struct orl_error *err)
{
    struct occupancy_reader r = {.steps = steps, .marks = ret_marks, .err = err};
    struct orl_slice line;
    int code = orl_scanner_init(&r.scanner, name, text, size, 0, err);
    while (code == 0 && orl_scanner_line(&r.scanner, &line))
        code = read_line(&r, line);
    if (code < 0)
        return code;
    if (r.count != steps->count && r.count * (uint64_t)steps->per_hour != steps->count)
        return report_line_count(&r);
    /* Hourly marks are copied to the steps of each hour, from the last one on. */
    for (uint32_t i = r.count != steps->count ? steps->count : 0; i-- > 0;)
        ret_marks[i] = ret_marks[i / steps->per_hour];
    return 0;
}
