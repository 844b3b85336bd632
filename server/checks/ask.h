/*
 * What the daemon asks of children (child_checks.h): each call is one check, or two. Pool threads.
 * Errors: those of the checks, and of orl_lanes_run.
 */
#ifndef ORL_SERVER_CHECKS_ASK_H
#define ORL_SERVER_CHECKS_ASK_H

#include "checks/job_brief.h"
#include "checks/job_inputs.h"
#include "checks/lanes.h"
#include "store/bundle.h"

/* Is it a scene? *ret_summary is JSON text, the caller's. The bundle is sorted. choice: what of a
 * project it was made of (child_checks.h), which the summary then tells; NULL: of none. */
int orl_ask_scene(struct orl_asking *asking, const struct orl_bundle *bundle, const json_t *choice,
                  char **ret_summary, struct orl_error *err);
/* Is the file a BSDF? name: for messages. */
int orl_ask_bsdf(struct orl_asking *asking, const char *path, const char *name, char **ret_summary,
                 struct orl_error *err);
/* A scene's floor plan at that height, NAN: half-way up; JSON text, the caller's (child_looks.h).
 */
int orl_ask_outline(struct orl_asking *asking, const struct orl_bundle *scene, double height,
                    char **ret_outline, struct orl_error *err);
/* Where a BSDF, the file, sends the light that comes from there (oriel/bsdf_polar.h). */
struct orl_incidence {
    bool front;
    double theta_deg, phi_deg;
};
int orl_ask_polar(struct orl_asking *asking, const char *path, const struct orl_incidence *from,
                  char **ret_polar, struct orl_error *err);
int orl_ask_job(struct orl_asking *asking, const char *path, struct orl_job_brief *ret_brief,
                struct orl_error *err);
/* The plans of a render job (child_plan.h) of that scene, whose document is the file; JSON text,
 * the caller's. */
int orl_ask_plan(struct orl_asking *asking, const struct orl_bundle *scene, const char *path,
                 char **ret_plans, struct orl_error *err);
/* The files that a job names. */
int orl_ask_inputs(struct orl_asking *asking, const struct orl_job_inputs *inputs,
                   const char *document, struct orl_job_inputs_found *ret_found,
                   struct orl_error *err);

/* As orl_unzip (unzip.h). choice: of a project; NULL: all files are resources. */
int orl_ask_unzip(struct orl_asking *asking, const char *path, const struct orl_folders *folders,
                  const json_t *choice, struct orl_bundle *bundle, struct orl_error *err);
/* Appends the files of a scene document; *ret_bsdfs is its "bsdfs" (a new reference), or NULL. */
int orl_ask_document(struct orl_asking *asking, const char *path, const struct orl_folders *folders,
                     const json_t *choice, struct orl_bundle *bundle, json_t **ret_bsdfs,
                     struct orl_error *err);

#endif
