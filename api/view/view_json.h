/*
 * Views in JSON: a view of a job, its pictures and glare, and sequences of views under several
 * skies. A view of a job document:
 *
 *     {"name": "desk", "view": "-vtv -vp ...", "width": 400, "height": 300, "pixel_aspect": 1, ...}
 *     {"name": "desk", "file": "desk.vf", "entry": 2, "width": 400, "height": 300, ...}
 *
 * Width and height may be left out if the options of "view" have -x and -y. "entry" is a number or
 * a name. The other members are below.
 */
#ifndef ORL_API_VIEW_VIEW_JSON_H
#define ORL_API_VIEW_VIEW_JSON_H

#include <jansson.h>
#include <stdatomic.h>

#include <oriel/job/glare.h>
#include <oriel/job/run.h>

#include "json/decode.h"

/* Decoder into a struct orl_view_request of zeros. */
orl_json_decoder orl_view_from_json;

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

orl_json_decoder orl_glare_metrics_from_json;  /* decoder; sets bits of a uint32_t */
orl_json_decoder orl_glare_settings_from_json; /* decoder into a struct orl_glare_settings */

/* Returns a new reference, or NULL when out of memory. metrics: bits of the metrics to report. */
json_t *orl_glare_to_json(const struct orl_glare *glare, uint32_t metrics);

/*
 * Sequences: a job's views under all its skies, drawn for comparison.
 *
 *     "sequence": {"frame_s": 0.5, "columns": 4, "picture_width": 240}
 *
 * all optional. Each view gets files: its pictures with one common exposure, a contact sheet and
 * an animation, both PNG. A view that asks for DGP also gets a chart of DGP over the skies. In the
 * job's result:
 *
 *     "sequence": [{"view": "desk", "frames": ["sequence.desk.frame-0322-0630.png", ...],
 *                   "sheet": "sequence.desk.sheet.png",
 *                   "animation": "sequence.desk.animation.png",
 *                   "dgp_png": "sequence.desk.dgp.png", "dgp_svg": "sequence.desk.dgp.svg"}]
 */

/* Decoder (decode.h) into a struct orl_sequence_request. */
orl_json_decoder orl_sequence_from_json;

/*
 * Draws the sequence if the job asks for one, and adds its file names to results. Input is the
 * results of all skies (result_json.h) and the pictures in the folder. cancel: polled; may
 * be NULL. Returns 0 or a negative orl_err.
 */
int orl_sequence_draw(const struct orl_job *job, const char *folder, const atomic_bool *cancel,
                      json_t *results, struct orl_error *err);

#endif
