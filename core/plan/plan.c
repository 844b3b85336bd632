#include "plan/plan.h"

#include <string.h>

#include "plan/decide.h"

int orl_plan_make(const struct orl_plan_request *request, struct orl_lights *lights,
                  struct orl_plan *ret_plan, struct orl_world **ret_world, struct orl_error *err)
{
    struct orl_world *world;
    struct orl_survey survey;
    struct orl_lit lit;
    int code = orl_world_new(lights, request->crew, &world, err);
    if (code < 0)
        return code;
    memset(ret_plan, 0, sizeof *ret_plan);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        ret_plan->effects[i].wish = request->job->wishes[i];
    code = orl_survey_init(&survey, request, world);
    if (code < 0) {
        orl_error_set(err, code, "out of memory for the plan");
        goto done;
    }
    orl_decide_materials(&survey, ret_plan);
    orl_decide_lights(&survey, ret_plan);
    orl_decide_windows(&survey, ret_plan);
    orl_decide_color(&survey, ret_plan);
    orl_lit_look(&survey, &lit);
    ret_plan->paths = orl_find_path_set(&survey, &lit);
    orl_decide_technique(&survey, &lit, ret_plan);
    orl_decide_caustics(&survey, &lit, ret_plan);
    orl_decide_requests(&survey, ret_plan);
    orl_world_settle(world);
done:
    orl_survey_done(&survey);
    if (code == 0)
        *ret_world = world;
    else
        orl_world_free(world);
    return code;
}
