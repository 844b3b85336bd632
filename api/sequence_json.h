/*
 * Sequences: a job's views under its skies, to be compared.
 *
 *     "sequence": {"frame_s": 0.5, "columns": 4, "picture_width": 240}
 *
 * all of which may be left out. Of each view come files: its pictures in one common exposure, a
 * contact sheet and an animation, both PNG, and, where it asks for DGP, how that goes from sky to
 * sky. In the job's result:
 *
 *     "sequence": [{"view": "desk", "frames": ["sequence.desk.frame-0322-0630.png", ...],
 *                   "sheet": "sequence.desk.sheet.png",
 *                   "animation": "sequence.desk.animation.png",
 *                   "dgp_png": "sequence.desk.dgp.png", "dgp_svg": "sequence.desk.dgp.svg"}]
 */
#ifndef ORL_API_SEQUENCE_JSON_H
#define ORL_API_SEQUENCE_JSON_H

#include <jansson.h>
#include <stdatomic.h>

#include <oriel/run.h>

#include "members.h"

/* Into a struct orl_sequence_request. */
orl_json_decoder orl_sequence_from_json;

/*
 * Draws what the job asks for, if it does, from the results of all of its skies
 * (skies_result_json.h) and the pictures in the folder, and tells of it in results. cancel: polled;
 * may be NULL. Returns 0 or a negative orl_err.
 */
int orl_sequence_draw(const struct orl_job *job, const char *folder, const atomic_bool *cancel,
                      json_t *results, struct orl_error *err);

#endif
