#include <math.h>

#include "render/gather/sensor_flux.h"
#include "run/estimate/run_cost.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

/* Returns an upper bound of the time for photons to sensors in mid-air; their number is only known
 * at run time. */
static double sensor_flux_limit_s(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_photon_forecast *f = &plan->forecast;
    if (state->n_sensors == 0 || !(f->emitted[1] > 0) ||
        !orl_sensor_flux_may_exist(state->lit_scene))
        return 0;
    return (double)orl_run_sensor_flux_limit(state) * f->seconds[1] / f->emitted[1];
}

/*
 * Predicts the job's time. It stays unknown for pixels and paths, and for photons if a pilot found
 * too few. It is also unknown if the early end of photons to sensors in mid-air makes too large a
 * difference.
 */
void orl_run_estimate_from_pilot(struct orl_run_state *state)
{
    const double max_ratio = 3.5;
    struct orl_plan *plan = &state->result->plan;
    struct orl_photon_forecast *f = &plan->forecast;
    const bool known = f->known && plan->technique == ORL_TECHNIQUE_GATHER &&
                       state->job->n_views == 0 && !orl_goal_is_set(&state->job->goal);
    double least = known ? state->env->now_s(state->env->ctx) - state->started_s : NAN;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++)
        least += state->cost_s[i];
    const double most = least + sensor_flux_limit_s(state);
    f->job_s = most <= max_ratio * least ? sqrt(least * most) : NAN;
    if (isfinite(f->job_s) && !orl_run_is_measured(state))
        state->cost_s[ORL_STAGE_RENDER] += f->job_s - least;
}
