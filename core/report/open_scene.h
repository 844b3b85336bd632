/* A year's scene as a job without a sky has it, its shades in their first state. */
#ifndef ORL_REPORT_OPEN_SCENE_H
#define ORL_REPORT_OPEN_SCENE_H

#include <oriel/annual.h>

#include "light/scene.h"

/* Reads it, or finds it on the shelf. The caller holds *ret_scene. Returns 0 or what loading says.
 */
int orl_open_scene(const struct orl_annual_request *request, const struct orl_run_env *env,
                   struct orl_scene **ret_scene, struct orl_error *err);

#endif
