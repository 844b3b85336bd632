/* Reads the documents of jobs (api/README.md). Any thread; no state. */
#ifndef ORL_SERVER_RUNNER_JOB_DOCUMENT_H
#define ORL_SERVER_RUNNER_JOB_DOCUMENT_H

#include <jansson.h>

#include "job/job_request_json.h"
#include "store/files/scene_bundle.h"

/*
 * Validates a parsed document, including the limits of its kind of job. Returns its request
 * (orl_job_request_done), without the files of its scene. *ret_scene_id (NULL is allowed) is the
 * scene's id, owned by the caller.
 */
int orl_job_document_decode(json_t *document, struct orl_job_request *ret_job_request,
                            char **ret_scene_id, struct orl_error *err);
/* Parses a document, and decodes it. */
int orl_job_document_read(const char *text, size_t size, struct orl_job_request *ret_job_request,
                          struct orl_error *err);

/* Adds the bundle's main files to the job. */
int orl_job_document_set_scene(struct orl_job_request *job_request, const struct orl_bundle *bundle,
                               struct orl_error *err);

/*
 * Computes the digest of the results that a document asks for. It does not depend on the order of
 * members, the priority, the tags, and the name, except for the name of a BSDF job, which its file
 * contains. "": out of memory.
 */
void orl_job_document_identity(const json_t *document, char ret_identity[ORL_SHA_HEX]);

#endif
