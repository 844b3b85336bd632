/*
 * Several skies of a job document (JSON) -> the job's list of them. Either each by itself, as
 * sky_json.h has it, with a name for its results:
 *
 *     [{"name": "noon", "weather": {...}}, {"cie": {...}}, ...]
 *
 * or a sequence of hours: a sky that goes by time, without month, day and hour, and from where to
 * where (included) in which steps, of hours, in a year of 365 days:
 *
 *     {"weather": {"file": "place.epw"}, "from": {"month": 3, "day": 22, "hour": 0.5},
 *      "to": {"month": 3, "day": 22, "hour": 23.5}, "step_h": 1}
 *
 * Skies without a name are called after their time, "0322-1130" for month, day, hour and minute, or
 * "sky-0007" by their number.
 */
#ifndef ORL_API_SKIES_JSON_H
#define ORL_API_SKIES_JSON_H

#include <oriel/run.h>

#include "members.h"

/* Into a struct orl_job. What is in the job is the job's to free, also after a failure. */
orl_json_decoder orl_skies_from_json;

#endif
