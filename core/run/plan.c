/* The plan stage: what the planner finds, into the result. */
#include "plan/plan.h"

#include "run/stages.h"

int orl_run_plan(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_plan_request request = {.job = state->job,
                                             .sensors = state->sensors,
                                             .n_sensors = state->n_sensors,
                                             .crew = state->env->crew,
                                             .now_s = state->env->now_s,
                                             .ctx = state->env->ctx};
    const int code = orl_plan_make(&request, state->world, &state->result->plan, err);
    if (code == 0 && state->env->plan_ready)
        state->env->plan_ready(state->env->ctx, &state->result->plan);
    return code;
}
