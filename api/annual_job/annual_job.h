/*
 * Runs a year's job from its document to its files, for the command line and the daemon. The run
 * reads sensors from files, runs the year until the verdict is sure, computes metrics and verdicts,
 * adds warnings, and writes the files and result.json.
 */
#ifndef ORL_API_ANNUAL_JOB_ANNUAL_JOB_H
#define ORL_API_ANNUAL_JOB_ANNUAL_JOB_H

#include <jansson.h>

#include <oriel/annual/annual_phases.h>

#include "annual_job/annual_json.h"

/* Environment of a job; all callbacks get run's ctx. */
struct orl_annual_job_env {
    const struct orl_run_env *run; /* borrowed; its output_folder exists */
    /* Reuse from run's store: these four are the members of struct orl_annual_env. */
    bool reuse;
    size_t reuse_most;
    bool (*restored)(void *ctx, struct orl_annual_chunk *chunk);
    void (*done)(void *ctx, const struct orl_annual_chunk *chunk);
    /* Called after each round of a job that asks for accuracy. May be NULL. */
    void (*round)(void *ctx, const struct orl_annual_refinement *so_far);
    /*
     * Called at the end on the lead thread, with result.json (document) and the names of all other
     * files, which then exist. Arguments are borrowed. A negative orl_err ends the job.
     */
    int (*on_result)(void *ctx, const struct orl_annual_result *result,
                     const struct orl_annual_report *report, json_t *document, const json_t *names,
                     struct orl_error *err);
};

/* Runs the job, whose request has the names of the scene's files. Returns 0 or a negative orl_err,
 * with file and line. */
int orl_annual_job_run(struct orl_annual_job *job, const struct orl_annual_job_env *env,
                       struct orl_error *err);

/*
 * Writes the files of a year, each either whole or absent: tables, the maps, temporal maps and page
 * of every grid, and the hourly files that the job asks for.
 */

/* Results to write; all pointers are borrowed. */
struct orl_annual_outputs {
    const struct orl_annual_job *job;
    const struct orl_run_env *run; /* output_folder exists; pool, cancel and progress are used */
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const struct orl_phase_matrices *phases; /* for the job's formats; or NULL */
};

/* Fraction of the job's time at which writing files starts, roughly. */
#define ORL_ANNUAL_FILES_FROM 0.95

/* Writes all files but result.json, and appends their names, relative to the folder, to the array
 * names. Returns 0, ORL_ERR_NOMEM, _CANCELLED, _IO or _FULL. */
int orl_annual_files_write(const struct orl_annual_outputs *outputs, json_t *names,
                           struct orl_error *err);

#endif
