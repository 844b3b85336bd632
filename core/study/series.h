/*
 * Runs of one setting: values of every sensor or pixel, and the cost. In a distributed study other
 * processes have made them (shared_runs.h).
 */
#ifndef ORL_STUDY_SERIES_H
#define ORL_STUDY_SERIES_H

#include "study/one_run.h"

/* Runs of one setting with seeds first_seed, first_seed + 1, ... */
struct orl_series {
    size_t n_runs, count; /* count: values per run */
    double **values;      /* owned: n_runs arrays of count values, lux or cd/m2 */
    double *errors;       /* owned: standard errors of the last run; NULL: unknown */
    double (*stages_s)[ORL_STAGE_COUNT], *total_s; /* owned, by run */
    uint64_t map_bytes;                            /* from the first run */
    uint32_t threads;                              /* from the first run */
};
void orl_series_done(struct orl_series *series);

/* Runs a setting n_runs times. Returns 0 or the error of orl_run; ret_series is owned by the caller
 * on success. */
int orl_series_run(struct orl_runs_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err);

#endif
