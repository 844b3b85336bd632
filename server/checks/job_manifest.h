/*
 * A job's document before the job is accepted: the parts that the daemon needs (job_manifest.c),
 * and the files that it names (job_inputs.c).
 */
#ifndef ORL_SERVER_CHECKS_JOB_MANIFEST_H
#define ORL_SERVER_CHECKS_JOB_MANIFEST_H

#include <jansson.h>

#include <oriel/base/files.h>

#include "job/job_request_json.h"
#include "runner/estimate/job_estimate.h"
#include "store/files/folders.h"
#include "store/files/scene_bundle.h"

/*
 * The parts of the document that the daemon needs. A large document is read in a child
 * (child_checks.h), others in the daemon.
 */

/* A file that the document names (job_request_json.h). Owns its strings. */
struct orl_named_file {
    enum orl_file_role role;
    char *name, *location;
    char *entry; /* NULL if none is given */
};

struct orl_job_manifest {
    enum orl_job_request_kind kind;
    int priority;
    struct orl_labels labels;
    char scene[ORL_SHA_HEX], identity[ORL_SHA_HEX]; /* identity: job_document.h */
    uint64_t result_bytes;                          /* estimate, without the following two */
    uint64_t sensor_bytes,
        hour_bytes;               /* result bytes for each sensor of a file, each daylight hour */
    struct orl_job_memory needs;  /* estimated from the document alone */
    bool whole_scene;             /* checked with all of the scene's files (child_checks.h) */
    struct orl_named_file *files; /* owned */
    size_t n_files, capacity;
};

/* Frees a manifest. NULL and all zeros are allowed. */
void orl_job_manifest_done(struct orl_job_manifest *manifest);

/* Parses and decodes a document. Errors are those of orl_job_document_decode. */
int orl_job_manifest_read(const struct orl_file *text, struct orl_job_manifest *ret_manifest,
                          struct orl_error *err);

/* Returns a new reference; NULL: out of memory. */
json_t *orl_job_manifest_to_json(const struct orl_job_manifest *manifest);
/* Reads a manifest from JSON. ORL_ERR_INTERNAL if the JSON is not one. */
int orl_job_manifest_from_json(const json_t *json, struct orl_job_manifest *ret_manifest,
                               struct orl_error *err);

/*
 * The files of a scene that a job names (job_request_json.h): sensors, weather, and the lists of
 * its views. If they are read with the document, all files of the scene (README.md has the table).
 */

struct orl_job_inputs {
    struct orl_bundle files; /* each file once */
    bool whole_scene;        /* files has the whole scene; read with the document */
    json_t *uses;            /* [name, role, entry or null] for each file to read; NULL: none */
};
void orl_job_inputs_done(struct orl_job_inputs *inputs); /* all zeros are allowed */

/* Findings from reading the files. */
struct orl_job_inputs_found {
    uint64_t sensors;             /* total over all sensor files */
    uint64_t year_rows;           /* rows of a year's weather; 0: no such weather */
    uint64_t surfaces, triangles; /* the largest scene among the combinations of shade states */
    uint64_t matrix_bytes;        /* memory of an annual job by matrices */
};

/* Lists the addresses of the findings, in the order in which a child sends them. */
enum { ORL_JOB_INPUTS_COUNTS = 5 };
void orl_job_inputs_counts(struct orl_job_inputs_found *found,
                           uint64_t *ret_places[ORL_JOB_INPUTS_COUNTS]);

/* Checks that the scene has the named files. ORL_ERR_NOT_FOUND if not, with the place in the
 * document. */
int orl_job_inputs_check(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Collects the files and their uses in *inputs, which must be all zeros. Call it after
 * orl_job_inputs_check. The caller owns the contents of *inputs, even after an error. */
int orl_job_inputs_collect(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                           struct orl_job_inputs *inputs, struct orl_error *err);

#endif
