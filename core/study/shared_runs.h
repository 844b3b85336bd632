/*
 * Runs of a study as pieces of a distributed job (oriel/job/job_tasks.h). Each setting with each
 * seed is a piece, including the reference's seeds; the measured speed is another. A piece records
 * its run's time by the clock of the process that made it. All pieces are independent.
 */
#ifndef ORL_STUDY_SHARED_RUNS_H
#define ORL_STUDY_SHARED_RUNS_H

#include "study/one_run.h"

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
