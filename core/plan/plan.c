#include "plan/plan.h"

#include <string.h>

#include "light/proxies.h"
#include "plan/decide.h"

int orl_plan_make(const struct orl_plan_request *request, struct orl_world *world,
                  struct orl_plan *ret_plan, struct orl_error *err)
{
    struct orl_survey survey;
    struct orl_lit lit;
    memset(ret_plan, 0, sizeof *ret_plan);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        ret_plan->effects[i].wish = request->job->wishes[i];
    const int code = orl_survey_init(&survey, request, world);
    if (code < 0) {
        orl_error_set(err, code, "out of memory for the plan");
        goto done;
    }
    orl_decide_materials(&survey, ret_plan);
    orl_decide_lights(&survey, ret_plan);
    orl_decide_windows(&survey, ret_plan);
    orl_decide_color(&survey, ret_plan);
    orl_lit_look(&survey, &lit);
    orl_decide_technique(&survey, &lit, ret_plan);
    orl_decide_caustics(&survey, &lit, ret_plan);
    orl_decide_requests(&survey, ret_plan);
    orl_proxies_settle(world);
done:
    orl_survey_done(&survey);
    return code;
}
