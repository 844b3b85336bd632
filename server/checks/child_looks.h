/*
 * What a child makes of things that are stored, to be looked at: a scene's floor plan, where a BSDF
 * sends light. In the child's process alone; nothing is given back.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_LOOKS_H
#define ORL_SERVER_CHECKS_CHILD_LOOKS_H

#include "checks/opened.h"

/* The request has "height", a number or null; the result is scene_json.h's. */
int orl_child_outline(const json_t *request, struct orl_opened *opened, json_t **ret_result,
                      struct orl_error *err);
/* The request has "front", "theta_deg" and "phi_deg"; the result is bsdf_json.h's. */
int orl_child_polar(const json_t *request, const struct orl_opened *opened, json_t **ret_result,
                    struct orl_error *err);

#endif
