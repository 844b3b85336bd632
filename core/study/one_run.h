/*
 * A single run of a study: one setting with one seed, its values and their cost.
 *
 * Each run has its own folder for maps and images, and leaves it empty. Its store deletes a map as
 * soon as the run releases it, so no run finds maps of another.
 */
#ifndef ORL_STUDY_ONE_RUN_H
#define ORL_STUDY_ONE_RUN_H

#include <oriel/job/study.h>

/* Result of a run. All arrays are owned. */
struct orl_one_run {
    double *values; /* by sensor or pixel, lux or cd/m2 */
    size_t count;
    double *errors; /* standard errors of the values; NULL: unknown */
    double stages_s[ORL_STAGE_COUNT], total_s;
    uint64_t map_bytes;
    uint32_t threads;
    struct orl_health health;
    char **warnings;
    size_t n_warnings;
};
void orl_one_run_done(struct orl_one_run *run); /* zeros are allowed */

/* Data shared by a study's runs. */
struct orl_runs_env {
    const struct orl_study_request *request;
    const struct orl_study_env *env;
    char folder[4096]; /* for maps and images */
    double sensors;    /* number of sensors */
    /* Estimated cost: of runs that ended, of this run, of the whole study. */
    double before, share, all;
    double from; /* share of the whole that other processes computed beforehand; for progress */
    double started_s; /* start of the study's first run */
    /* True if `spent` is not called yet: runs report their cost when they are assembled. */
    bool spent_deferred;
    struct orl_study_step step; /* for progress */
    char ***warnings;           /* warnings of the study; new ones are appended */
    size_t *n_warnings;
};

/* Runs one setting with one seed. Returns 0 or the error of orl_run; ret_run is owned by the caller
 * on success. */
int orl_one_run_make(struct orl_runs_env *env, const struct orl_study_setting *setting,
                     uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err);

#endif
