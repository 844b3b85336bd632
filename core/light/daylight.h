/*
 * From a job's request (oriel/sky.h) to sun, sky and ground as the rest of the core knows them.
 *
 * The numbers are those of gendaylit and gensky for the same input, in full precision; with
 * ORL_SKY_FLUX they are then scaled, and the horizon cuts the sun's disc: a setting sun is a
 * smaller one, higher up. A sky that cannot shine (night, no light measured) is black and says so
 * in warnings.
 *
 * Threads: pure functions. Errors: ORL_ERR_INVALID, _RANGE, _NOT_FOUND (no such row), _NOMEM.
 */
#ifndef ORL_LIGHT_DAYLIGHT_H
#define ORL_LIGHT_DAYLIGHT_H

#include <oriel/error.h>
#include <oriel/sky.h>

#include "light/weather.h"
#include "scene/description.h"

/* The most direct normal light, as gendaylit has it: the solar constant. */
#define ORL_DAYLIGHT_MOST_W 1367.0
#define ORL_DAYLIGHT_MOST_LX 127500.0

struct orl_daylight {
    struct orl_sky pattern; /* sky above, ground below */
    bool black;             /* nothing shines */
    struct orl_vec3 sun;    /* towards its centre */
    double sun_radiance;    /* W/sr/m2 per channel; 0: no sun */
    double sun_angle_deg;
    char warnings[640]; /* sentences joined by "; ", or "" */
};

/* Checks what can be checked without a weather file. A request for no sky is fine. */
int orl_daylight_check(const struct orl_sky_request *request, struct orl_error *err);

/*
 * The sky of a weather file's row, which is not missing, with its flux not seen to yet: pattern's
 * brightness is to be scaled, and its ground set, by who works out what the pattern gives
 * (orl_daylight_balance), to *ret_diffuse W/m2. The rest is as orl_daylight_find has it with
 * ORL_SKY_FLUX.
 */
int orl_daylight_of_row(const struct orl_weather *weather, const struct orl_weather_row *row,
                        struct orl_daylight *ret_daylight, double *ret_diffuse,
                        struct orl_error *err);

/* In degrees: of the sun's centre, as a row's sky has it. */
double orl_daylight_altitude_of_row(const struct orl_weather *weather,
                                    const struct orl_weather_row *row);

/* Where the sun stands at a row of a weather file, whatever was measured there, as that row's sky
 * has it where it has a sun. */
struct orl_daylight_sun {
    struct orl_vec3 towards;
    double angle_deg; /* 0: it has set */
};
struct orl_daylight_sun orl_daylight_sun_of_row(const struct orl_weather *weather,
                                                const struct orl_weather_row *row);

/*
 * The brightness of sky and ground, as the pattern has them, by which a sky whose upper half gives
 * per_sky and per_ground, each of brightness 1, W/m2, gives diffuse; sun and sky light the ground.
 */
struct orl_sky_balance {
    double sky, ground;
};
struct orl_sky_balance orl_daylight_balance(const struct orl_daylight *daylight, double diffuse,
                                            double reflectance, double per_sky, double per_ground);

/* Irradiance by the sun's disc of a plane that faces it, W/m2 per channel. */
double orl_daylight_normal(const struct orl_daylight *daylight);

/* weather: the parsed file for ORL_SKY_BY_WEATHER, else NULL. The request has been checked. */
int orl_daylight_find(const struct orl_sky_request *request, const struct orl_weather *weather,
                      struct orl_daylight *ret_daylight, struct orl_error *err);

#endif
