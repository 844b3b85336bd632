/*
 * Position of the sun by time and site: geometric, without refraction, at most 0.01 degrees off for
 * the year 2017, whose declinations are in the middle of their range for a date.
 *
 * Conventions: degrees; latitude north, longitude and time zone east of Greenwich; azimuth from
 * south towards west.
 */
#ifndef ORIEL_JOB_SUN_POSITION_H
#define ORIEL_JOB_SUN_POSITION_H

#include <stdbool.h>

struct orl_sun_time {
    double latitude_deg, longitude_deg, time_zone_h;
    int month, day;
    double hour;   /* from midnight */
    bool is_solar; /* true: hour is true solar time, and the time zone is not used */
};

void orl_sun_angles(const struct orl_sun_time *time, double *ret_altitude_deg,
                    double *ret_azimuth_deg);

#endif
