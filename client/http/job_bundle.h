/*
 * Collects all files that a document of any kind needs: those of its scene with their
 * references (upload_bundle.h), and those that the document names itself.
 */
#ifndef ORL_CLIENT_HTTP_JOB_BUNDLE_H
#define ORL_CLIENT_HTTP_JOB_BUNDLE_H

#include "http/upload_bundle.h"
#include "job/job_request_json.h"

/* Collects the files of a document that names its scene's files, below the folder. Call
 * orl_bundle_done afterwards. */
int orl_job_bundle_collect(const char *folder, const struct orl_job_request *job_request,
                           struct orl_upload *ret_bundle, struct orl_error *err);

#endif
