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
#ifndef ORL_API_VIEW_SEQUENCE_JSON_H
#define ORL_API_VIEW_SEQUENCE_JSON_H

#include <jansson.h>
#include <stdatomic.h>

#include <oriel/job/run.h>

#include "json/members.h"

/* Decoder (members.h) into a struct orl_sequence_request. */
orl_json_decoder orl_sequence_from_json;

/*
 * Draws the sequence if the job asks for one, and adds its file names to results. Input is the
 * results of all skies (skies_result_json.h) and the pictures in the folder. cancel: polled; may
 * be NULL. Returns 0 or a negative orl_err.
 */
int orl_sequence_draw(const struct orl_job *job, const char *folder, const atomic_bool *cancel,
                      json_t *results, struct orl_error *err);

#endif
