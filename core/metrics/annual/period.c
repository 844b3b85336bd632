/* Steps of a year that count. */
#include <oriel/annual/annual_metrics.h>

#include <stdlib.h>
#include <string.h>

#include "metrics/annual/calendar.h"

enum { YEAR_H = 8760, LEAP_YEAR_H = 8784, MOST_STEPS_AN_HOUR = 60 };

int orl_annual_steps_check(const struct orl_annual_steps *steps, struct orl_error *err)
{
    if (steps->per_hour >= 1 && steps->per_hour <= MOST_STEPS_AN_HOUR &&
        (steps->count == YEAR_H * steps->per_hour || steps->count == LEAP_YEAR_H * steps->per_hour))
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE,
                         "%u steps, %u an hour, are no year: it has %d hours, or %d with 29 "
                         "February",
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
