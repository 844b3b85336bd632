/*
 * Decodes the grids and the scene of a year's document. annual_json.h has the document's format,
 * rules and errors.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_GRIDS_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_GRIDS_JSON_H

#include "annual_job/annual_json.h"

/* Decodes scene, grids and sensors of doc after all its other members are decoded. The caller
 * frees what job owns, also after an error. */
int orl_annual_grids_from_json(const json_t *doc, enum orl_job_origin origin,
                               struct orl_annual_job *job, char **ret_scene_id,
                               struct orl_error *err);

#endif
