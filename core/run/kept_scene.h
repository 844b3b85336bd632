/*
 * Scenes by the store: their files are read once, and what they say is kept (keeping.h), as kind
 * "scene", for later jobs, and for parts of a job on other machines, to map (scene/keep/keep.h).
 * Scenes of few surfaces, which are read as fast as they can be found, are left alone; without a
 * store all are.
 */
#ifndef ORL_RUN_KEPT_SCENE_H
#define ORL_RUN_KEPT_SCENE_H

#include "run/stages.h"

/* The job's scene, settled, with the state's swaps. Errors are the parser's (scene/parse/parse.h).
 */
int orl_run_read_scene(struct orl_run_state *state, struct orl_description *ret_description,
                       struct orl_error *err);

#endif
