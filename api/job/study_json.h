/*
 * A study document (JSON) -> struct orl_study_request, and struct orl_study -> study.json.
 * api/schema/study.yaml describes the document, and api/schema/result_study.yaml the result.
 * oriel/job/study.h defines the terms.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_JOB_STUDY_JSON_H
#define ORL_API_JOB_STUDY_JSON_H

#include <jansson.h>

#include <oriel/base/error.h>
#include <oriel/job/study.h>

#include "job/job_json.h"

/*
 * Decodes doc; origin and ret_scene_id as in orl_job_from_json. It checks each value by itself;
 * orl_study_request_validate checks the rest.
 */
int orl_study_from_json(const json_t *doc, enum orl_job_origin origin,
                        struct orl_study_request *ret_request, char **ret_scene_id,
                        struct orl_error *err);

/* Encodes the setting as "technique", "photons" and "samples" (null: not used), a new reference. */
json_t *orl_study_setting_to_json(const struct orl_study_setting *setting);

/* Encodes a point in short, for progress: the setting, "total_s", "rms" and "rms_error". */
json_t *orl_study_point_in_short(const struct orl_study_point *point);

/* Encodes a study. Returns a new reference, owned by the caller, or NULL when out of memory.
 * request: the study's request. */
json_t *orl_study_to_json(const struct orl_study *study, const struct orl_study_request *request);

#endif
