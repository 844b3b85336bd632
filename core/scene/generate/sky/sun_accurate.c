/*
 * Position of the sun to 0.01 degrees, by the equations of the NREL report on its Solar Position
 * Algorithm (Reda and Andreas 2004). The Earth's motion is given by mean elements, the equation of
 * the centre, and the largest perturbations of its longitude. Sources: Meeus, "Astronomical
 * Algorithms", 2nd edition 1998, chapters 7, 12, 22, 25, 40; Bretagnon and Francou 1988, VSOP87.
 */
#include "scene/generate/sky/sun.h"

#include <stddef.h>

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
    struct orl_sun_position sun =
        orl_sun_at(site, place.declination, orl_sun_wrap_hour(local + 12.0));
    sun.altitude_rad -= parallax_rad * cos(sun.altitude_rad);
    return sun;
}
