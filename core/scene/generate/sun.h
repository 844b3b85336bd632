/*
 * Where the sun stands: accurately, or by the formulas that gensky and gendaylit use, so that their
 * files and ours agree. Those are a plain Fourier fit by day of the year, up to 1.1 degrees off,
 * or, when the year is given, Michalsky's algorithm.
 *
 * Conventions: angles in radians; longitude and meridian are positive WEST of Greenwich; hours from
 * midnight; azimuth is measured from south, positive towards west; altitude from the horizon.
 * References: IES RP-21, "Calculation of daylight availability", 1984 (fit); Michalsky, "The
 * Astronomical Almanac's algorithm for approximate solar position (1950-2050)", Solar Energy 40(3),
 * 1988.
 */
#ifndef ORL_SCENE_GENERATE_SUN_H
#define ORL_SCENE_GENERATE_SUN_H

#include <stdbool.h>

#include <oriel/vec.h>

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

/* 1 for 1 January; February has 28 days. */
int orl_day_of_year(int month, int day);

/* Declination by the fit, which also gives sunrise and sunset. */
double orl_sun_declination(int day_of_year);

/* declination_rad and solar hour for a moment. */
void orl_sun_clock(const struct orl_location *site, const struct orl_moment *moment,
                   double *ret_declination_rad, double *ret_solar_hour);

/* Altitude and azimuth at a solar hour. */
struct orl_sun_position orl_sun_at(const struct orl_location *site, double declination_rad,
                                   double solar_hour);

/* An hour of the day within [0, 24). */
double orl_sun_wrap_hour(double hour);

/* By how many hours clocks differ, from -12 to 12, whatever their dates: those of -11 and +13 hours
 * of Greenwich show the same. */
double orl_sun_hours_apart(double hours, double others);

/*
 * At most 0.01 degrees from the true place between these years. A moment of no year, or of one
 * outside, is taken in 2017, and 29 February in 2016: years in which the sun's declination on a
 * date lies in the middle of its range, which is 0.4 degrees wide. The place is geometric:
 * refraction by the air, which raises the sun by 0.57 degrees at the horizon, by 0.16 at 5 degrees
 * and by 0.03 at 30 degrees, is left out, as Radiance, EnergyPlus and EN 17037 leave it out.
 * moment->solar is not heeded.
 */
enum { ORL_SUN_FIRST_YEAR = 1950, ORL_SUN_LAST_YEAR = 2100 };
struct orl_sun_position orl_sun_accurate(const struct orl_location *site,
                                         const struct orl_moment *moment);

/* The unit vector towards the sun. */
struct orl_vec3 orl_sun_direction(const struct orl_sun_position *sun);

#endif
