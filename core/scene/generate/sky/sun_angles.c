#include <oriel/job/sun_position.h>

#include <math.h>

#include "scene/generate/sky/sun.h"

#define HOUR (15 * ORL_DEG_TO_RAD)

void orl_sun_angles(const struct orl_sun_time *time, double *ret_altitude_deg,
                    double *ret_azimuth_deg)
{
    const double zone_h = time->is_solar ? time->longitude_deg / 15 : time->time_zone_h;
    const struct orl_location site = {time->latitude_deg * ORL_DEG_TO_RAD,
                                      -time->longitude_deg * ORL_DEG_TO_RAD, -zone_h * HOUR};
    struct orl_moment moment = {.month = time->month, .day = time->day, .hour = time->hour};
    struct orl_sun_position sun = orl_sun_accurate(&site, &moment);
    if (time->is_solar) { /* the equation of time barely changes within its own 16 minutes */
        moment.hour -= remainder(sun.solar_hour - time->hour, 24);
        sun = orl_sun_accurate(&site, &moment);
    }
    *ret_altitude_deg = sun.altitude_rad / ORL_DEG_TO_RAD;
    *ret_azimuth_deg = sun.azimuth_rad / ORL_DEG_TO_RAD;
}
