/*
 * One setting, run after run: values of every sensor or pixel, and what they took.
 *
 * Each run has a folder for maps and images of its own making, in which it leaves nothing: its
 * store forgets a map as soon as the run lets go of it, so that no run finds another's.
 */
#ifndef ORL_STUDY_SERIES_H
#define ORL_STUDY_SERIES_H

#include <oriel/study.h>

/* What request.c offers the others. */
bool orl_study_of_views(const struct orl_study_request *request);
int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err);
void orl_study_free_given(struct orl_study_given *given, size_t count);

/* Runs of one setting with seeds first, first + 1, ... */
struct orl_series {
    size_t n_runs, count; /* count: values a run has */
    double **values;      /* owned: n_runs arrays of count values, lux or cd/m2 */
    double *errors;       /* owned: standard errors of the last run's; NULL: not known */
    double (*stages_s)[ORL_STAGE_COUNT], *total_s; /* owned, of each run */
    uint64_t map_bytes;                            /* of the first run */
};
void orl_series_done(struct orl_series *series);

/* What a study's runs share. */
struct orl_series_env {
    const struct orl_study_request *request;
    const struct orl_study_env *env;
    char folder[4096];          /* for maps and images */
    double before, share, all;  /* of the whole study's cost: runs that ended, this one, all */
    double started_s;           /* the study's first run */
    struct orl_study_step step; /* for progress */
    char ***warnings;           /* where new ones go */
    size_t *n_warnings;
};

/* Rough cost of a run, in the unit of others: for progress. */
double orl_series_cost(const struct orl_study_request *request,
                       const struct orl_study_setting *setting);

/* Returns 0 or what orl_run returned; ret_series is the caller's on success. */
int orl_series_run(struct orl_series_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err);

#endif
