#include "report/unshaded_scene.h"

#include "annual/shades/shaded_scene.h"
#include "run/cache/scene_cache.h"
#include "run/run_state.h"

int orl_unshaded_scene_load(const struct orl_annual_request *request,
                            const struct orl_run_env *given, struct orl_scene **ret_scene,
                            struct orl_error *err)
{
    struct orl_run_env env = *given;
    struct orl_result result = {.threads = 0};
    struct orl_job job;
    struct orl_shaded_scene open;
    const unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_progress progress = {0};
    orl_job_init(&job);
    int code = orl_shaded_scene_init(&open, request, states, false, err);
    job.scene_files = open.request.scene_files; /* borrowed */
    job.n_scene_files = open.request.n_scene_files;
    env.progress = NULL;
    struct orl_run_state state = {.job = &job,
                                  .env = &env,
                                  .result = &result,
                                  .progress = &progress,
                                  .material_overrides = &open.material_overrides};
    if (code == 0)
        code = orl_run_load_scene(&state, err);
    orl_lights_release(state.lights);
    orl_result_done(&result);
    orl_shaded_scene_done(&open);
    if (code < 0)
        orl_scene_release(state.scene);
    else
        *ret_scene = state.scene;
    return code;
}
