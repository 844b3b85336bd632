/*
 * What the daemon has to know of a job document to take it: read in a child where the document is
 * large (child_checks.h), in the daemon otherwise.
 */
#ifndef ORL_SERVER_CHECKS_JOB_BRIEF_H
#define ORL_SERVER_CHECKS_JOB_BRIEF_H

#include <jansson.h>

#include <oriel/files.h>

#include "runner/job_memory.h"
#include "store/folders.h"
#include "task_json.h"

/* A file that the document names (task_json.h). Owned. */
struct orl_named_file {
    enum orl_file_role role;
    char *name, *place;
    char *entry; /* or NULL */
};

struct orl_job_brief {
    enum orl_task_kind kind;
    int priority;
    struct orl_labels labels;
    char scene[ORL_SHA_HEX], identity[ORL_SHA_HEX]; /* identity: job_share.h */
    uint64_t result_bytes;                          /* to be expected ... */
    uint64_t sensor_bytes, hour_bytes; /* ... and as much for each of a file, and each hour of a
                                          year's with light */
    struct orl_job_memory needs;       /* by the document alone */
    bool whole; /* its files are checked with the document and all of the scene's: shades, matrices
                   of others, masks (child_document.h) */
    struct orl_named_file *files; /* owned */
    size_t n_files, room;
};

/* NULL and all zeros are fine. */
void orl_job_brief_done(struct orl_job_brief *brief);

/* Errors are those of orl_job_read. */
int orl_job_brief_read(const struct orl_file *document, struct orl_job_brief *ret_brief,
                       struct orl_error *err);

/* A new reference; NULL: out of memory. */
json_t *orl_job_brief_to_json(const struct orl_job_brief *brief);
/* ORL_ERR_INTERNAL when it is none. */
int orl_job_brief_from_json(const json_t *json, struct orl_job_brief *ret_brief,
                            struct orl_error *err);

#endif
