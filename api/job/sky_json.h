/*
 * The sky of a job document (JSON) -> struct orl_sky_request, one of:
 *
 *     {"perez": {"month": 3, "day": 22, "hour": 12, "latitude": 38.42, "longitude": 27.14,
 *                "time_zone": 2, "direct_normal_w_m2": 800, "diffuse_horizontal_w_m2": 120,
 *                "ground_reflectance": 0.2}}
 *     {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
 *     {"weather": {"file": "place.epw", "month": 3, "day": 22, "hour": 11.5}}
 *
 * Optional members beside it are "normalise": "flux" (the default) or "gendaylit", and "sun":
 * "accurate" (the default) or "radiance". Longitude is in degrees EAST of Greenwich, the time zone
 * in hours EAST. Instead of time and site, perez and cie take sun_altitude and sun_azimuth
 * (degrees from south towards west). openapi.yaml lists the other inputs for a sky's brightness.
 * oriel/job/sky.h and orl_job_validate have their meaning and bounds.
 */
#ifndef ORL_API_JOB_SKY_JSON_H
#define ORL_API_JOB_SKY_JSON_H

#include <oriel/job/sky.h>

#include "json/members.h"

/* Decoder into a struct orl_sky_request, which holds defaults. If its time is already given, the
 * sky needs none. The request's owner frees its strings, also after a failure. */
orl_json_decoder orl_sky_from_json;
/* Decoder of one of several skies into a struct orl_named_sky of zeros; "name" is optional. */
orl_json_decoder orl_named_sky_from_json;

#endif
