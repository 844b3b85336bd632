/*
 * Collects the files of a scene upload: the main files, in order, and every file they refer to
 * (BSDFs, !xform files). The core's own parser finds the references, so that none is missed and
 * errors in the scene are reported before anything is sent. Goniophotometer measurements are
 * checked likewise.
 *
 * Names are sent as the scene's files spell them, because the daemon looks them up by this
 * spelling. Names outside the folder ("../", "/") are refused.
 */
#ifndef ORL_CLIENT_HTTP_UPLOAD_BUNDLE_H
#define ORL_CLIENT_HTTP_UPLOAD_BUNDLE_H

#include <stddef.h>

#include <oriel/base/error.h>

#include "http/http_client.h"
#include "job/job_request_json.h"

struct orl_upload {
    struct orl_upload_part *parts; /* owned, with their strings; main files first */
    size_t n_parts, room;
};

/* Collects the main files, below folder, and the files they refer to. */
int orl_bundle_collect(const char *folder, const char *const *main_files, size_t n_files,
                       struct orl_upload *ret_bundle, struct orl_error *err);

/* Guesses the names of a folder's main files (main_files.h), in reading order. *ret_names and
 * its strings are owned by the caller. */
int orl_bundle_main_files(const char *folder, char ***ret_names, size_t *ret_count,
                          struct orl_error *err);
void orl_bundle_names_free(char **names, size_t count); /* NULL is fine */

/* Adds a file that the job names but the scene does not, such as a weather file. */
int orl_bundle_add(struct orl_upload *bundle, const char *folder, const char *name,
                   struct orl_error *err);
void orl_bundle_done(struct orl_upload *bundle); /* NULL and half-filled are fine */

/* Uploads the bundle unless the daemon already has it, and reports which on stderr. *ret_id is
 * owned (free()). */
int orl_bundle_upload(const struct orl_upload *bundle, struct orl_http *http, char **ret_id,
                      struct orl_error *err);

/*
 * Collects all files that a document of any kind needs: those of its scene with their
 * references, and those that the document names itself.
 */

/* Collects the files of a document that names its scene's files, below the folder. Call
 * orl_bundle_done afterwards. */
int orl_job_bundle_collect(const char *folder, const struct orl_job_request *job_request,
                           struct orl_upload *ret_bundle, struct orl_error *err);

#endif
