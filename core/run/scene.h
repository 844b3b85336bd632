/*
 * The scene of a job: held from a run before it, found on the shelf, or read from its files. Jobs
 * that read one scene at the same time share it from then on. Threads: the lead's only; what comes
 * of it is immutable.
 */
#ifndef ORL_RUN_SCENE_H
#define ORL_RUN_SCENE_H

#include "run/stages.h"

/*
 * Load and bvh stages: state->scene, and state->lights with the job's sky. What the scene's files
 * have wrong goes into the result's health and warnings, whether it was read now or before.
 */
int orl_run_load(struct orl_run_state *state, struct orl_error *err);

/* The same job as orl_run's, of a scene that the caller holds; *scene NULL: it is read, and held
 * for the caller, also where the run fails later. */
int orl_run_of_scene(const struct orl_job *job, const struct orl_run_env *env,
                     struct orl_scene **scene, struct orl_result *ret_result,
                     struct orl_error *err);

/* Measures a scene after shades have changed materials of windows; fills in no file names.
 * Errors are those of reading it and of orl_swaps_apply. */
int orl_run_measure_swapped(const char *const *main_files, size_t n_files,
                            const struct orl_files *files, const struct orl_swaps *swaps,
                            struct orl_scene_summary *ret_summary, struct orl_error *err);

#endif
