#include "plan/plan.h"

#include <stdio.h>
#include <string.h>

static uint64_t photons(uint64_t asked)
{
    return asked == ORL_PHOTONS_BY_PLAN ? ORL_DEFAULT_PHOTONS : asked;
}

int orl_plan_make(const struct orl_plan_request *request, struct orl_world *world,
                  struct orl_plan *ret_plan, struct orl_error *err)
{
    const struct orl_job *job = request->job;
    (void)world;
    (void)err;
    memset(ret_plan, 0, sizeof *ret_plan);
    ret_plan->technique =
        job->technique == ORL_TECHNIQUE_AUTO ? ORL_TECHNIQUE_GATHER : job->technique;
    ret_plan->most_reflections = ORL_ALL_REFLECTIONS;
    ret_plan->channels = 3;
    ret_plan->photons_global = photons(job->photons_global);
    ret_plan->photons_caustic = photons(job->photons_caustic);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        ret_plan->effects[i].simulated = true;
        ret_plan->effects[i].wish = job->wishes[i];
    }
    return 0;
}
