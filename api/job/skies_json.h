/*
 * Several skies of a job document (JSON) -> the job's list of skies. The skies are given one by
 * one, as in sky_json.h, with a name for the results:
 *
 *     [{"name": "noon", "weather": {...}}, {"cie": {...}}, ...]
 *
 * or as a sequence of hours in a year of 365 days. It has a sky model that depends on time,
 * without month, day and hour. It also has the first and the last moment (inclusive) and the step
 * in hours:
 *
 *     {"weather": {"file": "place.epw"}, "from": {"month": 3, "day": 22, "hour": 0.5},
 *      "to": {"month": 3, "day": 22, "hour": 23.5}, "step_h": 1}
 *
 * A sky without a name is named by its time, "0322-1130" for month, day, hour and minute, or else
 * by its number, "sky-0007".
 */
#ifndef ORL_API_JOB_SKIES_JSON_H
#define ORL_API_JOB_SKIES_JSON_H

#include <oriel/job/run.h>

#include "json/members.h"

/* Decoder into a struct orl_job. The caller frees what is in the job, also after a failure. */
orl_json_decoder orl_skies_from_json;

#endif
