/*
 * Weather files: EPW (EnergyPlus) and WEA (DAYSIM, gendaymtx), as far as skies need them: the site,
 * and for each row the time and two measures of sun and sky.
 *
 * Conventions: longitude in degrees EAST and time zone in hours EAST of Greenwich, whatever the
 * file has (EPW: both east; WEA: degrees west both). Times are the middle of the interval a row
 * stands for: an EPW row of hour 12 is the mean from 11 to 12 and is at 11.5 here (of two rows an
 * hour: at 11.25 and 11.75); WEA files say 11.5 themselves, and up to 25 for what follows midnight
 * (DAYSIM), which is of the next day here. A day of 29 February is kept when the file has it.
 *
 * Years: no two rows are of the same time, whatever their years. If an EPW has rows of one month,
 * day and hour in several years, the caller chooses a year. A year may go on over 31 December, as
 * from July to June: rows are in the order of the calendar here, from 1 January.
 *
 * Invariants: every number is finite; months are 1..12, days exist in a leap year, hours lie in
 * [0, 24]. Values that the file marks as missing (9999 and above, or -90 and
 * below) are missing here, never numbers.
 * Errors: ORL_ERR_SYNTAX, _RANGE, _INVALID (a year of a WEA file), _LIMIT, with file and line.
 * Threads: none kept; a parsed file is immutable. References: EnergyPlus, "Auxiliary Programs",
 * chapter on weather data; gendaymtx(1) of Radiance.
 */
#ifndef ORL_LIGHT_WEATHER_H
#define ORL_LIGHT_WEATHER_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/sky.h>

/* What the two numbers of a row are; the values are WEA's weather_data_file_units. */
enum orl_weather_units {
    ORL_WEATHER_NORMAL_W = 1,     /* direct normal and diffuse horizontal irradiance, W/m2 */
    ORL_WEATHER_HORIZONTAL_W = 2, /* direct horizontal and diffuse horizontal irradiance, W/m2 */
    ORL_WEATHER_NORMAL_LX = 3,    /* direct normal and diffuse horizontal illuminance, lx */
};

struct orl_weather_row {
    int year; /* 0: the file has none, as WEA */
    int month, day;
    int line; /* in the file, from 1 */
    bool missing;
    double hour; /* the middle of its interval */
    double direct, diffuse;
    double global; /* irradiance of the horizontal, W/m2; NaN: the file has none, as WEA */
};

struct orl_weather {
    double latitude_deg, longitude_deg, time_zone_h;
    enum orl_weather_units units;
    int first_weekday;              /* of 1 January, 0 Monday ... 6 Sunday; -1: not said */
    double interval_h;              /* that a row stands for, about its hour */
    enum orl_sun_method sun_method; /* of its reader: how rows' suns are placed */
    struct orl_weather_row *rows;
    size_t n_rows;
    size_t n_moved; /* of those, the first: they are the file's last, after 31 December */
};

/* Parses either format, told apart by the first word. name is for messages. Rows of another year
 * are left out, unless year is 0. Any number of rows makes a file: parts of a year are common in
 * WEA. The caller passes *ret_weather to orl_weather_done. */
int orl_weather_parse(const char *name, const char *text, size_t size, int year,
                      struct orl_weather *ret_weather, struct orl_error *err);
void orl_weather_done(struct orl_weather *weather); /* NULL is fine */

/* The row of that day nearest in time, the later of two; NULL when none is within half an hour. */
const struct orl_weather_row *orl_weather_find(const struct orl_weather *weather, int month,
                                               int day, double hour);

#endif
