/*
 * A year's document (JSON) -> struct orl_annual_job, and its results -> result.json.
 *
 *     {"kind": "annual", "title": "The office" (optional),
 *      "scene": as in a job (job_json.h), without a sky of its own,
 *      "weather": "oakland.epw" (or .wea), "north": 0 (degrees, counter-clockwise from +Y),
 *      "ground_reflectance": 0.2, "sun": "accurate" (or "radiance": as gendaylit places it),
 *      "grids": [{"name": "desks" (by default its file's name), "area": 20.5 (for all or none),
 *                 "sensors": {"file": "desks.pts"} or [[x, y, z, dx, dy, dz], ...]}],
 *      or "sensors" alone, as in a job,
 *      "shades": [...], "matrices": [...] (annual_members_json.h),
 *      "occupancy": {"from": 8, "to": 18, "days": ["mon", ...], "first_day": "sun"}
 *                   or {"file": "occupancy.csv"} (oriel/annual/annual_metrics.h),
 *      "metrics": ["DA300", "UDI100-3000", ...], "targets": ["sDA300/50 >= 55 %", ...],
 *      "rules": ["EN 17037", "LEED", ...], "samples": 2048 (paths per sensor), "seed": 0,
 *      "sun_halvings": 0 (to 2: how often the distance between the sun's nodes is halved),
 *      "technique": "paths" or "precomputed", "photons": 300000 (by default chosen for the scene),
 *      "median_diffuse": 14200 (lx outside, for daylight factors; by default from the weather),
 *      "exposure": {...}, "view_out": {...}, "glare": {...} (annual_members_json.h),
 *      "accuracy": {"verdict": "sDA300/50 >= 55 %"} (more paths for
 *      sensors that leave the verdict open; "samples" then is for the first round, by default 256),
 *      "formats": ["honeybee", "ill", "coefficients", "phases"] (files beside the usual ones),
 *      "priority": 5 (read by job_request_json.h)}
 *
 * result.json:
 *     {"kind": "annual", "state", "title", "location": {"latitude", "longitude", "time_zone"},
 *      "hours": {"occupied", "daylight", "year", "missing", "doubtful", "sun_up"},
 *      "median_diffuse" (lx: as given, or from the weather),
 *      "grids": [{"name", "sensors", "figures": [{"name", "unit", "value", "interval_95", "open"
 *      (undecided sensors)}]}], "all": {likewise} (for several grids together),
 *      "verdicts": [{"rule", "clause" (null: the job's own target), "target", "grid" (null: all),
 *      "unit", "value", "interval_95", "open", "verdict", "note" (why undecided; null: by its
 *      interval, or decided), "hours" (behind the figure; null: a daylight factor)}],
 *      "rules": [{"rule", "grid", "verdict", "note"}] (over all targets of each),
 *      "accuracy": null or {"target", "value", "interval_95", "verdict", "settled", "rounds",
 *      "refined_sensors", "most_samples", "sun_halvings"} (oriel/annual/annual_report.h),
 *      "shades": null or the states of window groups (annual_members_json.h),
 *      "exposure": null or hours of visible sun at points in windows (annual_members_json.h),
 *      "view_out": null or distance and width of the view out (annual_members_json.h),
 *      "glare": null or glare at seats (annual_members_json.h),
 *      "files": [...] (names below the result's folder), "provenance": {"version", "seed",
 *      "samples", "inputs": [{"name", "bytes", "sha256"}], "settings": {...},
 *      "document": from which `oriel verify` repeats the year},
 *      "reuse": null or {"suns", "map", "paths", "sun": {"found", "topped_up", "made"},
 *      "rays_saved"} (from earlier jobs' results: oriel/annual/annual.h), "rays" (of this run's
 * paths), "timings_s", "threads", "warnings"} Unknown numbers are null.
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
