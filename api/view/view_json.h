/*
 * Views in JSON: a view of a job, its pictures and glare, and sequences of views under several
 * skies. api/schema/view.yaml describes them. Width and height may be left out if the options of
 * "view" have -x and -y.
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

/* ---- Pictures of a view, in a job document and in results ------------------------------------ */

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
 * Glare in JSON, decoded and encoded: "metrics" and "glare" of a view (api/schema/glare.yaml), and
 * Glare of a result (api/schema/result_glare.yaml). Unknown numbers are null.
 */

orl_json_decoder orl_glare_metrics_from_json;  /* decoder; sets bits of a uint32_t */
orl_json_decoder orl_glare_settings_from_json; /* decoder into a struct orl_glare_settings */

/* Returns a new reference, or NULL when out of memory. metrics: bits of the metrics to report. */
json_t *orl_glare_to_json(const struct orl_glare *glare, uint32_t metrics);

/*
 * Sequences: a job's views under all its skies, drawn for comparison.
 * Sequence of api/schema/view.yaml describes the request, and SequenceFiles the result. Each view
 * gets its pictures with one common exposure, a contact sheet and an animation, both PNG. A view
 * that asks for DGP also gets a chart of DGP over the skies.
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
