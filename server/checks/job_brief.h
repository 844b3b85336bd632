/*
 * The parts of a job document that the daemon needs to accept it. A large document is read in a
 * child (child_checks.h), others in the daemon.
 */
#ifndef ORL_SERVER_CHECKS_JOB_BRIEF_H
#define ORL_SERVER_CHECKS_JOB_BRIEF_H

#include <jansson.h>

#include <oriel/files.h>

#include "runner/job_memory.h"
#include "store/folders.h"
#include "task_json.h"

/* A file that the document names (task_json.h). Owns its strings. */
struct orl_named_file {
    enum orl_file_role role;
    char *name, *place;
    char *entry; /* NULL if none is given */
};

struct orl_job_brief {
    enum orl_task_kind kind;
    int priority;
    struct orl_labels labels;
    char scene[ORL_SHA_HEX], identity[ORL_SHA_HEX]; /* identity: job_share.h */
    uint64_t result_bytes;                          /* estimate, without the following two */
    uint64_t sensor_bytes,
        hour_bytes;               /* result bytes for each sensor of a file, each daylight hour */
    struct orl_job_memory needs;  /* estimated from the document alone */
    bool whole;                   /* checked with all of the scene's files (child_document.h) */
    struct orl_named_file *files; /* owned */
    size_t n_files, room;
};

/* Frees a brief. NULL and all zeros are allowed. */
void orl_job_brief_done(struct orl_job_brief *brief);

/* Reads a document. Errors are those of orl_job_read. */
int orl_job_brief_read(const struct orl_file *document, struct orl_job_brief *ret_brief,
                       struct orl_error *err);

/* Returns a new reference; NULL: out of memory. */
json_t *orl_job_brief_to_json(const struct orl_job_brief *brief);
/* Reads a brief from JSON. ORL_ERR_INTERNAL if the JSON is not one. */
int orl_job_brief_from_json(const json_t *json, struct orl_job_brief *ret_brief,
                            struct orl_error *err);

#endif
