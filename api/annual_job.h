/*
 * A year's job from its document to its files, for the command and the daemon alike: sensors of
 * files are read, the year is run until its verdict is sure, metrics and verdicts are worked out,
 * warnings are added, files written, and result.json made.
 */
#ifndef ORL_API_ANNUAL_JOB_H
#define ORL_API_ANNUAL_JOB_H

#include <jansson.h>

#include "annual_json.h"

/* Whose callbacks all get run's ctx. */
struct orl_annual_job_env {
    const struct orl_run_env *run; /* borrowed; its output_folder exists */
    /* Of run's store, and what follows: as of struct orl_annual_env. */
    bool reuse;
    size_t reuse_most;
    bool (*kept)(void *ctx, struct orl_annual_block *block);
    void (*done)(void *ctx, const struct orl_annual_block *block);
    /* After each round of a job that asks for accuracy. May be NULL. */
    void (*round)(void *ctx, const struct orl_annual_refinement *so_far);
    /*
     * At the end, by the lead thread, with result.json and the names of all other files, which are
     * there; borrowed. A negative orl_err ends the job.
     */
    int (*tell)(void *ctx, const struct orl_annual_result *result,
                const struct orl_annual_report *report, json_t *document, const json_t *names,
                struct orl_error *err);
};

/* Runs the job, whose request has the names of its scene's files. Returns 0 or a negative orl_err,
 * with file and line. */
int orl_annual_job_run(struct orl_annual_job *job, const struct orl_annual_job_env *env,
                       struct orl_error *err);

#endif
