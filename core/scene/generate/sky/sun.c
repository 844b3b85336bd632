#include "scene/generate/sky/sun.h"

#include <stddef.h>

const struct orl_location orl_location_default = {0.66, 2.13, 120.0 * ORL_DEG_TO_RAD};

int orl_day_of_year(int month, int day)
{
    static const short before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    return before[month - 1] + day;
}

double orl_sun_declination(int day_of_year)
{
    return 0.4093 * sin(2.0 * ORL_PI / 365.0 * (day_of_year - 81));
}

/* Solar minus standard time in hours: equation of time, and distance from the meridian. */
static double time_shift(const struct orl_location *site, int day_of_year)
{
    return 0.170 * sin(4.0 * ORL_PI / 373.0 * (day_of_year - 80)) -
           0.129 * sin(2.0 * ORL_PI / 355.0 * (day_of_year - 8)) +
           12.0 / ORL_PI * (site->meridian_rad - site->longitude_rad);
}

/* Wraps value into [0, period). */
static double wrapped(double value, double period)
{
    value = fmod(value, period);
    return value < 0 ? value + period : value;
}

double orl_sun_wrap_hour(double hour)
{
    return wrapped(hour, 24.0);
}

double orl_sun_hours_apart(double hours, double others)
{
    return wrapped(hours - others + 12.0, 24.0) - 12.0;
}

/* Days since noon UT on 1 January 2000, computed as in the almanac from 1949. */
static double almanac_days(const struct orl_location *site, const struct orl_moment *moment)
{
    const bool leap_day = moment->month > 2 && moment->year % 4 == 0;
    const int years = moment->year - 1949;
    const int days =
        orl_day_of_year(moment->month, moment->day) + (leap_day ? 1 : 0) + years * 365 + years / 4;
    const double hour_ut = moment->hour + site->meridian_rad * 12.0 / ORL_PI;
    return days + hour_ut / 24.0 + (2432916.5 - 2451545.0);
}

/* Michalsky 1988, equations in the paper's order: ecliptic, celestial, then local coordinates. */
static void almanac(const struct orl_location *site, double days, double *ret_declination_rad,
                    double *ret_solar_hour)
{
    const double deg = ORL_DEG_TO_RAD, turn = 2.0 * ORL_PI;
    const double mean_longitude = wrapped((280.460 + 0.9856474 * days) * deg, turn);
    const double anomaly = wrapped((357.528 + 0.9856003 * days) * deg, turn);
    const double longitude =
        mean_longitude + 1.915 * deg * sin(anomaly) + 0.020 * deg * sin(2.0 * anomaly);
    const double obliquity = (23.439 - 4e-7 * days) * deg;
    const double ascension = atan2(sin(longitude) * cos(obliquity), cos(longitude));
    const double hour_ut = 24.0 * (days - floor(days)) + 12.0;
    const double sidereal = 6.697375 + 0.0657098242 * days + hour_ut;
    const double local = sidereal - site->longitude_rad * 12.0 / ORL_PI;
    *ret_declination_rad = asin(sin(obliquity) * sin(longitude));
    *ret_solar_hour = orl_sun_wrap_hour(local - ascension * 12.0 / ORL_PI + 12.0);
}

void orl_sun_clock(const struct orl_location *site, const struct orl_moment *moment,
                   double *ret_declination_rad, double *ret_solar_hour)
{
    const int day = orl_day_of_year(moment->month, moment->day);
    double hour = moment->hour;
    if (moment->year) {
        almanac(site, almanac_days(site, moment), ret_declination_rad, &hour);
    } else {
        *ret_declination_rad = orl_sun_declination(day);
        hour += time_shift(site, day);
    }
    *ret_solar_hour = moment->solar ? moment->hour : orl_sun_wrap_hour(hour);
}

struct orl_sun_position orl_sun_at(const struct orl_location *site, double declination_rad,
                                   double solar_hour)
{
    const double hour_angle = solar_hour * ORL_PI / 12.0; /* 0 at midnight */
    const double sin_lat = sin(site->latitude_rad), cos_lat = cos(site->latitude_rad);
    const double sin_dec = sin(declination_rad), cos_dec = cos(declination_rad);
    return (struct orl_sun_position){
        .altitude_rad = asin(sin_lat * sin_dec - cos_lat * cos_dec * cos(hour_angle)),
        .azimuth_rad = -atan2(cos_dec * sin(hour_angle),
                              -cos_lat * sin_dec - sin_lat * cos_dec * cos(hour_angle)),
        .solar_hour = solar_hour};
}

struct orl_vec3 orl_sun_direction(const struct orl_sun_position *sun)
{
    return orl_v3(-sin(sun->azimuth_rad) * cos(sun->altitude_rad),
                  -cos(sun->azimuth_rad) * cos(sun->altitude_rad), sin(sun->altitude_rad));
}
