/*
 * A job document (JSON) -> struct orl_job. api/schema/job.yaml describes the document; "priority"
 * is read by job_request_json.h, and used only by the daemon.
 *
 * Members without a description are errors, so that a
 * misspelt setting is found. Messages name the JSON path ("photons.globl") in orl_error.primitive
 * and in the sentence.
 *
 * Ownership: documents are borrowed; results are owned by the caller.
 * Threads: the functions keep no state; any thread may call them, one document per thread.
 */
#ifndef ORL_API_JOB_JOB_JSON_H
#define ORL_API_JOB_JOB_JSON_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/base/error.h>
#include <oriel/job/run.h>

/* Source of the document: a user of the command line (names files) or a client (names an id). */
enum orl_job_origin { ORL_JOB_LOCAL, ORL_JOB_REMOTE };

/*
 * Decodes doc. ORL_JOB_LOCAL: "scene" is {"files": [...]}, copied to ret_job->scene_files, and
 * *ret_scene_id becomes NULL. ORL_JOB_REMOTE: "scene" is an id (64 lower-case hexadecimal digits),
 * returned owned (free()) in *ret_scene_id; scene_files stays empty for the caller to fill in.
 * ret_scene_id may be NULL for ORL_JOB_LOCAL. On success the caller owns ret_job (orl_job_done).
 * Errors: ORL_ERR_INVALID (members, types), ORL_ERR_RANGE, ORL_ERR_LIMIT, ORL_ERR_NOMEM.
 * orl_job_validate checks view strings, unique names, and what needs the scene.
 */
int orl_job_from_json(const json_t *doc, enum orl_job_origin origin, struct orl_job *ret_job,
                      char **ret_scene_id, struct orl_error *err);

/* Decodes the "scene" member of any kind of document into job, and leaves job's other members
 * alone. scene may be NULL (absent), which is an error; ret_scene_id as above. Names read before
 * an error stay in job. */
int orl_job_scene_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            struct orl_job *job, char **ret_scene_id, struct orl_error *err);
/* Decodes "scene" as above, but into an array of file names, owned by the caller. */
int orl_job_files_from_json(const json_t *scene, const char *path, enum orl_job_origin origin,
                            char ***ret_files, size_t *ret_count, char **ret_scene_id,
                            struct orl_error *err);

/*
 * Labels that a client gives a job of any kind: "name", 1 to 100 characters, and "tags", up to 16
 * different ones of 1 to 64 characters. They do not affect the computation. Neither has control
 * characters. A tag has no quotation mark, backslash or comma, so that lists need no escapes.
 *
 * Rules and errors as in decode.h.
 */

enum { ORL_LABEL_NAME = 100, ORL_LABEL_TAGS = 16, ORL_LABEL_TAG = 64 };

struct orl_labels {
    char *name; /* owned; NULL: none */
    char *tags; /* a JSON array as text, owned; NULL: none */
};

void orl_labels_done(struct orl_labels *labels); /* NULL is fine */

/* Decodes "name" and "tags" of a job's document. */
int orl_labels_from_json(const json_t *doc, struct orl_labels *ret_labels, struct orl_error *err);

/* Returns true if text is a valid tag. Length is counted in UTF-8 characters. */
bool orl_label_is_tag(const char *text);
/* Returns true if tags (of struct orl_labels; NULL: none) contains tag. */
bool orl_labels_have(const char *tags, const char *tag);

#endif
