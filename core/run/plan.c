/* The plan stage: what the planner finds, into the result, and warnings of what was asked against
 * its advice. */
#include "plan/plan.h"

#include "run/stages.h"

/* What leaving out may cost before it is worth a warning. */
static const double tolerable_lx = 0.01, tolerable_share = 1e-3;

static void judge_skip(struct orl_run_state *state, const char *name, const struct orl_decision *d)
{
    if (d->simulated)
        orl_run_warn(state, "%s cannot be skipped: %s", name, d->why);
    else if (d->unit == ORL_BOUND_LX && d->bound > tolerable_lx)
        orl_run_warn(state, "skipping %s may cost up to %.3g lx, as asked", name, d->bound);
    else if (d->unit == ORL_BOUND_RELATIVE && d->bound > tolerable_share)
        orl_run_warn(state, "skipping %s may cost up to %.3g %% of the light, as asked", name,
                     100 * d->bound);
}

/* Black results are to be no riddle. */
static void judge_light(struct orl_run_state *state)
{
    const struct orl_world *world = state->world;
    if (world->n_suns + world->n_domes + world->n_emitters == 0)
        orl_run_warn(state,
                     "no light: suns, skies and lamps, those left in, give less than %g lx: "
                     "everything is black",
                     tolerable_lx);
}

int orl_run_plan(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_plan_request request = {.job = state->job,
                                             .sensors = state->sensors,
                                             .n_sensors = state->n_sensors,
                                             .crew = state->env->crew,
                                             .now_s = state->env->now_s,
                                             .ctx = state->env->ctx};
    struct orl_plan *plan = &state->result->plan;
    const int code = orl_plan_make(&request, state->world, plan, err);
    for (int i = 0; i < ORL_EFFECT_COUNT && code == 0; i++)
        if (plan->effects[i].wish == ORL_WISH_SKIP)
            judge_skip(state, orl_effect_name((enum orl_effect)i), &plan->effects[i]);
    if (code == 0)
        judge_light(state);
    if (code == 0 && state->env->plan_ready)
        state->env->plan_ready(state->env->ctx, plan);
    return code;
}
