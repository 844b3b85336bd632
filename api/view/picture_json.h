/*
 * Pictures of a view, in a job document and in results.
 *
 *     "formats": ["hdr", "png", "png16", "exr", "exr_float"]
 *     "display": {"tone": "human", "veil": true, "acuity": true, "color_loss": true}
 *                {"tone": "linear"}   {"exposure": 0.5}   {"ev": 9}
 *     "false_color": {"scale": 2000 or "auto", "decades": 2, "divisions": 8, "palette": "even",
 *                     "label": "cd/m2", "multiplier": 179, "isolines": true, "extrema": true,
 *                     "draw": ["fill", "lines", "bands"],
 *                     "points": [{"name": "desk", "x": 20, "y": 30}]}
 */
#ifndef ORL_API_VIEW_PICTURE_JSON_H
#define ORL_API_VIEW_PICTURE_JSON_H

#include <oriel/job/run.h>

#include "json/members.h"

orl_json_decoder orl_formats_from_json; /* decoder; sets bits of a uint32_t */
orl_json_decoder orl_display_from_json; /* decoder into a struct orl_display of zeros */
/* Decoder into a struct orl_view_request that has its size. The request owns the points, also
 * after a failure. */
orl_json_decoder orl_false_color_from_json;

/* Decoder into a double: a number, or "auto", which leaves it unchanged. Heat maps use it too. */
orl_json_decoder orl_scale_from_json;
orl_json_decoder orl_palette_from_json; /* decoder into an enum orl_palette */
/* Decoder into a char[ORL_PICTURE_LABEL_MAX]: a label of characters that the drawing font has. */
orl_json_decoder orl_label_from_json;

/* Adds to a result's view the file names and the scale and points of its false-colour picture:
 *     "hdr": "a.hdr", ..., "scale": 2000, "points": [{"name": "desk", "value": 310}]
 * Returns nonzero when out of memory. */
int orl_pictures_to_json(const struct orl_view_result *view, json_t *json);

/* Reads these members back into a view that has none of them; its strings are owned. Returns false
 * when out of memory; the caller frees what the view has by then. */
bool orl_pictures_read_back(const json_t *json, struct orl_view_result *view);

#endif
