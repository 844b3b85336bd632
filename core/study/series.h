/*
 * One setting, run after run: values of every sensor or pixel, and what they took. Runs of a study
 * in parts were made by others (shared_runs.h).
 */
#ifndef ORL_STUDY_SERIES_H
#define ORL_STUDY_SERIES_H

#include "study/one_run.h"

/* Runs of one setting with seeds first, first + 1, ... */
struct orl_series {
    size_t n_runs, count; /* count: values a run has */
    double **values;      /* owned: n_runs arrays of count values, lux or cd/m2 */
    double *errors;       /* owned: standard errors of the last run's; NULL: not known */
    double (*stages_s)[ORL_STAGE_COUNT], *total_s; /* owned, of each run */
    uint64_t map_bytes;                            /* of the first run */
    uint32_t threads;                              /* likewise */
};
void orl_series_done(struct orl_series *series);

/* Returns 0 or what orl_run returned; ret_series is the caller's on success. */
int orl_series_run(struct orl_runs_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err);

#endif
