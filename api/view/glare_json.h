/*
 * Glare in JSON, decoded and encoded.
 *
 * In a job's view:
 *     "metrics": ["dgp", "ugr", ...] or ["all"], names as in orl_glare_metric_name,
 *     "glare": {"threshold": 5, "task": {"x": 200, "y": 90, "angle_rad": 0.6}, "radius_rad": 0.2,
 *               "smooth": true, "peak_cd_m2": 50000, "peaks": false, "formula": "published",
 *               "low_light_correction": true, "age_years": 60, "vertical_illuminance_lx": 1200,
 *               "position": "whole_pixels", "directions": {"count": 9, "span_deg": 120}}
 * all optional. A result has the output of orl_glare_to_json; unknown numbers are null.
 */
#ifndef ORL_API_VIEW_GLARE_JSON_H
#define ORL_API_VIEW_GLARE_JSON_H

#include <oriel/job/glare.h>

#include "json/members.h"

orl_json_decoder orl_glare_metrics_from_json;  /* decoder; sets bits of a uint32_t */
orl_json_decoder orl_glare_settings_from_json; /* decoder into a struct orl_glare_settings */

/* Returns a new reference, or NULL when out of memory. metrics: bits of the metrics to report. */
json_t *orl_glare_to_json(const struct orl_glare *glare, uint32_t metrics);

#endif
