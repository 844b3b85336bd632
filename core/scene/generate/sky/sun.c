/* Position of the sun: as gensky and gendaylit compute it; below, the accurate one. */
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

/* Wraps an hour of the day into [0, 24). */
static double wrap_hour(double hour)
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
    *ret_solar_hour = wrap_hour(local - ascension * 12.0 / ORL_PI + 12.0);
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
    *ret_solar_hour = moment->solar ? moment->hour : wrap_hour(hour);
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

/*
 * Position of the sun to 0.01 degrees, by the equations of the NREL report on its Solar Position
 * Algorithm (Reda and Andreas 2004). The Earth's motion is given by mean elements, the equation of
 * the centre, and the largest perturbations of its longitude. Sources: Meeus, "Astronomical
 * Algorithms", 2nd edition 1998, chapters 7, 12, 22, 25, 40; Bretagnon and Francou 1988, VSOP87.
 */

enum { YEAR = 2017, LEAP_YEAR = 2016 };

/* Terrestrial minus universal time: 29 s in 1950, 64 in 2000, 69 in 2020. The sun moves by 0.00001
 * degrees in a second. */
#define DELTA_T_S 69.0

/* The sun's geocentric position, in radians. */
struct equatorial {
    double declination, hour_angle; /* hour_angle: at Greenwich, from noon, positive westwards */
};

static double sine(double degrees)
{
    return sin(degrees * ORL_DEG_TO_RAD);
}

static double cosine(double degrees)
{
    return cos(degrees * ORL_DEG_TO_RAD);
}

/* Returns the year used for a moment: its own within the range of these formulas. */
static int year_of(const struct orl_moment *moment)
{
    if (moment->year >= ORL_SUN_FIRST_YEAR && moment->year <= ORL_SUN_LAST_YEAR)
        return moment->year;
    return moment->month == 2 && moment->day == 29 ? LEAP_YEAR : YEAR;
}

/* Days since noon on 1 January 2000, universal time (Meeus, equation 7.1). */
static double days_since_2000(const struct orl_location *site, const struct orl_moment *moment)
{
    const int shift = moment->month <= 2 ? 1 : 0;
    const int year = year_of(moment) - shift, month = moment->month + 12 * shift;
    const int century = year / 100, gregorian = 2 - century + century / 4;
    const double date = floor(365.25 * (year + 4716)) + floor(30.6001 * (month + 1)) + moment->day +
                        gregorian - 1524.5;
    const double hour_ut = moment->hour + site->meridian_rad * 12.0 / ORL_PI;
    return date - 2451545.0 + hour_ut / 24.0;
}

/* Perturbation of the longitude by planets and the moon, in degrees; the sum of omitted terms is
 * below 0.002. */
static double perturbation(double centuries)
{
    static const struct {
        double size, phase, rate; /* 1e-8 rad, rad, rad per century */
    } terms[] = {{3497, 2.7441, 575.33849}, {3418, 2.8289, 0.35231},   {3136, 3.6277, 7771.37715},
                 {2676, 4.4181, 786.04194}, {2343, 6.1352, 393.02097}, {1324, 0.7425, 1150.67698},
                 {1273, 2.0371, 52.9691},   {1199, 1.1096, 157.73435}};
    double sum = 0;
    for (size_t i = 0; i < sizeof terms / sizeof *terms; i++)
        sum += terms[i].size * cos(terms[i].phase + terms[i].rate * centuries);
    return 1e-8 * sum / ORL_DEG_TO_RAD;
}

/* Meeus, chapter 25, in the order of its equations; nutation by its largest terms (chapter 22). */
static struct equatorial place_of(double days)
{
    const double t = (days + DELTA_T_S / 86400.0) / 36525.0;
    const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = 357.52911 + t * (35999.05029 - t * 0.0001537);
    const double center = (1.914602 - 0.004817 * t) * sine(anomaly) +
                          (0.019993 - 0.000101 * t) * sine(2 * anomaly) +
                          0.000289 * sine(3 * anomaly);
    const double node = 125.04452 - 1934.136261 * t;
    const double aberration = 0.00569;
    const double nutation = -0.00478 * sine(node) - 0.00037 * sine(2 * mean_longitude);
    const double longitude = mean_longitude + center + perturbation(t) - aberration + nutation;
    const double obliquity =
        23.4392911 - 0.0130042 * t + 0.00256 * cosine(node) + 0.00016 * cosine(2 * mean_longitude);
    const double ascension =
        atan2(sine(longitude) * cosine(obliquity), cosine(longitude)) / ORL_DEG_TO_RAD;
    const double sidereal = 280.46061837 + 360.98564736629 * days + nutation * cosine(obliquity);
    return (struct equatorial){asin(sine(obliquity) * sine(longitude)),
                               fmod(sidereal - ascension, 360.0) * ORL_DEG_TO_RAD};
}

/* On the Earth's surface the sun is lower by the parallax (Meeus, chapter 40): at most 8.794
 * seconds of arc. */
struct orl_sun_position orl_sun_accurate(const struct orl_location *site,
                                         const struct orl_moment *moment)
{
    static const double parallax_rad = 8.794 / 3600.0 * ORL_DEG_TO_RAD;
    const struct equatorial place = place_of(days_since_2000(site, moment));
    const double local = (place.hour_angle - site->longitude_rad) * 12.0 / ORL_PI;
    struct orl_sun_position sun = orl_sun_at(site, place.declination, wrap_hour(local + 12.0));
    sun.altitude_rad -= parallax_rad * cos(sun.altitude_rad);
    return sun;
}
