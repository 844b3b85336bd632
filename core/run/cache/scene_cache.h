/* Scenes of jobs: built scenes in memory, shared by jobs, and parsed scenes in the store. */
#ifndef ORL_RUN_CACHE_SCENE_CACHE_H
#define ORL_RUN_CACHE_SCENE_CACHE_H

#include "run/run_state.h"
#include "scene/parse/parse.h"

/*
 * Caches data that take long to load and do not depend on the job. They are found in the store
 * beside the photon maps, or made and stored. The result is bit-identical in both cases.
 *
 * A stored file that is damaged or of an earlier version is made again, with a warning. Failing to
 * store costs only time.
 */

/*
 * Loads scenes through the store: the files are read once, and the parsed scene is stored as kind
 * "scene". Later jobs, and tasks of a job on other machines, map it
 * (scene/cache/scene_cache_file.h). Scenes of few surfaces, which are read as fast as a look-up,
 * are not stored; without a store none are.
 */

/* Reads the job's scene, resolved, with the state's material overrides. Errors are the parser's
 * (scene/parse/parse.h). */
int orl_run_read_scene(struct orl_run_state *state, struct orl_parsed_scene *ret_parsed_scene,
                       struct orl_error *err);

/*
 * The scene of a job: passed in from an earlier run, found in the memory cache, or read from its
 * files. Jobs that read one scene at the same time share it afterwards. Threads: the lead thread;
 * the result is immutable.
 */

/*
 * Runs the load and bvh stages: sets state->scene, and state->lights with the job's sky. Faults of
 * the scene's files go into the result's health and warnings, even if the scene was read by an
 * earlier run.
 */
int orl_run_load_scene(struct orl_run_state *state, struct orl_error *err);

/* Runs a job like orl_run, with a scene that the caller owns. If *scene is NULL it is read and
 * passed to the caller, even if the run fails later. */
int orl_run_with_scene(const struct orl_job *job, const struct orl_run_env *env,
                       struct orl_scene **scene, struct orl_result *ret_result,
                       struct orl_error *err);

/* Measures a scene after shades have changed materials of windows; fills in no file names.
 * Errors are those of reading it and of orl_material_overrides_apply. */
int orl_run_measure_overridden(const char *const *main_files, size_t n_files,
                               const struct orl_files *files,
                               const struct orl_material_overrides *material_overrides,
                               struct orl_scene_summary *ret_summary, struct orl_error *err);

#endif
