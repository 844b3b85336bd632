/*
 * A study document (JSON) -> struct orl_study_request, and struct orl_study -> study.json.
 *
 *     {"kind": "study", "title": "The office", "note": "Where ... was measured" (both optional),
 *      "scene", "sky", "effects", "seed": as in a job (job_json.h),
 *      "sensors" or "views": as in a job, one of the two,
 *      "techniques": ["backward", "gather", "direct", "precomputed"],
 *      "photons": [250000, 1000000] (of each kind; for techniques of photon maps),
 *      "gather_samples": [256, 4096] (a sensor's rays), or "pixel_samples": [16, 64] (a pixel's
 *      paths; the backward technique's views alone take notice),
 *      "repeats": 3 (seeds of every setting),
 *      "reference": {"samples": 65536, "runs": 8 (seeds that share these)},
 *      "points": [{"name": "Radiance, cached", "seconds": 142, "rms": 0.056,
 *      "rays_per_s": 4.9e6 (the machine's: oriel/study.h; optional)}] (optional)}
 *
 * study.json:
 *     {"kind": "study", "title", "note", "threads", "rays_per_s", "measured": "sensors" or "views",
 *      "reference": {"samples", "runs", "seconds", "values", "left_out", "standard_error",
 * "worst"}, "points": [{"technique", "photons", "samples" (null: not heeded), "seeds", "seconds":
 * {"load", ..., "render", "total", "total_error"}, "rms", "rms_error", "bias", "bias_error",
 * "noise", "p95", "peak", "map_bytes", "reference_shows", "on_front"}], "fits": [{"technique",
 * "points", "terms": {"kernel": {"value", "error"}, ...}, "chi2", "residual"}], "given": [{"name",
 * "seconds", "rms", "rays_per_s", "here_s"}], "warnings": [...]} Numbers that are not known are
 * null. What they mean is in oriel/study.h; errors are fractions.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_STUDY_JSON_H
#define ORL_API_STUDY_JSON_H

#include <jansson.h>

#include <oriel/error.h>
#include <oriel/study.h>

#include "job_json.h"

/*
 * Decodes doc; origin and ret_scene_id as in orl_job_from_json. What is checked is each value by
 * itself: the rest is orl_study_request_validate's.
 */
int orl_study_from_json(const json_t *doc, enum orl_job_origin origin,
                        struct orl_study_request *ret_request, char **ret_scene_id,
                        struct orl_error *err);

/* The setting as "technique", "photons" and "samples" (null: not heeded), in a new reference. */
json_t *orl_study_setting_to_json(const struct orl_study_setting *setting);

/* In short, for progress: the setting, "total_s", "rms" and "rms_error". */
json_t *orl_study_point_in_short(const struct orl_study_point *point);

/* A new reference, the caller's; NULL when out of memory. request: what it was asked by. */
json_t *orl_study_to_json(const struct orl_study *study, const struct orl_study_request *request);

#endif
