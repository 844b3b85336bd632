/*
 * Skies as Honeybee's recipes write them -> a job's "sky" (job/job_members_json.h):
 *
 *     cie [21 Jun 12:00 -lat 42 -lon -71 [-tz -5] [-n 0] | -alt 60 -az 180] [-type 0] [-g 0.2]
 *     climate-based ... as above ... -dni 800 -dhi 120 [-g 0.2]
 *     irradiance 558.659 [-u] [-g 0.2]
 *     illuminance 100000 [-u] [-g 0.2]
 *
 * Azimuths are clockwise from north, and -n is the angle from +Y to north, counter-clockwise.
 * Without -tz hours are true solar time. Long names of the options are allowed, too. Skies have the
 * brightness that gensky and gendaylit give them. Source: honeybee_radiance.cli.sky.
 */
#ifndef ORL_API_RECIPE_RECIPE_SKY_H
#define ORL_API_RECIPE_RECIPE_SKY_H

#include <jansson.h>

#include <oriel/base/error.h>

/* *ret_sky: a new reference. Errors: ORL_ERR_INVALID, which names the word. */
int orl_recipe_sky_to_json(const char *text, json_t **ret_sky, struct orl_error *err);

#endif
