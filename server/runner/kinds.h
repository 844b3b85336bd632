/*
 * What the daemon has to know of each kind of job to take it: how far it goes along with it, what
 * its results and its run are likely to take. How they run is worker_run.c's.
 *
 * Threads: any; no state.
 */
#ifndef ORL_SERVER_RUNNER_KINDS_H
#define ORL_SERVER_RUNNER_KINDS_H

#include "runner/job_memory.h"
#include "task_json.h"

/* What an upload holds, by the summary that its check left. */
struct orl_contents {
    uint64_t sources;       /* distant ones of a scene */
    uint64_t measured_rows; /* above 0: it is no scene, but measurements */
};

struct orl_kind {
    /* What the daemon takes of it, where that is less than what the command does: ORL_ERR_LIMIT.
     * NULL: all of it. */
    int (*admit)(const struct orl_task *task, struct orl_error *err);
    /* What its results may take at most, more or less; bytes: by the document, and for each sensor
     * of a file, which the document does not tell the number of. */
    uint64_t (*result_bytes)(const struct orl_task *task);
    uint64_t (*sensor_bytes)(const struct orl_task *task);
    /* ... and for an hour with light of each sensor of a year; NULL: it is none. */
    uint64_t (*hour_bytes)(const struct orl_task *task);
    /* What it asks for, which memory goes by; nothing is set yet. */
    void (*needs)(const struct orl_task *task, struct orl_job_memory *ret_needs);
    /* Some of its files are checked together with the document and the scene. NULL: none. */
    bool (*whole)(const struct orl_task *task);
    /* Whether what was uploaded suits it. */
    int (*suits)(const struct orl_contents *contents, struct orl_error *err);
};

extern const struct orl_kind orl_kinds[ORL_TASK_KIND_COUNT];

#endif
