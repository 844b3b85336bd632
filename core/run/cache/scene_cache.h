/*
 * Caches data that take long to load and do not depend on the job. They are found in the store
 * beside the photon maps, or made and stored. The result is bit-identical in both cases.
 *
 * A stored file that is damaged or of an earlier version is made again, with a warning. Failing to
 * store costs only time.
 */
#ifndef ORL_RUN_CACHE_SCENE_CACHE_H
#define ORL_RUN_CACHE_SCENE_CACHE_H

#include "run/run_state.h"
#include "scene/parse/parse.h"

struct orl_file_cache_entry {
    const char *kind, *key;  /* names in the store */
    const char *what, *name; /* "BSDF", "pane.xml", for messages */
    /* True if it also depends on files that the key does not include, so that ORL_ERR_VERSION
     * causes no warning. */
    bool may_be_outdated;
    void *ctx;
    int (*open)(void *ctx, const char *path, struct orl_error *err);
    int (*make)(void *ctx, struct orl_error *err);
    /* Returns true if the data are worth storing. NULL: always. */
    bool (*is_worth_storing)(void *ctx);
    /* Writes the data, and fills the info's bytes and stored. */
    int (*write)(void *ctx, const char *path, struct orl_map_info *info, struct orl_error *err);
};

/* Opens or makes the thing. The state's env must have a store. Returns the codes of open and make,
 * or ORL_ERR_CANCELLED. */
int orl_file_cache_get(struct orl_run_state *state, const struct orl_file_cache_entry *entry,
                       struct orl_error *err);

/*
 * Loads BSDFs through the store: the XML is read once, and the result is stored (file_cache.h), as
 * kind "bsdf", for later jobs to map (bsdf/compiled_bsdf.h). Small files, which load as fast as a
 * look-up, are not stored; without a store none are.
 */

/* Returns a loader that borrows the state, which must outlive it. */
struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state);

/*
 * Loads scenes through the store: the files are read once, and the parsed scene is stored
 * (file_cache.h), as kind "scene". Later jobs, and parts of a job on other machines, map it
 * (scene/cache/scene_cache_file.h). Scenes of few surfaces, which are read as fast as a look-up,
 * are not stored; without a store none are.
 */

/* Reads the job's scene, resolved, with the state's swaps. Errors are the parser's
 * (scene/parse/parse.h). */
int orl_run_read_scene(struct orl_run_state *state, struct orl_parsed_scene *ret_parsed_scene,
                       struct orl_error *err);

/*
 * The scene of a job: passed in from an earlier run, found in the memory cache, or read from its
 * files. Jobs that read one scene at the same time share it afterwards. Threads: only the lead's;
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
