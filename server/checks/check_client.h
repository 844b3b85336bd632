/*
 * Requests to check children: the pool of children (check_pool.c), and one call for each check
 * (check_client.c).
 */
#ifndef ORL_SERVER_CHECKS_CHECK_CLIENT_H
#define ORL_SERVER_CHECKS_CHECK_CLIENT_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "checks/job_manifest.h"
#include "store/files/scene_bundle.h"

/*
 * The pool on the daemon's side: fork servers (child_checks.h) and requests to their children.
 * There are as many fork servers as checks ran at once; each is kept for the next check.
 *
 * Threads: orl_check_pool_run on any thread, the rest on the loop's.
 */

struct orl_check_pool;

/* Starts the first fork server. NULL: out of memory. */
struct orl_check_pool *orl_check_pool_new(void);
/* Frees the pool. No check may be running; NULL is allowed. */
void orl_check_pool_free(struct orl_check_pool *check_pool);

/* The resource bound that ended a child. */
enum orl_child_bound {
    ORL_CHILD_NONE,
    ORL_CHILD_MEMORY,
    ORL_CHILD_CPU,
    ORL_CHILD_FAULT,
    ORL_CHILD_KILLED /* no bound of its own: the system ran out of memory */
};

struct orl_check_call {
    struct orl_check_pool *check_pool;
    uint64_t memory;           /* bound on the child's memory, bytes */
    uint32_t cpu_s;            /* bound on the child's processor time, seconds */
    const atomic_bool *cancel; /* polled; NULL: never */
    int client_fd;             /* the check ends when this client disconnects; -1: no client */
    /* Callbacks for files that the child unpacks; NULL if there are none. */
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
    /* Outcome of the check. */
    enum orl_child_bound met;
    uint64_t peak_bytes;
};

/*
 * Sends the request and waits for the verdict. Returns 0 and *ret_result, which the caller owns, or
 * the error that the child found. ORL_ERR_CANCELLED if *cancel is set or the client has
 * disconnected. If the child died, call->met is the cause. The error then names the bound:
 * ORL_ERR_LIMIT; ORL_ERR_UNSUPPORTED for a fault; ORL_ERR_NOMEM if no bound of its own was met.
 */
int orl_check_pool_run(struct orl_check_call *call, const json_t *request, json_t **ret_result,
                       struct orl_error *err);

/*
 * The daemon's requests to check children (child_checks.h). Each call runs one check, or two.
 * Threads: pool threads. Errors: those of the checks, and of orl_check_pool_run.
 */

/* Checks that the bundle is a scene. *ret_summary is JSON text that the caller owns. The bundle
 * must be sorted. choice: the parts of a project that the scene was made of (child_checks.h), which
 * the summary then reports; NULL: the scene is not from a project. */
int orl_check_client_scene(struct orl_check_call *call, const struct orl_bundle *bundle,
                           const json_t *choice, char **ret_summary, struct orl_error *err);
/* Checks that the file is a BSDF. name: for messages. */
int orl_check_client_bsdf(struct orl_check_call *call, const char *path, const char *name,
                          char **ret_summary, struct orl_error *err);
/* Returns a scene's floor plan at that height as JSON text, which the caller owns
 * (child_checks.h). NAN: half-way up. */
int orl_check_client_outline(struct orl_check_call *call, const struct orl_bundle *scene,
                             double height, char **ret_outline, struct orl_error *err);
/* Returns the directions into which a BSDF file scatters light that arrives from `from`
 * (oriel/bsdf/bsdf_polar.h). */
struct orl_incidence {
    bool front;
    double theta_deg, phi_deg;
};
int orl_check_client_polar(struct orl_check_call *call, const char *path,
                           const struct orl_incidence *from, char **ret_polar,
                           struct orl_error *err);
int orl_check_client_job(struct orl_check_call *call, const char *path,
                         struct orl_job_manifest *ret_manifest, struct orl_error *err);
/* Returns the plans (child_checks.h) of a render job in that scene as JSON text, which the caller
 * owns. path: the job's document. */
int orl_check_client_plan(struct orl_check_call *call, const struct orl_bundle *scene,
                          const char *path, char **ret_plans, struct orl_error *err);
/* Checks the files that a job names. */
int orl_check_client_inputs(struct orl_check_call *call, const struct orl_job_inputs *inputs,
                            const char *document, struct orl_job_inputs_found *ret_found,
                            struct orl_error *err);

/* Unpacks a zip as orl_unzip does (uploads.h). choice: the parts wanted of a project; NULL: all
 * files are resources. */
int orl_check_client_unzip(struct orl_check_call *call, const char *path,
                           const struct orl_folders *folders, const json_t *choice,
                           struct orl_bundle *bundle, struct orl_error *err);
/* Appends the files of a scene document to the bundle. *ret_bsdfs is its "bsdfs" (a new reference),
 * or NULL. */
int orl_check_client_document(struct orl_check_call *call, const char *path,
                              const struct orl_folders *folders, const json_t *choice,
                              struct orl_bundle *bundle, json_t **ret_bsdfs, struct orl_error *err);

#endif
