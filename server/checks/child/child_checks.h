/*
 * The work of a check child: it reads its request, opens the files that the request names, gives up
 * every privilege that reading them does not need (sandbox.h), reads them, and sends a verdict.
 *
 * The request is {"kind", "memory", "cpu_s", ...}, the verdict {"error": {...}} or {"result": ...}:
 *
 *     scene     "files": [{"name", "path", "sha", "bytes", "resource"}], main files first
 *               -> the summary (scene_json.h); if the request has a "choice", with "project"
 *               (project/project.h)
 *     bsdf      "path", "name" -> the summary (bsdf_json.h)
 *     job       "path" -> job_manifest.h
 *     unzip     "path" -> FILE and DATA packets, then null
 *     files     "path", of {"files": [...], "bsdfs": {...}} -> FILE and DATA packets, then
 *               {"resources": [...], "bsdfs": {...}}; of a Honeybee model -> its files, then
 *               {"model": true}
 *     roles     "files", "choice": {"states", "sky"} -> for each file its place among the main
 *               files, else 0
 *     inputs    "files", "uses": [[name, role, entry or null], ...], "path" of the document or none
 *               -> the findings, in the order of struct orl_job_inputs_found (job_inputs.h)
 *     plan      "path", "files" -> child_plan.h
 *     outline   "files", "height"; polar: "path", "front", "theta_deg", "phi_deg" ->
 * child_previews.h
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHILD_CHECKS_H
#define ORL_SERVER_CHECKS_CHILD_CHILD_CHECKS_H

#include <jansson.h>

#include <oriel/base/error.h>

/* Runs one check in the child, over the socket, and ends the process. */
void orl_child_check(int fd);

/* Convert errors to and from JSON for the verdict. */
json_t *orl_child_error_to_json(const struct orl_error *err);
void orl_child_error_from_json(const json_t *json, struct orl_error *ret_err);

#endif
