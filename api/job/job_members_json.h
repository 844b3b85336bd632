/*
 * Members of a job's document (job_json.h) and of its result: sky and skies, effects and plan,
 * sensors, grids, heat maps, and named points.
 */
#ifndef ORL_API_JOB_JOB_MEMBERS_JSON_H
#define ORL_API_JOB_JOB_MEMBERS_JSON_H

#include <jansson.h>

#include <oriel/base/input_checks.h>
#include <oriel/job/plan.h>
#include <oriel/job/run.h>
#include <oriel/job/sky.h>

#include "json/decode.h"

/*
 * The sky of a job document (JSON) -> struct orl_sky_request: "perez", "cie" or "weather", as
 * api/schema/sky.yaml describes them. Longitude is in degrees EAST of Greenwich, the time zone in
 * hours EAST. Instead of time and site, perez and cie take the sun's altitude and azimuth.
 * oriel/job/sky.h and orl_job_validate have their meaning and bounds.
 */

/* Decoder into a struct orl_sky_request, which holds defaults. If its time is already given, the
 * sky needs none. The request's owner frees its strings, also after a failure. */
orl_json_decoder orl_sky_from_json;

/*
 * Several skies of a job document (JSON) -> the job's list of skies. They are given one by one,
 * with a name for the results, or as a sequence of hours (NamedSky and SkySequence of
 * api/schema/sky.yaml). A sequence has a sky model that depends on time, without month, day and
 * hour.
 *
 * A sky without a name is named by its time, "0322-1130" for month, day, hour and minute, or else
 * by its number, "sky-0007".
 */

/* Decoder into a struct orl_job. The caller frees what is in the job, also after a failure. */
orl_json_decoder orl_skies_from_json;

/*
 * Plans: effect overrides in a job document, and the plan in result.json.
 *
 * One of the effects that "caustics" stands for (Wishes of api/schema/effects.yaml) overrides it if
 * it is named as well, in any order. A result's "plan" (Plan of api/schema/plan.yaml) is also what
 * `oriel plan --json` prints,
 * with every effect once, in the order of enum orl_effect. A bound that is not finite has the
 * value null. Functions return new references, owned by the caller, or NULL when out of memory.
 */

/* Decodes the name of a technique; the schema's words are those of the enum from first on. */
int orl_technique_from_json(const json_t *value, const char *path,
                            const struct orl_json_schema *schema, enum orl_technique first,
                            enum orl_technique *ret_technique, struct orl_error *err);

/* Decoder of "effects" into an array of enum orl_effect_override, one per effect, which holds
 * defaults. */
orl_json_decoder orl_effect_overrides_from_json;

/* Returns json null for a plan that was never made (its technique is still ORL_TECHNIQUE_AUTO). */
json_t *orl_plan_to_json(const struct orl_plan *plan);

/*
 * Decodes a document's sensors, {"file": NAME} or [[x, y, z, dx, dy, dz], ...], into a job and
 * leaves its other members unchanged. Sensors read before an error stay in job.
 */

int orl_job_sensors_from_json(const json_t *sensors, const char *path, struct orl_job *job,
                              struct orl_error *err);

/*
 * A job's sensors in grids
 * (Grids of api/schema/sensors.yaml), in place of "sensors".
 */

/* Decoder (decode.h) into a struct orl_job; sensors and grids read before an error stay there. */
int orl_grids_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);

/* Returns a new reference, or NULL if there are no grids or no memory. */
json_t *orl_grids_to_json(const struct orl_result *result);
/* Encodes figures of a range of sensors: {"mean_lx", "interval_95_lx", "minimum_lx", "maximum_lx",
 * "uniformity", "share_300"}; null where not known. */
json_t *orl_sensor_summary_to_json(const struct orl_result *result, size_t first, size_t count);

/*
 * Maps and tables of sensors: HeatMap of api/schema/sensors.yaml, and SensorResultFiles of a
 * result.
 */

/* Decoder (decode.h) into a struct orl_heat_map_request. */
orl_json_decoder orl_heat_map_from_json;

/* Returns a new reference, or NULL if there are no files or no memory. */
json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files);

/*
 * Named points in a document:
 *
 *     [{"name": "living room" (by default "point" and its number), "at": [x, y, z]}, ...]
 */

/* Decoders (decode.h) into a struct orl_vec3: an array of three numbers, checked by
 * oriel/base/input_checks.h. */
int orl_point_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);
int orl_direction_from_json(const json_t *value, const char *path, void *into,
                            struct orl_error *err);
/* Decoder for lists (decode.h) into a struct orl_named_point. */
int orl_named_point_from_json(const json_t *value, const char *path, void *into,
                              struct orl_error *err);

/* Names the points that have no name. Returns 0 or ORL_ERR_NOMEM. */
int orl_places_name(struct orl_named_point *places, size_t n, struct orl_error *err);

#endif
