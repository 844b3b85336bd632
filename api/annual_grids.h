/*
 * The grids of a year's document, and its scene (annual_json.h has the document, its rules
 * and errors).
 */
#ifndef ORL_API_ANNUAL_GRIDS_H
#define ORL_API_ANNUAL_GRIDS_H

#include "annual_json.h"

/* Of a document whose other members are decoded. What is filled in is the caller's to free, also
 * after an error. */
int orl_annual_grids_from_json(const json_t *doc, enum orl_job_origin origin,
                               struct orl_annual_job *job, char **ret_scene_id,
                               struct orl_error *err);

#endif
