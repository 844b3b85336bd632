/*
 * Plans: effect overrides in a job document, and the plan in result.json.
 *
 * A job document's "effects" is an object from names of effects (orl_effect_name) to "auto",
 * "force" or "skip". "caustics" stands for caustics_mirror, caustics_bsdf and caustics_glass. One
 * of these named beside it overrides it, in any order.
 *
 * A result's "plan", and what `oriel plan --json` prints:
 *
 *     {"technique": "gather", "why": "...", "most_reflections": 12 or null (all of them),
 *      "channels": 1 or 3, "photons": {"global": 2000000, "caustic": 0},
 *      "effects": [{"effect": "sun", "simulated": true, "wish": "auto", "why": "...",
 *                   "bound": null or {"value": 0.2, "unit": "lx" or "relative"},
 *                   "saved_s": 0.5}, ...]}
 *
 * with every effect once, in the order of enum orl_effect. A bound that is not finite has the
 * value null. Functions return new references, owned by the caller, or NULL when out of memory.
 */
#ifndef ORL_API_JOB_PLAN_JSON_H
#define ORL_API_JOB_PLAN_JSON_H

#include <oriel/job/plan.h>

#include "json/members.h"

/* Decodes the name of a technique; techniques before first in the enum are refused. */
int orl_technique_from_json(const json_t *value, const char *path, enum orl_technique first,
                            enum orl_technique *ret_technique, struct orl_error *err);

/* Decoder of "effects" into an array of enum orl_effect_override, one per effect, which holds
 * defaults. */
orl_json_decoder orl_effect_overrides_from_json;

/* Returns json null for a plan that was never made (its technique is still ORL_TECHNIQUE_AUTO). */
json_t *orl_plan_to_json(const struct orl_plan *plan);

#endif
