/* The order of a weather file's rows: that of the calendar, from 1 January to 31 December. */
#ifndef ORL_LIGHT_WEATHER_ORDER_H
#define ORL_LIGHT_WEATHER_ORDER_H

#include "light/weather.h"

/* Returns the days from 1 January to a date. leap: the year has 29 February. */
int orl_weather_days_before(int month, int day, bool leap);

/* Returns true if there is a row of 29 February. */
bool orl_weather_has_leap_day(const struct orl_weather *weather);

/*
 * Moves rows after hour 24 to the next day, as DAYSIM defines them. A file may continue once from
 * 31 December to 1 January, as from July to June: then the rows from 1 January on are put first,
 * and counted in n_moved. Rows in any other order stay as they are. Returns 0, ORL_ERR_NOMEM, or
 * ORL_ERR_RANGE if two rows have the same time.
 */
int orl_weather_sort_rows(struct orl_weather *weather, const char *name, struct orl_error *err);

#endif
