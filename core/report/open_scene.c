#include "report/open_scene.h"

#include "annual/shades/variant.h"
#include "run/cache/scene_cache.h"
#include "run/stages.h"

int orl_open_scene(const struct orl_annual_request *request, const struct orl_run_env *given,
                   struct orl_scene **ret_scene, struct orl_error *err)
{
    struct orl_run_env env = *given;
    struct orl_result result = {.threads = 0};
    struct orl_job job;
    struct orl_annual_variant open;
    const unsigned char states[ORL_SHADES_MOST_GROUPS] = {0};
    struct orl_told told = {0};
    orl_job_init(&job);
    int code = orl_annual_variant_init(&open, request, states, false, err);
    job.scene_files = open.request.scene_files; /* borrowed */
    job.n_scene_files = open.request.n_scene_files;
    env.progress = NULL;
    struct orl_run_state state = {
        .job = &job, .env = &env, .result = &result, .told = &told, .swaps = &open.swaps};
    if (code == 0)
        code = orl_run_load(&state, err);
    orl_lights_release(state.lights);
    orl_result_done(&result);
    orl_annual_variant_done(&open);
    if (code < 0)
        orl_scene_release(state.scene);
    else
        *ret_scene = state.scene;
    return code;
}
