/*
 * A job document (JSON) -> struct orl_job.
 *
 *     {"kind": "render", "scene": "<id>" or {"files": ["room.rad", ...]},
 *      "technique": "auto" (the default), "backward", "gather", "direct" or "precomputed",
 *      "effects": {"caustics": "skip", ...} (plan_json.h), "seed": 1,
 *      "photons": {"global": 2000000, "caustic": 2000000} (each by the plan when left out),
 *      "gather_samples": 4096 (a sensor's rays), "pixel_samples": 64 (a pixel's paths, backward),
 *      "sky": {...} (sky_json.h), only with a scene that has none,
 *      "skies": [{...}, ...] instead, or a sequence of hours (skies_json.h),
 *      "sensors": {"file": "sensors.txt"} or [[x, y, z, dx, dy, dz], ...],
 *      "grids": [...] instead, with names (grids_json.h),
 *      "priority": 5 (read by task_json.h; means something to the daemon alone),
 *      "views": [{"name": "desk", "view": "-vtv -vp ...", "width": 400, "height": 300}]}
 *
 * Only scene, and sensors or views or both, are required. Members that are not listed above are
 * errors, so that a misspelt setting cannot pass unnoticed. Messages name the JSON path
 * ("photons.globl") in orl_error.primitive and in the sentence.
 *
 * Ownership: documents are borrowed; what is returned is the caller's.
 * Threads: none of this keeps state; call it from anywhere, one document per thread.
 */
#ifndef ORL_API_JOB_JSON_H
#define ORL_API_JOB_JSON_H

#include <jansson.h>

#include <oriel/error.h>
#include <oriel/run.h>

/* Who wrote the document: a user of the command line (names files) or a client (names an id). */
enum orl_job_origin { ORL_JOB_LOCAL, ORL_JOB_REMOTE };

/*
 * Decodes doc. ORL_JOB_LOCAL: "scene" is {"files": [...]}, copied to ret_job->scene_files, and
 * *ret_scene_id becomes NULL. ORL_JOB_REMOTE: "scene" is an id (64 lower-case hexadecimal digits),
 * returned owned (free()) in *ret_scene_id; scene_files stays empty for the caller to fill in.
 * ret_scene_id may be NULL for ORL_JOB_LOCAL. On success the caller owns ret_job (orl_job_done).
 * Errors: ORL_ERR_INVALID (members, types), ORL_ERR_RANGE, ORL_ERR_LIMIT, ORL_ERR_NOMEM.
 * What needs the view strings, their names compared, or the scene is orl_job_validate's to check.
 */
int orl_job_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_job *ret_job,
                      char **ret_scene_id, struct orl_error *err);

/* A part that other documents have too, into job, whose others are left alone: the scene (NULL:
 * absent; ret_scene_id as above). What was read before an error stays in job. */
int orl_job_scene_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            struct orl_job *job, char **ret_scene_id, struct orl_error *err);
/* The same as names alone, which are the caller's. */
int orl_job_files_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            char ***ret_files, size_t *ret_count, char **ret_scene_id,
                            struct orl_error *err);

#endif
