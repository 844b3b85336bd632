/* Runs of a study: settings from its request, their cost, one run, one setting's runs, and the
 * runs of a distributed study. */
#ifndef ORL_STUDY_STUDY_RUNS_H
#define ORL_STUDY_STUDY_RUNS_H

#include <oriel/job/study.h>

/* Returns true if the study measures views, not sensors. */
bool orl_study_of_views(const struct orl_study_request *request);
/* Lists the settings, each technique with its numbers of photons and samples. *ret_settings is
 * owned by the caller. Returns 0 or ORL_ERR_NOMEM. */
int orl_study_list_settings(const struct orl_study_request *request,
                            struct orl_study_setting **ret_settings, size_t *ret_count,
                            struct orl_error *err);
/* Returns the setting of each run of the reference. */
struct orl_study_setting orl_study_reference_setting(const struct orl_study_request *request);
/* Returns the first seed of the reference. Its seeds differ from those of the measured runs. */
uint64_t orl_study_reference_seed(const struct orl_study_request *request);
void orl_study_free_external(struct orl_study_external *external, size_t count);

/* Estimates a run's time for that many sensors, in seconds of one core, before any was made. The
 * estimates serve progress and limits. */
double orl_study_run_core_s(const struct orl_job *job, const struct orl_study_setting *setting,
                            double sensors);

/*
 * A single run of a study: one setting with one seed, its values and their cost.
 *
 * Each run has its own folder for maps and images, and leaves it empty. Its store deletes a map as
 * soon as the run releases it, so no run finds maps of another.
 */

/* Cost of a run; also part of a stored run (shared_runs.c). */
struct orl_run_cost {
    uint64_t map_bytes, threads;
    double stages_s[ORL_STAGE_COUNT], total_s;
    struct orl_health health;
};

/* Result of a run. All arrays are owned. */
struct orl_one_run {
    double *values; /* by sensor or pixel, lux or cd/m2 */
    size_t count;
    double *errors; /* standard errors of the values; NULL: unknown */
    struct orl_run_cost cost;
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

/* Runs of one setting with seeds first_seed, first_seed + 1, ...: values of every sensor or pixel,
 * and the cost. In a distributed study other processes have made them. */
struct orl_series {
    size_t n_runs, count;       /* count: values per run */
    double **values;            /* owned: n_runs arrays of count values, lux or cd/m2 */
    double *errors;             /* owned: standard errors of the last run; NULL: unknown */
    struct orl_run_cost *costs; /* owned, by run */
};
void orl_series_done(struct orl_series *series);

/* Runs a setting n_runs times. Returns 0 or the error of orl_run; ret_series is owned by the caller
 * on success. */
int orl_series_run(struct orl_runs_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err);

/*
 * Runs of a study as tasks of a distributed job (oriel/job/job_tasks.h). Each setting with each
 * seed is a task, including the reference's seeds; the measured speed is another. A task records
 * its run's time by the clock of the process that made it. All tasks are independent.
 */

/* Returns true if other processes compute runs of the study. */
bool orl_study_is_shared(const struct orl_study_env *env);

/* Divides the runs of a distributed study among processes until all are made, and measures the
 * speed (speed.h). */
int orl_share_runs(struct orl_runs_env *env, const struct orl_study_setting *settings,
                   size_t n_settings, double *ret_rays_per_s, struct orl_error *err);

/* Returns one of the runs, and makes it if no process has. ret_run is owned by the caller on
 * success. */
int orl_shared_run_find(struct orl_runs_env *env, const struct orl_study_setting *setting,
                        uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err);

#endif
