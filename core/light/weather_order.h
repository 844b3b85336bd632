/*
 * The order of a weather file's rows: that of the calendar, from 1 January to 31 December.
 */
#ifndef ORL_LIGHT_WEATHER_ORDER_H
#define ORL_LIGHT_WEATHER_ORDER_H

#include "light/weather.h"

/* Days from 1 January to a date; a year of 366 days has 29 February. */
int orl_weather_days_before(int month, int day, bool leap);

/* Is there a row of 29 February? */
bool orl_weather_has_leap_day(const struct orl_weather *weather);

/*
 * Gives rows after hour 24 to the next day, as DAYSIM means them. If the file goes on from
 * 31 December to 1 January once, as from July to June, puts the rows from 1 January on first and
 * counts them in n_moved. Rows in any other order stay as they are. ORL_ERR_RANGE: two rows have
 * the same time.
 */
int orl_weather_arrange(struct orl_weather *weather, const char *name, struct orl_error *err);

#endif
