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

/* weather: the parsed file for ORL_SKY_BY_WEATHER, else NULL. The request has been checked. */
int orl_daylight_find(const struct orl_sky_request *request, const struct orl_weather *weather,
                      struct orl_daylight *ret_daylight, struct orl_error *err);

#endif
