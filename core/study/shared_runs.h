/*
 * A study's runs as pieces of a job that is shared (oriel/pieces.h): each setting with each seed is
 * one, the reference's seeds among them, and what the machine is worth another. What a run took is
 * in its piece, by the clock of whoever made it. None needs another: all are of one wave.
 */
#ifndef ORL_STUDY_SHARED_RUNS_H
#define ORL_STUDY_SHARED_RUNS_H

#include "study/one_run.h"

bool orl_study_is_shared(const struct orl_study_env *env);

/* Until all of them are made, here or elsewhere; the speed is taken (speed.h). Of a study that is
 * shared. */
int orl_share_runs(struct orl_runs_env *env, const struct orl_study_setting *settings,
                   size_t n_settings, double *ret_rays_per_s, struct orl_error *err);

/* One of them, made here where it is nowhere; ret_run is the caller's on success. */
int orl_shared_run_find(struct orl_runs_env *env, const struct orl_study_setting *setting,
                        uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err);

#endif
