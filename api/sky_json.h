/*
 * The sky of a job document (JSON) -> struct orl_sky_request, one of:
 *
 *     {"perez": {"month": 3, "day": 22, "hour": 12, "latitude": 38.42, "longitude": 27.14,
 *                "time_zone": 2, "direct_normal_w_m2": 800, "diffuse_horizontal_w_m2": 120,
 *                "ground_reflectance": 0.2}}
 *     {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
 *     {"weather": {"file": "place.epw", "month": 3, "day": 22, "hour": 11.5}}
 *
 * and beside it "normalise": "flux" (the default) or "gendaylit", and "sun": "accurate" (the
 * default) or "radiance". Longitude is in degrees EAST of
 * Greenwich, the time zone in hours EAST. Instead of time and site, perez and cie take sun_altitude
 * and sun_azimuth (degrees from south towards west). The other ways to say how bright a sky is are
 * in openapi.yaml; what they mean, and the bounds, in oriel/sky.h and orl_job_validate.
 */
#ifndef ORL_API_SKY_JSON_H
#define ORL_API_SKY_JSON_H

#include <oriel/sky.h>

#include "members.h"

/* Into a struct orl_sky_request, which holds defaults; where its time is given, the sky's own may
 * be left out. Strings in it are its owner's to free, also after a failure. */
orl_json_decoder orl_sky_from_json;
/* One of several, with a "name" or without: into a struct orl_named_sky of zeros. */
orl_json_decoder orl_named_sky_from_json;

#endif
