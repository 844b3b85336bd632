/*
 * A year's document (JSON) -> struct orl_annual_job, and what was found -> result.json.
 *
 *     {"kind": "annual", "title": "The office" (optional),
 *      "scene": as in a job (job_json.h), without a sky of its own,
 *      "weather": "oakland.epw" (or .wea), "north": 0 (degrees, counter-clockwise from +Y),
 *      "ground_reflectance": 0.2, "sun": "accurate" (or "radiance": as gendaylit places it),
 *      "grids": [{"name": "desks" (by default its file's name), "area": 20.5 (for all or none),
 *                 "sensors": {"file": "desks.pts"} or [[x, y, z, dx, dy, dz], ...]}],
 *      or "sensors" alone, as in a job,
 *      "shades": [...] (annual_shades.h), "matrices": [...] (annual_matrices.h),
 *      "occupancy": {"from": 8, "to": 18, "days": ["mon", ...], "first_day": "sun"}
 *                   or {"file": "occupancy.csv"} (oriel/annual_metrics.h),
 *      "metrics": ["DA300", "UDI100-3000", ...], "targets": ["sDA300/50 >= 55 %", ...],
 *      "rules": ["EN 17037", "LEED", ...], "samples": 2048 (paths a sensor), "seed": 0,
 *      "sun_halvings": 0 (to 2: how often the distance between the sun's nodes is halved),
 *      "technique": "paths" or "precomputed", "photons": 300000 (by default as the scene has it),
 *      "median_diffuse": 14200 (lx outside, for daylight factors; by default of the weather),
 *      "exposure": {...} (annual_exposure.h), "view_out": {...} (annual_view_out.h),
 *      "glare": {...} (annual_glare.h),
 *      "accuracy": {"verdict": "sDA300/50 >= 55 %"} (more paths for those sensors that leave it
 * open; "samples" are those of the first round then, 256 when left out),
 *      "formats": ["honeybee", "ill", "coefficients", "phases"] (files beside the usual ones),
 *      "priority": 5 (read by task_json.h)}
 *
 * result.json:
 *     {"kind": "annual", "state", "title", "location": {"latitude", "longitude", "time_zone"},
 *      "hours": {"occupied", "daylight", "year", "missing", "doubtful", "sun_up"},
 *      "median_diffuse" (lx: as given, or of the weather),
 *      "grids": [{"name", "sensors", "figures": [{"name", "unit", "value", "interval_95", "open"
 *      (sensors whose side is open)}]}], "all": {the same} (of several grids together),
 *      "verdicts": [{"rule", "clause" (null: the job's own target), "target", "grid" (null: all),
 *      "unit", "value", "interval_95", "open", "verdict", "note" (why it is undecided; null: by its
 *      interval, or it is not), "hours" (that the figure is of; null: a daylight factor)}],
 *      "rules": [{"rule", "grid", "verdict", "note"}] (all targets of each),
 *      "accuracy": null or {"target", "value", "interval_95", "verdict", "settled", "rounds",
 *      "refined_sensors", "most_samples", "sun_halvings"} (oriel/annual_report.h),
 *      "shades": null or what states window groups were in (annual_shades.h),
 *      "exposure": null or for how long points at windows can see the sun (annual_exposure.h),
 *      "view_out": null or how far and wide places see out (annual_view_out.h),
 *      "glare": null or how seats are dazzled (annual_glare.h),
 *      "files": [...] (names below the result's folder), "provenance": {"version", "seed",
 *      "samples", "inputs": [{"name", "bytes", "sha256"}], "settings": {...},
 *      "document": the year's, by which `oriel verify` repeats it},
 *      "reuse": null or {"suns", "map", "paths", "sun": {"found", "topped_up", "made"},
 *      "rays_saved"} (of what earlier jobs left: oriel/annual.h), "rays" (of paths, in this run),
 *      "timings_s", "threads", "warnings"}
 * Numbers that are not known are null.
 *
 * Rules, ownership, threads and errors as in job_json.h.
 */
#ifndef ORL_API_ANNUAL_JSON_H
#define ORL_API_ANNUAL_JSON_H

#include <jansson.h>

#include <oriel/annual_report.h>

#include "job_json.h"

/* Files of all hours: Honeybee's results folder; Radiance's matrices; daylight coefficients;
 * matrices of phases. */
struct orl_annual_formats {
    bool honeybee, matrices, coefficients, phases;
};

/* All of it owned; orl_annual_job_done frees it. */
struct orl_annual_job {
    char *title;
    char *document; /* what it was decoded from, in a line */
    struct orl_annual_request
        request; /* sensors of files are not read yet: orl_annual_grids_read */
    struct orl_annual_wishes wishes;
    char **grid_files; /* of each grid; NULL where its sensors are written out */
    bool bare;         /* the document has sensors, which are its one grid */
    struct orl_annual_formats formats;
};
void orl_annual_job_done(struct orl_annual_job *job); /* NULL and zeros are fine */

/* Decodes doc; origin and ret_scene_id as in orl_job_from_json. */
int orl_annual_job_from_json(const json_t *doc, enum orl_job_origin origin,
                             struct orl_annual_job *ret_job, char **ret_scene_id,
                             struct orl_error *err);

/* Checks it as far as that goes without the scene, weather and sensors of files. */
int orl_annual_job_validate(const struct orl_annual_job *job, struct orl_error *err);

/* How the accuracy stands, as result.json has it; null where none is asked for. A new reference, or
 * NULL when out of memory. */
json_t *orl_annual_refinement_to_json(const struct orl_annual_refinement *refinement);

/* A new reference, the caller's; NULL when out of memory. files: an array of names, borrowed. */
json_t *orl_annual_report_to_json(const struct orl_annual_job *job,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_refinement *refinement,
                                  const struct orl_annual_report *report,
                                  const struct orl_annual_inputs *inputs, json_t *files);

#endif
