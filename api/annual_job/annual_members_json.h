/*
 * Members of a year's document and of its result: grids, matrices, shades, exposure to sunlight,
 * view out and glare. annual_json.h has the document's format, rules and errors.
 *
 * annual_grids_json.c and annual_shades_json.c have grids and shades, annual_members_json.c the
 * other members.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_MEMBERS_JSON_H
#define ORL_API_ANNUAL_JOB_ANNUAL_MEMBERS_JSON_H

#include <jansson.h>

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_report.h>

#include "annual_job/annual_json.h"

/* Decodes scene, grids and sensors of doc after all its other members are decoded. The caller
 * frees what job owns, also after an error. */
int orl_annual_grids_from_json(const json_t *doc, enum orl_job_origin origin,
                               struct orl_annual_job *job, char **ret_scene_id,
                               struct orl_error *err);

/*
 * Matrices of other programs in a year's document, in place of path tracing (MatrixTerm of
 * api/schema/annual.yaml). oriel/annual/annual.h defines them.
 */

/* Decoder (decode.h) into a struct orl_annual_request. */
int orl_annual_matrices_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/*
 * Shades in a year's document (WindowGroup of api/schema/annual_parts.yaml) and in its result.
 * oriel/annual/annual_shades.h defines the terms. By default, a control closes the group to its
 * second state.
 */

/* Decoder (decode.h) into a struct orl_annual_request. */
int orl_annual_shades_from_json(const json_t *value, const char *path, void *into,
                                struct orl_error *err);

/* Hours with light that a group spends in a state: all, and those in use. */
struct orl_state_hours {
    double lit, occupied;
};
/* Fills in the hours of each state of a group. The year must have shades. */
void orl_annual_state_hours(const struct orl_annual_result *result,
                            const struct orl_annual_report *report, size_t group,
                            struct orl_state_hours ret_hours[ORL_SHADES_MOST_STATES]);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_shades_to_json(const struct orl_annual_request *request,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_report *report);
/* Returns the shades' settings as requested, without series; ownership as above. */
json_t *orl_annual_shades_settings(const struct orl_annual_request *request);

/*
 * Exposure to sunlight in a year's document and in its result. oriel/annual/sun_exposure.h defines
 * the terms.
 * SunExposure of api/schema/annual_parts.yaml describes it, and ExposureResult its result.
 */

/* Decoder (decode.h) into a struct orl_exposure_request. */
int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_exposure_to_json(const struct orl_exposure_request *exposure_request,
                                    const struct orl_annual_report *report);

/*
 * View out in a year's document and in its result. oriel/annual/view_out.h defines the terms.
 * ViewOut of api/schema/annual_parts.yaml describes it, and ViewOutResult its result. At least one
 * of points and above_sensors is required.
 */

/* Decoder (decode.h) into a struct orl_view_out_request. */
int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_view_out_to_json(const struct orl_view_out_request *view_out_request,
                                    const struct orl_annual_report *report);

/*
 * Glare in a year's document and in its result. oriel/annual/annual_glare.h defines the terms.
 * AnnualGlare of api/schema/annual_parts.yaml describes it, and AnnualGlareResult its result.
 * glare.csv has every lit hour of use.
 */

/* Decoder (decode.h) into a struct orl_viewpoint_request. */
int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err);

/* Decoder of the "seats" array alone into a struct orl_viewpoint_request. */
int orl_viewpoints_from_json(const json_t *value, const char *path, void *into,
                             struct orl_error *err);

/* Returns a new reference, owned by the caller, or NULL when out of memory. */
json_t *orl_annual_glare_to_json(const struct orl_viewpoint_request *viewpoint_request,
                                 const struct orl_annual_result *result,
                                 const struct orl_annual_report *report);

#endif
