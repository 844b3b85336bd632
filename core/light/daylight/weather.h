/*
 * Weather files: EPW (EnergyPlus) and WEA (DAYSIM, gendaymtx), as far as skies need them: the site,
 * and for each row the time and two measures of sun and sky. Faults of a file that its own numbers
 * show: a shift of all times, and radiation while the sun is down.
 *
 * Conventions: longitude in degrees EAST and time zone in hours EAST of Greenwich, for either
 * format (EPW: both east; WEA: degrees west both). Times are the middle of the interval a row
 * stands for. An EPW row of hour 12 is the mean from 11 to 12 and is at 11.5 here (with two rows an
 * hour: at 11.25 and 11.75). WEA files say 11.5 themselves, and up to 25 after midnight (DAYSIM),
 * which belongs to the next day here. A day of 29 February is read if the file has it.
 *
 * Years: no two rows have the same time, whatever their years. If an EPW has rows of one month, day
 * and hour in several years, the caller chooses a year. A file may continue over 31 December, as
 * from July to June; here its rows are in calendar order, from 1 January.
 *
 * Invariants: every number is finite; months are 1..12, days exist in a leap year, hours lie in [0,
 * 24]. Values that the file marks as missing (9999 and above, or -90 and below) are missing here,
 * never numbers.
 *
 * Errors: ORL_ERR_SYNTAX, _RANGE, _INVALID (a year of a WEA file), _LIMIT, with file and line.
 * Threads: a parsed file is immutable.
 * References: EnergyPlus, "Auxiliary Programs", chapter on weather data; gendaymtx(1) of Radiance.
 */
#ifndef ORL_LIGHT_DAYLIGHT_WEATHER_H
#define ORL_LIGHT_DAYLIGHT_WEATHER_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/job/sky.h>

/* Meaning and unit of a row's two numbers; the values are WEA's weather_data_file_units. */
enum orl_weather_units {
    ORL_WEATHER_NORMAL_W = 1,     /* direct normal and diffuse horizontal irradiance, W/m2 */
    ORL_WEATHER_HORIZONTAL_W = 2, /* direct horizontal and diffuse horizontal irradiance, W/m2 */
    ORL_WEATHER_NORMAL_LX = 3,    /* direct normal and diffuse horizontal illuminance, lx */
};

struct orl_weather_row {
    int year; /* 0: the file has no years, as in WEA */
    int month, day;
    int line; /* line number in the file, from 1 */
    bool missing;
    double hour; /* the middle of its interval */
    double direct, diffuse;
    double global; /* horizontal irradiance, W/m2; NaN: the file has none, as in WEA */
};

struct orl_weather {
    double latitude_deg, longitude_deg, time_zone_h;
    enum orl_weather_units units;
    int first_weekday;              /* weekday of 1 January, 0 Monday ... 6 Sunday; -1: unknown */
    double interval_h;              /* length of the interval around `hour` that a row stands for */
    enum orl_sun_method sun_method; /* set by the reader: how the sun is positioned for a row */
    struct orl_weather_row *rows;
    size_t n_rows;
    /* number of rows at the start that the file has last, after 31 December */
    size_t n_moved;
};

/* Parses either format, which the first word identifies. name is for messages. Rows of other
 * years are left out, unless year is 0. Any number of rows is valid: parts of a year are common
 * in WEA. The caller passes *ret_weather to orl_weather_done. */
int orl_weather_parse(const char *name, const char *text, size_t size, int year,
                      struct orl_weather *ret_weather, struct orl_error *err);
void orl_weather_done(struct orl_weather *weather); /* NULL is fine */

/* Returns the row of that day nearest in time, the later of two; NULL if none is within half an
 * hour. */
const struct orl_weather_row *orl_weather_find(const struct orl_weather *weather, int month,
                                               int day, double hour);

/* The order of a weather file's rows: that of the calendar, from 1 January to 31 December. */

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

/*
 * Detection of a time shift in an EPW file from its own numbers. Global irradiance is diffuse
 * irradiance plus direct normal irradiance times the sine of the sun's altitude. That should hold
 * for the sun at the middle of each row's interval. If instead it holds for a sun half an hour
 * earlier, the file's times or its time zone are half an hour off.
 */

struct orl_time_shift {
    double shift_h; /* to be added to the file's times; 0: no shift was found */
    /* global irradiance matches the unshifted sun: direct irradiance was computed for another
     * position */
    bool doubtful;
    /* the time zone that would explain the shift, with the file's times unchanged */
    double time_zone_h;
    double file_time_zone_h;
    double off_w_m2;   /* mean difference of global irradiance with the file's times */
    double least_w_m2; /* mean difference with shifted times */
    /* Means over the rows with direct light. */
    double global_w_m2, diffuse_w_m2;
    /* |global - diffuse - direct|: 0 if the file's direct irradiance is on the horizontal */
    double horizontal_w_m2;
};

/* Finds the shift. Finds none if rows have no global irradiance, as in WEA files. */
struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather);

/* Writes a warning for the user about a shift, or about numbers that contradict each other for
 * any shift. Returns false, and writes nothing, if there is neither. */
bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size);

/*
 * Radiation that a weather file has while the sun is below the horizon. No sky model takes it, so a
 * year omits it. A small amount is usual: twilight, and refraction, which raises the sun by its own
 * width at the horizon. A large amount shows that the site and the times of the file do not match.
 */

/* The change to the file that would put the sun above the horizon. */
enum orl_night_cause {
    ORL_NIGHT_UNKNOWN,
    ORL_NIGHT_LONGITUDE, /* the other sign of the longitude */
    ORL_NIGHT_TIME_ZONE, /* the other sign of the time zone */
    ORL_NIGHT_SHIFT,     /* a shift of all times */
};

/* Sums of direct and diffuse radiation, in the units of the file, times hours. */
struct orl_night_light {
    size_t n_rows;
    double hours, lost, total;
    enum orl_weather_units units;
    enum orl_night_cause cause;
    double shift_h; /* to be added to the file's times */
};

struct orl_night_light orl_night_light_find(const struct orl_weather *weather);

/* Writes a warning for the user. Returns false, and does not write, if at most a thousandth of the
 * radiation is lost. */
bool orl_night_light_describe(const struct orl_night_light *night, char *text, size_t size);

#endif
