/*
 * A year's document (JSON) -> struct orl_annual_job, and its results -> result.json.
 * api/schema/annual.yaml describes the document, and api/schema/result_annual.yaml the result.
 * oriel/annual/annual.h and annual_report.h define the terms. Unknown numbers are null.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_JSON_H

#include <jansson.h>

#include <oriel/annual/annual_report.h>

#include "job/job_json.h"

/* Hourly files: Honeybee's results folder, Radiance's matrices, daylight coefficients, and phase
 * matrices. */
struct orl_annual_formats {
    bool honeybee, matrices, coefficients, phases;
};

/* A decoded job; it owns all its members. orl_annual_job_done frees them. */
struct orl_annual_job {
    char *title;
    char *document; /* the document it was decoded from, as one line of JSON */
    struct orl_annual_request
        request; /* sensors in files are not read yet: orl_annual_grids_read */
    struct orl_report_request report_request;
    char **grid_files; /* sensor file of each grid; NULL where the document lists the sensors */
    bool bare;         /* true if the document has "sensors", which form its only grid */
    struct orl_annual_formats formats;
};
void orl_annual_job_done(struct orl_annual_job *job); /* NULL and zeros are fine */

/* Decodes doc; origin and ret_scene_id as in orl_job_from_json. */
int orl_annual_job_from_json(const json_t *doc, enum orl_job_origin origin,
                             struct orl_annual_job *ret_job, char **ret_scene_id,
                             struct orl_error *err);

/* Checks job as far as possible without the scene, the weather and the sensors in files. */
int orl_annual_job_validate(const struct orl_annual_job *job, struct orl_error *err);

/* Returns the state of the accuracy refinement as in result.json, json null if no accuracy is
 * asked for, or NULL when out of memory. A new reference. */
json_t *orl_annual_refinement_to_json(const struct orl_annual_refinement *refinement);

/* Returns a new reference, owned by the caller, or NULL when out of memory. files: an array of
 * names, borrowed. */
json_t *orl_annual_report_to_json(const struct orl_annual_job *job,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_refinement *refinement,
                                  const struct orl_annual_report *report,
                                  const struct orl_annual_inputs *inputs, json_t *files);

#endif
