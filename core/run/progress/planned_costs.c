#include <math.h>

#include "render/gather/air.h"
#include "run/stages.h"

/* Returns an upper bound of the time for photons to sensors in mid-air; their number is only known
 * at run time. */
static double most_in_air_s(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_foresight *f = &plan->foresight;
    if (state->n_sensors == 0 || !(f->emitted[1] > 0) || !orl_air_may_be_lit(state->world))
        return 0;
    return (double)orl_run_most_in_air(state) * f->seconds[1] / f->emitted[1];
}

/*
 * Predicts the job's time. It stays unknown for pixels and paths, and for photons if a pilot found
 * too few. It is also unknown if the early end of photons to sensors in mid-air makes too large a
 * difference.
 */
void orl_run_foresee(struct orl_run_state *state)
{
    const double most_apart = 3.5;
    struct orl_plan *plan = &state->result->plan;
    struct orl_foresight *f = &plan->foresight;
    const bool known = f->known && plan->technique == ORL_TECHNIQUE_GATHER &&
                       state->job->n_views == 0 && !orl_goal_is_set(&state->job->goal);
    double least = known ? state->env->now_s(state->env->ctx) - state->started_s : NAN;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++)
        least += state->cost_s[i];
    const double most = least + most_in_air_s(state);
    f->job_s = most <= most_apart * least ? sqrt(least * most) : NAN;
    if (isfinite(f->job_s) && !orl_run_is_measured(state))
        state->cost_s[ORL_STAGE_RENDER] += f->job_s - least;
}
