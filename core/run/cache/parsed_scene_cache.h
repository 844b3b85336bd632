/*
 * Loads scenes through the store: the files are read once, and the parsed scene is stored
 * (file_cache.h), as kind "scene". Later jobs, and parts of a job on other machines, map it
 * (scene/cache/scene_cache_file.h). Scenes of few surfaces, which are read as fast as a look-up,
 * are not stored; without a store none are.
 */
#ifndef ORL_RUN_CACHE_PARSED_SCENE_CACHE_H
#define ORL_RUN_CACHE_PARSED_SCENE_CACHE_H

#include "run/run_state.h"

/* Reads the job's scene, resolved, with the state's swaps. Errors are the parser's
 * (scene/parse/parse.h). */
int orl_run_read_scene(struct orl_run_state *state, struct orl_parsed_scene *ret_parsed_scene,
                       struct orl_error *err);

#endif
