/* Converts steps of a year to days and hours. */
#ifndef ORL_METRICS_ANNUAL_CALENDAR_H
#define ORL_METRICS_ANNUAL_CALENDAR_H

#include <oriel/annual/annual_metrics.h>

struct orl_calendar_day {
    int month, day; /* both from 1 */
};
struct orl_calendar_day orl_calendar_day_of(const struct orl_annual_steps *steps, uint32_t step);

/* Return the middle of a step: hours since the year began, and hours since midnight. */
static inline double orl_calendar_hour_of_year(const struct orl_annual_steps *steps, uint32_t step)
{
    return (step + 0.5) / steps->per_hour;
}
double orl_calendar_hour_of(const struct orl_annual_steps *steps, uint32_t step);

#endif
