/*
 * Conversion of a job's request (oriel/job/sky.h) to sun, sky and ground for the rest of the core,
 * and the radiance of skies.
 *
 * The numbers are those of gendaylit and gensky for the same input, in full precision. With
 * ORL_SKY_FLUX they are then scaled, and the horizon cuts the sun's disc: a setting sun is a
 * smaller one, higher up. A sky that cannot shine (night, no measured light) is black and adds a
 * warning.
 *
 * Threads: pure functions. Errors: ORL_ERR_INVALID, _RANGE, _NOT_FOUND (no such row), _NOMEM.
 */
#ifndef ORL_LIGHT_DAYLIGHT_DAYLIGHT_H
#define ORL_LIGHT_DAYLIGHT_DAYLIGHT_H

#include <oriel/base/error.h>
#include <oriel/job/sky.h>

#include "light/daylight/weather.h"
#include "scene/parsed_scene.h"

/* Maximum direct normal light, as in gendaylit: the solar constant. */
#define ORL_DAYLIGHT_MOST_W 1367.0
#define ORL_DAYLIGHT_MOST_LX 127500.0

struct orl_daylight {
    struct orl_sky pattern; /* sky above, ground below */
    bool black;             /* no light at all */
    struct orl_vec3 sun;    /* unit, towards the centre of the disc */
    double sun_radiance;    /* W/sr/m2 per channel; 0: no sun */
    double sun_angle_deg;
    char warnings[640]; /* sentences joined by "; ", or "" */
};

/* Checks all that can be checked without a weather file. A request for no sky is valid. */
int orl_daylight_check(const struct orl_sky_request *request, struct orl_error *err);

/*
 * Makes the sky of a weather file's row, which must not be missing, without balancing its flux. The
 * caller scales the pattern's brightness and sets its ground (orl_daylight_balance) so that the
 * diffuse irradiance is *ret_diffuse, W/m2. The rest is as orl_daylight_from_request returns it
 * with ORL_SKY_FLUX.
 */
int orl_daylight_from_row(const struct orl_weather *weather, const struct orl_weather_row *row,
                          struct orl_daylight *ret_daylight, double *ret_diffuse,
                          struct orl_error *err);

/* Returns the altitude of the sun's centre for a row's sky, degrees. */
double orl_daylight_altitude_of_row(const struct orl_weather *weather,
                                    const struct orl_weather_row *row);

/* The position of the sun at a row of a weather file, whatever was measured there. It is that of
 * the row's sky if that has a sun. */
struct orl_daylight_sun {
    struct orl_vec3 towards;
    double angle_deg; /* diameter of the disc; 0: the sun has set */
};
struct orl_daylight_sun orl_daylight_sun_of_row(const struct orl_weather *weather,
                                                const struct orl_weather_row *row);

/*
 * Returns the brightness of sky and ground in the pattern's terms that gives a diffuse irradiance
 * `diffuse`, W/m2. per_sky and per_ground are the irradiance from the sky's upper half for
 * brightness 1 of the sky or of the ground. Sun and sky light the ground.
 */
struct orl_sky_balance {
    double sky, ground;
};
struct orl_sky_balance orl_daylight_balance(const struct orl_daylight *daylight, double diffuse,
                                            double reflectance, double per_sky, double per_ground);

/* Returns the irradiance from the sun's disc of a plane that faces it, W/m2 per channel. */
double orl_daylight_direct_normal(const struct orl_daylight *daylight);

/* Makes the sky of a checked request. weather: the parsed file for ORL_SKY_BY_WEATHER, else
 * NULL. */
int orl_daylight_from_request(const struct orl_sky_request *request,
                              const struct orl_weather *weather, struct orl_daylight *ret_daylight,
                              struct orl_error *err);

/*
 * Radiance of the sky in a direction: the patterns that gendaylit (Perez et al. 1993) and gensky
 * (CIE clear, intermediate, overcast, uniform) write, ground half included.
 */

/* Returns skybright(direction) as Radiance's perezlum.cal / skybright.cal define it; direction
 * is unit. */
double orl_sky_brightness(const struct orl_sky *sky, struct orl_vec3 direction);

/*
 * Returns the irradiance of a horizontal surface from the sky's upper half, W/m2 per channel, by
 * quadrature. Its relative error is at most 1e-6 for any position of the sun.
 */
double orl_sky_horizontal(const struct orl_sky *sky);

#endif
