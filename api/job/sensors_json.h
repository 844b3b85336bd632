/*
 * Decodes a document's sensors, {"file": NAME} or [[x, y, z, dx, dy, dz], ...], into a job and
 * leaves its other members unchanged. Sensors read before an error stay in job.
 */
#ifndef ORL_API_JOB_SENSORS_JSON_H
#define ORL_API_JOB_SENSORS_JSON_H

#include <jansson.h>

#include <oriel/job/run.h>

int orl_job_sensors_from_json(const json_t *sensors, const char *path, struct orl_job *job,
                              struct orl_error *err);

#endif
