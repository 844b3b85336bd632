/* Maps the rows of a weather file to the steps of a year. */
#include <oriel/annual/annual_report.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/daylight/weather.h"
#include "metrics/annual/annual_figures.h"
#include "scene/generate/sky/sun.h"

static const double doubtful_deg = 3;
/* Rounding of times in hours; files print them with at least three decimals. */
static const double rounding_h = 0.001;

/* Returns the number of steps per hour, from the shortest gap between two rows of a day. */
static uint32_t find_per_hour(const struct orl_annual_result *result)
{
    double gap = 1;
    for (size_t i = 1; i < result->n_steps; i++) {
        const struct orl_annual_step *a = &result->steps[i - 1], *b = &result->steps[i];
        if (a->month == b->month && a->day == b->day && b->hour > a->hour)
            gap = fmin(gap, b->hour - a->hour);
    }
    return (uint32_t)lrint(fmin(60, 1 / gap));
}

/* Returns true if there is a row at midnight. Rows then are at 0, 1/4 h ..., not at the middles or
 * ends of their steps. Honeybee writes them so for steps below an hour. */
static bool has_midnight_row(const struct orl_annual_result *result)
{
    for (size_t i = 0; i < result->n_steps; i++)
        if (result->steps[i].hour < rounding_h)
            return true;
    return false;
}

static bool has_leap_day(const struct orl_annual_result *result)
{
    for (size_t i = 0; i < result->n_steps; i++)
        if (result->steps[i].month == 2 && result->steps[i].day == 29)
            return true;
    return false;
}

uint32_t orl_annual_step_of(const struct orl_annual_timeline *year,
                            const struct orl_annual_step *row)
{
    const struct orl_annual_steps *steps = &year->steps;
    const bool leap = steps->count == 8784 * steps->per_hour;
    const uint32_t day = (uint32_t)orl_weather_days_before(row->month, row->day, leap);
    const double time = steps->per_hour * row->hour, hair = steps->per_hour * rounding_h;
    const double last = 24.0 * steps->per_hour - 1;
    const double within = floor(time + (year->times_begin_steps ? hair : -hair));
    return day * 24 * steps->per_hour + (uint32_t)fmin(last, fmax(0, within));
}

/* Enters a row at its step; *next is the first free step. */
static int enter_row(const struct orl_annual_result *result, size_t i,
                     struct orl_annual_timeline *year, uint32_t *next, struct orl_error *err)
{
    const struct orl_annual_step *row = &result->steps[i];
    const uint32_t step = orl_annual_step_of(year, row);
    if (step >= year->steps.count || step < *next) {
        orl_error_set(err, ORL_ERR_RANGE,
                      "the weather file's row %zu (month %d, day %d, %g h) is out of order: annual "
                      "metrics need rows in order of time",
                      i + 1, row->month, row->day, row->hour);
        orl_error_hint(err, "sort the file's rows by time, with one row for each step of %g h",
                       1.0 / year->steps.per_hour);
        return ORL_ERR_RANGE;
    }
    *next = step + 1;
    year->measured[step] = !row->missing;
    year->global_lx[step] = row->missing ? 0 : row->global_lx;
    year->diffuse_lx[step] = row->missing ? 0 : row->diffuse_lx;
    year->n_missing -= !row->missing;
    year->n_doubtful +=
        !row->missing && row->column == ORL_ANNUAL_DARK && row->sun_altitude_deg >= doubtful_deg;
    if (row->column != ORL_ANNUAL_DARK) {
        year->step_of_column[row->column] = step;
        year->sunny[row->column] = row->direct_normal_lx > 0;
    }
    return 0;
}

/* ---- Nights ---------------------------------------------------------------------------------- */

static bool is_night(const struct orl_annual_result *result, const struct orl_annual_steps *steps,
                     uint32_t step)
{
    static const double set_rad = -0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD;
    const struct orl_location site = {result->site.latitude_deg * ORL_DEG_TO_RAD,
                                      -result->site.longitude_deg * ORL_DEG_TO_RAD,
                                      -15 * result->site.time_zone_h * ORL_DEG_TO_RAD};
    const struct orl_calendar_day day = orl_calendar_day_of(steps, step);
    const struct orl_moment moment = {
        .month = day.month, .day = day.day, .hour = orl_calendar_hour_of(steps, step)};
    return orl_sun_accurate(&site, &moment).altitude_rad < set_rad;
}

/* Marks night steps without a row as measured, because they are dark. This applies on days that
 * have other rows, and on days without a sunrise. */
static void fill_nights(const struct orl_annual_result *result, struct orl_annual_timeline *year)
{
    const uint32_t a_day = 24 * year->steps.per_hour;
    for (uint32_t first = 0; first < year->steps.count; first += a_day) {
        bool rows = false, sunny = false;
        for (uint32_t i = first; i < first + a_day; i++) {
            rows = rows || year->measured[i];
            sunny = sunny || !is_night(result, &year->steps, i);
        }
        for (uint32_t i = first; (rows || !sunny) && i < first + a_day; i++)
            if (!year->measured[i] && is_night(result, &year->steps, i)) {
                year->measured[i] = 1;
                year->n_missing--;
            }
    }
}

int orl_annual_timeline_make(const struct orl_annual_result *result,
                             struct orl_annual_timeline *ret_year, struct orl_error *err)
{
    const uint32_t per_hour = find_per_hour(result);
    const uint32_t count = (has_leap_day(result) ? 8784 : 8760) * per_hour;
    struct orl_annual_timeline year = {
        .steps = {count, per_hour},
        .times_begin_steps = has_midnight_row(result),
        .measured = calloc(count, 1),
        .global_lx = calloc(count, sizeof *year.global_lx),
        .diffuse_lx = calloc(count, sizeof *year.diffuse_lx),
        .step_of_column = calloc(result->n_columns + 1, sizeof *year.step_of_column),
        .sunny = calloc(result->n_columns + 1, 1),
        .n_columns = result->n_columns,
        .n_missing = count};
    uint32_t next = 0;
    int code = 0;
    if (!year.measured || !year.global_lx || !year.diffuse_lx || !year.step_of_column ||
        !year.sunny) {
        orl_annual_timeline_done(&year);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    for (size_t i = 0; i < result->n_steps && code == 0; i++)
        code = enter_row(result, i, &year, &next, err);
    if (code == 0 && year.n_missing > 0)
        fill_nights(result, &year);
    if (code < 0)
        orl_annual_timeline_done(&year);
    else
        *ret_year = year;
    return code;
}

void orl_annual_timeline_done(struct orl_annual_timeline *year)
{
    if (!year)
        return;
    free(year->measured);
    free(year->global_lx);
    free(year->diffuse_lx);
    free(year->step_of_column);
    free(year->sunny);
    *year = (struct orl_annual_timeline){.measured = NULL};
}
