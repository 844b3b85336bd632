/*
 * A study document (JSON) -> struct orl_study_request, and struct orl_study -> study.json.
 *
 *     {"kind": "study", "title": "The office", "note": "Where ... was measured" (optional),
 *      "scene", "sky", "effects", "seed": as in a job (job_json.h),
 *      "sensors" or "views": as in a job, one of the two,
 *      "techniques": ["backward", "gather", "direct", "precomputed"],
 *      "photons": [250000, 1000000] (per kind; for techniques with photon maps),
 *      "gather_samples": [256, 4096] (rays per sensor), or "pixel_samples": [16, 64] (paths
 *      per pixel; used only for views of the backward technique),
 *      "repeats": 3 (seeds per setting),
 *      "reference": {"samples": 65536, "runs": 8 (seeds that share the samples)},
 *      "points": [{"name": "Radiance, cached", "seconds": 142, "rms": 0.056,
 *      "rays_per_s": 4.9e6 (of the machine: oriel/job/study.h; optional)}] (optional)}
 *
 * study.json:
 *     {"kind": "study", "title", "note", "threads", "rays_per_s", "measured": "sensors" or "views",
 *      "reference": {"samples", "runs", "seconds", "values", "left_out", "standard_error",
 *                    "worst"},
 *      "points": [{"technique", "photons", "samples" (null: not used), "seeds",
 *                  "seconds": {"load", ..., "render", "total", "total_error"}, "rms", "rms_error",
 *                  "bias", "bias_error", "noise", "p95", "peak", "map_bytes", "reference_shows",
 *                  "on_front"}],
 *      "fits": [{"technique", "points", "terms": {"kernel": {"value", "error"}, ...}, "chi2",
 *                "residual"}],
 *      "given": [{"name", "seconds", "rms", "rays_per_s", "here_s"}], "warnings": [...]}
 *
 * Unknown numbers are null. Errors are fractions. oriel/job/study.h defines the terms.
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
