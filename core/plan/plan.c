#include "plan/plan.h"

#include <string.h>

#include "plan/decide.h"

int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_lit_scene **ret_lit_scene,
                  struct orl_error *err)
{
    struct orl_lit_scene *lit_scene;
    struct orl_plan_survey survey;
    struct orl_lit_specular lit;
    int code = orl_lit_scene_new(lights, request->pool, &lit_scene, err);
    if (code < 0)
        return code;
    memset(ret_plan, 0, sizeof *ret_plan);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        ret_plan->effects[i].override = request->job->overrides[i];
    code = orl_plan_survey_init(&survey, request, lit_scene);
    if (code < 0) {
        orl_error_set(err, code, "out of memory for the plan");
        goto done;
    }
    orl_decide_materials(&survey, ret_plan);
    orl_decide_lights(&survey, ret_plan);
    orl_decide_windows(&survey, ret_plan);
    orl_decide_color(&survey, ret_plan);
    orl_lit_specular_find(&survey, &lit);
    ret_plan->paths = orl_find_path_set(&survey, &lit);
    orl_decide_technique(&survey, &lit, ret_plan);
    orl_decide_caustics(&survey, &lit, ret_plan);
    orl_decide_requests(&survey, ret_plan);
    orl_lit_scene_update_seen(lit_scene);
done:
    orl_plan_survey_done(&survey);
    if (code == 0)
        *ret_lit_scene = lit_scene;
    else
        orl_lit_scene_free(lit_scene);
    return code;
}
