#include "light/daylight/weather.h"

#include <stdlib.h>
#include <string.h>

enum { MONTHS = 12 };
static const short first_days[MONTHS + 1] = {0,   31,  59,  90,  120, 151, 181,
                                             212, 243, 273, 304, 334, 365};
static const double day_h = 24;

int orl_weather_days_before(int month, int day, bool leap)
{
    return first_days[month - 1] + (leap && month > 2) + day - 1;
}

bool orl_weather_has_leap_day(const struct orl_weather *weather)
{
    for (size_t i = 0; i < weather->n_rows; i++)
        if (weather->rows[i].month == 2 && weather->rows[i].day == 29)
            return true;
    return false;
}

/* ---- Times past midnight --------------------------------------------------------------------- */

static void go_to_next_day(struct orl_weather_row *row, bool leap)
{
    const int days =
        first_days[row->month] - first_days[row->month - 1] + (leap && row->month == 2);
    row->hour -= day_h;
    if (row->day++ < days)
        return;
    row->day = 1;
    row->month = row->month % MONTHS + 1;
}

/* ---- Order ----------------------------------------------------------------------------------- */

/* Returns the hours since the year began, counted as in a leap year. */
static double time_of(const struct orl_weather_row *row)
{
    return orl_weather_days_before(row->month, row->day, true) * day_h + row->hour;
}

/* Counts the rows that are not later than the one before; *ret_last is the index of the last of
 * them. */
static size_t count_steps_back(const struct orl_weather *weather, size_t *ret_last)
{
    size_t count = 0;
    for (size_t i = 1; i < weather->n_rows; i++)
        if (time_of(&weather->rows[i]) <= time_of(&weather->rows[i - 1])) {
            *ret_last = i;
            count++;
        }
    return count;
}

/* Moves the rows from index `from` on to the front. */
static bool move_to_front(struct orl_weather *weather, size_t from)
{
    const size_t n = weather->n_rows - from;
    struct orl_weather_row *moved = malloc(n * sizeof *moved);
    if (!moved)
        return false;
    memcpy(moved, weather->rows + from, n * sizeof *moved);
    memmove(weather->rows + n, weather->rows, from * sizeof *moved);
    memcpy(weather->rows, moved, n * sizeof *moved);
    weather->n_moved = n;
    free(moved);
    return true;
}

static int by_time(const void *a, const void *b)
{
    const struct orl_weather_row *x = a, *y = b;
    const double t = time_of(x), u = time_of(y);
    return t != u ? (t > u) - (t < u) : (x->line > y->line) - (x->line < y->line);
}

static int refuse_same_times(const char *name, const struct orl_weather_row *first,
                             const struct orl_weather_row *second, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_RANGE,
                  "lines %d and %d have the same time: month %d, day %d, hour %g", first->line,
                  second->line, first->month, first->day, first->hour);
    orl_error_at(err, name, second->line, NULL);
    orl_error_hint(err, "keep one row for each time; if the file has several years, keep one year");
    return ORL_ERR_RANGE;
}

/* Checks that no two rows have the same time, in any order of the rows. */
static int check_times(const struct orl_weather *weather, const char *name, struct orl_error *err)
{
    const size_t n = weather->n_rows;
    struct orl_weather_row *sorted = malloc(n * sizeof *sorted);
    int code = 0;
    if (!sorted)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(sorted, weather->rows, n * sizeof *sorted);
    qsort(sorted, n, sizeof *sorted, by_time);
    for (size_t i = 1; i < n && code == 0; i++)
        if (time_of(&sorted[i]) == time_of(&sorted[i - 1]))
            code = refuse_same_times(name, &sorted[i - 1], &sorted[i], err);
    free(sorted);
    return code;
}

int orl_weather_sort_rows(struct orl_weather *weather, const char *name, struct orl_error *err)
{
    const bool leap = orl_weather_has_leap_day(weather);
    size_t back = 0;
    for (size_t i = 0; i < weather->n_rows; i++)
        if (weather->rows[i].hour >= day_h)
            go_to_next_day(&weather->rows[i], leap);
    const size_t steps_back = count_steps_back(weather, &back);
    if (steps_back == 0)
        return 0;
    if (steps_back > 1 || time_of(&weather->rows[weather->n_rows - 1]) >= time_of(weather->rows))
        return check_times(weather, name, err);
    return move_to_front(weather, back) ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}
