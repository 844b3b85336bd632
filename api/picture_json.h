/*
 * Pictures of a view: what a job document asks for, and how results tell of them.
 *
 *     "formats": ["hdr", "png", "png16", "exr", "exr_float"]
 *     "display": {"tone": "human", "veil": true, "acuity": true, "color_loss": true}
 *                {"tone": "linear"}   {"exposure": 0.5}   {"ev": 9}
 *     "false_color": {"scale": 2000 or "auto", "decades": 2, "divisions": 8, "palette": "even",
 *                     "label": "cd/m2", "multiplier": 179, "isolines": true, "extrema": true,
 *                     "draw": ["fill", "lines", "bands"],
 *                     "points": [{"name": "desk", "x": 20, "y": 30}]}
 */
#ifndef ORL_API_PICTURE_JSON_H
#define ORL_API_PICTURE_JSON_H

#include <oriel/run.h>

#include "members.h"

orl_json_decoder orl_formats_from_json; /* into a uint32_t, as bits */
orl_json_decoder orl_display_from_json; /* into a struct orl_display of zeros */
/* Into a struct orl_view_request that has its size; the points are owned by it, also when this
 * fails. */
orl_json_decoder orl_false_color_from_json;

/* What heat maps have of it, too: a number, or "auto", which leaves the double alone. */
orl_json_decoder orl_scale_from_json;
orl_json_decoder orl_palette_from_json; /* into an enum orl_palette */
/* A word that is drawn, of what fonts have: into char[ORL_PICTURE_LABEL_MAX]. */
orl_json_decoder orl_label_from_json;

/* Adds the names of the files to a result's view, and what false colours have found:
 *     "hdr": "a.hdr", ..., "scale": 2000, "points": [{"name": "desk", "value": 310}]
 * Nonzero: out of memory. */
int orl_pictures_to_json(const struct orl_view_result *view, json_t *json);

/* The same read back, into a view that has none of it; its strings are owned. False: out of memory,
 * with what is there to be freed. */
bool orl_pictures_read_back(const json_t *json, struct orl_view_result *view);

#endif
