/*
 * Previews of stored objects, made in a check child: a scene's floor plan, and the directions into
 * which a BSDF scatters light. Nothing is freed: the process ends with the check.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHILD_PREVIEWS_H
#define ORL_SERVER_CHECKS_CHILD_CHILD_PREVIEWS_H

#include "checks/child/mapped_inputs.h"

/* The request has "height", a number or null; the result is scene_json.h's. */
int orl_child_outline(const json_t *request, struct orl_mapped_inputs *mapped, json_t **ret_result,
                      struct orl_error *err);
/* The request has "front", "theta_deg" and "phi_deg"; the result is bsdf_json.h's. */
int orl_child_polar(const json_t *request, const struct orl_mapped_inputs *mapped,
                    json_t **ret_result, struct orl_error *err);

#endif
