/*
 * A single run of a study: one setting with one seed, its values and what they took.
 *
 * Each run has a folder for maps and images of its own making, in which it leaves nothing: its
 * store forgets a map as soon as the run lets go of it, so that no run finds another's.
 */
#ifndef ORL_STUDY_ONE_RUN_H
#define ORL_STUDY_ONE_RUN_H

#include <oriel/study.h>

/* What came of it. All owned. */
struct orl_one_run {
    double *values; /* of each sensor or pixel, lux or cd/m2 */
    size_t count;
    double *errors; /* standard errors of these; NULL: not known */
    double stages_s[ORL_STAGE_COUNT], total_s;
    uint64_t map_bytes;
    uint32_t threads;
    struct orl_health health;
    char **warnings;
    size_t n_warnings;
};
void orl_one_run_done(struct orl_one_run *run); /* all zeros are fine */

/* What a study's runs share. */
struct orl_runs_env {
    const struct orl_study_request *request;
    const struct orl_study_env *env;
    char folder[4096];          /* for maps and images */
    double sensors;             /* how many there are */
    double before, share, all;  /* of the whole study's cost: runs that ended, this one, all */
    double from;                /* of the whole, made elsewhere beforehand: for progress */
    double started_s;           /* the study's first run */
    bool untold;                /* what runs spend is told of when they are put together */
    struct orl_study_step step; /* for progress */
    char ***warnings;           /* of the study: where new ones go */
    size_t *n_warnings;
};

/* Returns 0 or what orl_run returned; ret_run is the caller's on success. */
int orl_one_run_make(struct orl_runs_env *env, const struct orl_study_setting *setting,
                     uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err);

#endif
