/*
 * The daemon's requests to check children (child_checks.h). Each call runs one check, or two.
 * Threads: pool threads. Errors: those of the checks, and of orl_check_pool_run.
 */
#ifndef ORL_SERVER_CHECKS_CHECK_CLIENT_H
#define ORL_SERVER_CHECKS_CHECK_CLIENT_H

#include "checks/check_pool.h"
#include "checks/job_inputs.h"
#include "checks/job_manifest.h"
#include "store/files/scene_bundle.h"

/* Checks that the bundle is a scene. *ret_summary is JSON text that the caller owns. The bundle
 * must be sorted. choice: the parts of a project that the scene was made of (child_checks.h), which
 * the summary then reports; NULL: the scene is not from a project. */
int orl_check_client_scene(struct orl_check_call *call, const struct orl_bundle *bundle,
                           const json_t *choice, char **ret_summary, struct orl_error *err);
/* Checks that the file is a BSDF. name: for messages. */
int orl_check_client_bsdf(struct orl_check_call *call, const char *path, const char *name,
                          char **ret_summary, struct orl_error *err);
/* Returns a scene's floor plan at that height as JSON text, which the caller owns
 * (child_previews.h). NAN: half-way up. */
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
/* Returns the plans (child_plan.h) of a render job in that scene as JSON text, which the caller
 * owns. path: the job's document. */
int orl_check_client_plan(struct orl_check_call *call, const struct orl_bundle *scene,
                          const char *path, char **ret_plans, struct orl_error *err);
/* Checks the files that a job names. */
int orl_check_client_inputs(struct orl_check_call *call, const struct orl_job_inputs *inputs,
                            const char *document, struct orl_job_inputs_found *ret_found,
                            struct orl_error *err);

/* Unpacks a zip as orl_unzip does (unzip.h). choice: the parts wanted of a project; NULL: all files
 * are resources. */
int orl_check_client_unzip(struct orl_check_call *call, const char *path,
                           const struct orl_folders *folders, const json_t *choice,
                           struct orl_bundle *bundle, struct orl_error *err);
/* Appends the files of a scene document to the bundle. *ret_bsdfs is its "bsdfs" (a new reference),
 * or NULL. */
int orl_check_client_document(struct orl_check_call *call, const char *path,
                              const struct orl_folders *folders, const json_t *choice,
                              struct orl_bundle *bundle, json_t **ret_bsdfs, struct orl_error *err);

#endif
