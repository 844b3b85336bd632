/*
 * Glare in JSON, both ways.
 *
 * Of a view in a job:
 *     "metrics": ["dgp", "ugr", ...] or ["all"], names as orl_glare_metric_name has them,
 *     "glare": {"threshold": 5, "task": {"x": 200, "y": 90, "angle_rad": 0.6}, "radius_rad": 0.2,
 *               "smooth": true, "peak_cd_m2": 50000, "peaks": false, "formula": "published",
 *               "low_light_correction": true, "age_years": 60, "vertical_illuminance_lx": 1200,
 *               "position": "whole_pixels", "directions": {"count": 9, "span_deg": 120}}
 * all of which may be left out. Of a result, what orl_glare_to_json makes; unknown numbers are
 * null.
 */
#ifndef ORL_API_GLARE_JSON_H
#define ORL_API_GLARE_JSON_H

#include <oriel/glare.h>

#include "members.h"

orl_json_decoder orl_glare_metrics_from_json;  /* adds to a uint32_t, as bits */
orl_json_decoder orl_glare_settings_from_json; /* into a struct orl_glare_settings */

/* A new reference; NULL when out of memory. metrics: those that are told. */
json_t *orl_glare_to_json(const struct orl_glare *glare, uint32_t metrics);

#endif
