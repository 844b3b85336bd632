/*
 * Position of the sun: accurate, or by the formulas that gensky and gendaylit use, so that results
 * agree with their files. Those are a Fourier fit by day of the year, up to 1.1 degrees off, or, if
 * the year is given, Michalsky's algorithm.
 *
 * Conventions: angles in radians; longitude and meridian are positive WEST of Greenwich; hours from
 * midnight; azimuth is measured from south, positive towards west; altitude from the horizon.
 * References: IES RP-21, "Calculation of daylight availability", 1984 (fit); Michalsky, "The
 * Astronomical Almanac's algorithm for approximate solar position (1950-2050)", Solar Energy 40(3),
 * 1988.
 */
#ifndef ORL_SCENE_GENERATE_SKY_SUN_H
#define ORL_SCENE_GENERATE_SKY_SUN_H

#include <stdbool.h>

#include <oriel/base/vec.h>

struct orl_location {
    double latitude_rad, longitude_rad, meridian_rad;
};

/* Both programs' default site: Berkeley, California. */
extern const struct orl_location orl_location_default;

struct orl_moment {
    int year; /* 0: not given */
    int month, day;
    double hour;
    bool solar; /* hour is local solar time, not standard time */
};

struct orl_sun_position {
    double altitude_rad, azimuth_rad;
    double solar_hour;
};

/* Returns 1 for 1 January; February has 28 days. */
int orl_day_of_year(int month, int day);

/* Returns the declination by the fit, which also gives sunrise and sunset. */
double orl_sun_declination(int day_of_year);

/* Returns declination and solar hour for a moment. */
void orl_sun_clock(const struct orl_location *site, const struct orl_moment *moment,
                   double *ret_declination_rad, double *ret_solar_hour);

/* Returns altitude and azimuth at a solar hour. */
struct orl_sun_position orl_sun_at(const struct orl_location *site, double declination_rad,
                                   double solar_hour);

/* Returns the difference of two time zones in hours, from -12 to 12, ignoring the date: those of
 * -11 and +13 hours from Greenwich show the same time. */
double orl_sun_hours_apart(double hours, double others);

/*
 * Returns the sun's position, at most 0.01 degrees off between these years. A moment without a
 * year, or outside this range, is computed for 2017, and 29 February for 2016: in these years the
 * declination on a date is in the middle of its range, which is 0.4 degrees wide. The position is
 * geometric: it leaves out atmospheric refraction, as do Radiance, EnergyPlus and EN 17037.
 * Refraction raises the sun by 0.57 degrees at the horizon, by 0.16 at 5 degrees and by 0.03 at 30
 * degrees. Ignores moment->solar.
 */
enum { ORL_SUN_FIRST_YEAR = 1950, ORL_SUN_LAST_YEAR = 2100 };
struct orl_sun_position orl_sun_accurate(const struct orl_location *site,
                                         const struct orl_moment *moment);

/* Returns the unit vector towards the sun. */
struct orl_vec3 orl_sun_direction(const struct orl_sun_position *sun);

#endif
