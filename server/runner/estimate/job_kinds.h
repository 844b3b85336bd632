/*
 * Properties of each kind of job that the daemon needs to accept it: limits, and the likely size of
 * its results and memory. worker_run.c has how each kind runs.
 *
 * Threads: any; no state.
 */
#ifndef ORL_SERVER_RUNNER_ESTIMATE_JOB_KINDS_H
#define ORL_SERVER_RUNNER_ESTIMATE_JOB_KINDS_H

#include "job/job_request_json.h"
#include "runner/estimate/job_memory.h"

/* The contents of an upload, by the summary that its check made. */
struct orl_upload_contents {
    uint64_t sources;       /* distant sources of a scene */
    uint64_t measured_rows; /* above 0: the upload is measurements, not a scene */
};

struct orl_job_kind {
    /* Checks the daemon's limits, if these are below the command's: ORL_ERR_LIMIT. NULL: none. */
    int (*check_limits)(const struct orl_job_request *job_request, struct orl_error *err);
    /* Return the approximate maximum size of the results: the bytes by the document, and the bytes
     * for each sensor of a file, whose number is not in the document. */
    uint64_t (*result_bytes)(const struct orl_job_request *job_request);
    uint64_t (*sensor_bytes)(const struct orl_job_request *job_request);
    /* Returns the result bytes for each sensor and hour with light in an annual job; NULL: not
     * annual. */
    uint64_t (*hour_bytes)(const struct orl_job_request *job_request);
    /* Fills in the request's quantities for the memory estimate; *ret_needs is all zeros before. */
    void (*needs)(const struct orl_job_request *job_request, struct orl_job_memory *ret_needs);
    /* Returns true if some of its files are checked together with the document and the scene. NULL:
     * none. */
    bool (*whole_scene)(const struct orl_job_request *job_request);
    /* Checks that the uploaded contents suit this kind of job. */
    int (*check_contents)(const struct orl_upload_contents *contents, struct orl_error *err);
};

extern const struct orl_job_kind orl_job_kinds[ORL_JOB_KIND_COUNT];

#endif
