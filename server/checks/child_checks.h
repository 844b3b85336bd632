/*
 * What a child does: reads its request, opens the files that it names, gives up all that reading
 * them does not take (confine.h), reads them, and says what it found.
 *
 * The request is {"kind", "memory", "cpu_s", ...}, the verdict {"error": {...}} or {"result": ...}:
 *
 *     scene     "files": [{"name", "path", "sha", "bytes", "resource"}], mains first, "choice" or
 * none
 *               -> the summary (scene_json.h), with a choice "project" (honeybee/project.h), too
 *     bsdf      "path", "name" -> the summary (bsdf_json.h)
 *     job       "path" -> job_brief.h
 *     unzip     "path" -> FILE and DATA packets, then null
 *     files     "path", of {"files": [...], "bsdfs": {...}} -> the same, then {"resources": [...],
 *               "bsdfs": {...}}; of a Honeybee model -> its files, then {"model": true}
 *     roles     "files", "choice": {"states", "sky"} -> places of main ones among these, else 0
 *     inputs    "files", "uses": [[name, role, entry or null], ...], "path" of the document or none
 *               -> what was found, in the order of struct orl_job_inputs_found (job_inputs.h)
 *     plan      "path", "files" -> child_plan.h
 *     outline   "files", "height"; polar: "path", "front", "theta_deg", "phi_deg" -> child_looks.h
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHECKS_H
#define ORL_SERVER_CHECKS_CHILD_CHECKS_H

#include <jansson.h>

#include <oriel/error.h>

/* In the child, over the socket. */
void orl_child_check(int fd);

/* Errors on their way. */
json_t *orl_child_error_to_json(const struct orl_error *err);
void orl_child_error_from_json(const json_t *json, struct orl_error *ret_err);

#endif
