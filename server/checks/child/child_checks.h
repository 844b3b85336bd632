/*
 * Check children: the work of a child (child_checks.c, child_scene.c, scene_document.c), the fork
 * server that starts it (fork_server.c), and its sandbox (sandbox.c).
 */
#ifndef ORL_SERVER_CHECKS_CHILD_CHILD_CHECKS_H
#define ORL_SERVER_CHECKS_CHILD_CHILD_CHECKS_H

#include <jansson.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "checks/child/messages.h"
#include "checks/job_manifest.h"
#include "uploads/uploads.h"

/*
 * The work of a check child: it reads its request and opens the files that the request names. It
 * gives up every privilege that reading them does not need (orl_sandbox_enter), reads them, and
 * sends a verdict.
 *
 * The request is {"kind", "memory", "cpu_s", ...}, the verdict {"error": {...}} or {"result": ...}:
 *
 *     scene     "files": [{"name", "path", "sha", "bytes", "resource"}], main files first
 *               -> the summary (result_json.h); if the request has a "choice", with "project"
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
 *               -> the findings, in the order of struct orl_job_inputs_found (job_manifest.h)
 *     plan      "path", "files" -> orl_child_plan
 *     outline   "files", "height" -> orl_child_outline
 *     polar     "path", "front", "theta_deg", "phi_deg" -> orl_child_polar
 */

/* A running check: its socket, its request, and the files that the request names. */
struct orl_child_task {
    int fd;
    const json_t *request;
    struct orl_mapped_inputs files;
};

/* Runs one check in the child, over the socket, and ends the process. */
void orl_child_check(int fd);

/* Reads an error from a verdict's JSON. */
void orl_child_error_from_json(const json_t *json, struct orl_error *ret_err);

/*
 * The fork server: a process of the daemon's own program that only forks children. Each child runs
 * one check of untrusted data (orl_child_check); there is one child at a time. The fork server is
 * small, has one thread, and has its libraries loaded, so a child costs a millisecond or two. It
 * reads nothing of the data that its children receive.
 *
 * The daemon starts fork servers and talks to them through check_client.h. A fork server ends with
 * the daemon, and its children end with the fork server.
 */

/* The first argument of a fork server process; the second is the daemon's process id. */
#define ORL_FORK_SERVER_MODE "--keeper"
enum { ORL_FORK_SERVER_FD = 3 }; /* the fork server's end of the socket */

/* Exit status of a child that ran out of memory where no error could be returned. */
enum { ORL_CHILD_NO_MEMORY = 71 };

/* Serves until the daemon is gone. Returns the process's exit status. */
int orl_fork_server_main(const char *daemon_pid);

/*
 * Confines a process that is about to read untrusted data to what that needs. It bounds memory,
 * processor time and files, forbids other programs, the network and opening files, and drops
 * privileges. The process also becomes the first that the kernel kills when memory runs out.
 *
 * Builds with sanitizers have neither the memory bound (the shadow memory is far larger) nor the
 * system-call filter (sanitizers need other calls).
 * Threads: the process must have one only.
 */

struct orl_sandbox_limits {
    uint64_t memory; /* bytes of data; stacks and mapped files do not count */
    uint32_t cpu_s;
};

/* Confines the process for good. ORL_ERR_INTERNAL if the system refuses. */
int orl_sandbox_enter(const struct orl_sandbox_limits *bounds, struct orl_error *err);

/*
 * A scene as one JSON document: {"files": [{"name", "text" | "base64", "resource"}], "bsdfs":
 * {"name": "id"}}; or a Honeybee model, {"type": "Model", ...} (honeybee/hbjson.h).
 */

/* Sends the document's files to the sink, in their order. *ret_rest is {"resources": [true, ...],
 * "bsdfs": ...}: one resource flag for each file, and the document's "bsdfs" if it has them. For a
 * model it is {"model": true}. */
int orl_scene_document_read(const struct orl_file *document, const struct orl_incoming_sink *sink,
                            json_t **ret_rest, struct orl_error *err);

/*
 * Checks a job's document together with its scene's files (README.md has the table). These are the
 * scenes that the states of shades make, their schedules, matrices of other scenes, and glare
 * masks.
 */

/* Runs in the child. task->files: all files of the scene, with the document as the single file.
 * Adds to *found. */
int orl_child_document(struct orl_child_task *task, struct orl_job_inputs_found *found,
                       struct orl_error *err);

/*
 * The plan of a render job before it is accepted (core's orl_plan_job), made in a check child with
 * one thread. Nothing is freed: the process ends with the check.
 */

/* Number of skies that are planned; the first ones if the job has more. */
enum { ORL_PLAN_SKIES = 16 };

/*
 * Plans the job. task->files: the scene's files, with the document as the single file. *ret_result
 * is a new reference: {"plans": [{"sky", "plan", "warnings", "curve"}], "more"}. sky is null if the
 * job has no list of skies.
 */
int orl_child_plan(struct orl_child_task *task, json_t **ret_result, struct orl_error *err);

/*
 * Previews of stored objects, made in a check child: a scene's floor plan, and the directions into
 * which a BSDF scatters light. Nothing is freed: the process ends with the check.
 */

/* The request has "height", a number or null; the result is result_json.h's. */
int orl_child_outline(struct orl_child_task *task, json_t **ret_result, struct orl_error *err);
/* The request has "front", "theta_deg" and "phi_deg"; the result is bsdf_json.h's. */
int orl_child_polar(struct orl_child_task *task, json_t **ret_result, struct orl_error *err);

#endif
