/* Loads a year's scene like a job without a sky, with its shades in their first state. */
#ifndef ORL_REPORT_UNSHADED_SCENE_H
#define ORL_REPORT_UNSHADED_SCENE_H

#include <oriel/annual/annual.h>

#include "scene/built/scene.h"

/* Reads the scene, or takes it from the memory cache. The caller releases *ret_scene. Returns 0 or
 * the error of loading. */
int orl_unshaded_scene_load(const struct orl_annual_request *request, const struct orl_run_env *env,
                            struct orl_scene **ret_scene, struct orl_error *err);

#endif
