#include <math.h>

#include "render/gather/air.h"
#include "run/stages.h"

/* Rough costs, microseconds on one core: a photon traced, one indexed, a gather ray, what one reads
 * of the map for the first time, all of it at the most by photons, a pixel. */
static const double photon_us = 1.5, index_us = 0.25, gather_us = 2.5, first_us = 10, leaf_us = 0.5,
                    pixel_us = 40;

void orl_run_guess_costs(struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    const struct orl_plan *plan = &state->result->plan;
    const bool planned = plan->technique != ORL_TECHNIQUE_AUTO;
    const double photons = planned ? (double)(plan->photons_global + plan->photons_caustic)
                                   : 2.0 * ORL_DEFAULT_PHOTONS;
    const double samples = job->gather_samples ? job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    const double crew = orl_crew_size(state->env->crew), us = 1e-6 / crew;
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    state->cost_s[ORL_STAGE_LOAD] = 0.2;
    state->cost_s[ORL_STAGE_BVH] = 0.05;
    state->cost_s[ORL_STAGE_PLAN] = 0.1;
    state->cost_s[ORL_STAGE_PHOTONS] = us * photons * photon_us;
    if (plan->foresight.known)
        state->cost_s[ORL_STAGE_PHOTONS] = plan->foresight.photons_s;
    state->cost_s[ORL_STAGE_MAPS] =
        plan->technique == ORL_TECHNIQUE_BACKWARD ? 0 : us * photons * index_us;
    state->cost_s[ORL_STAGE_RENDER] =
        us * ((double)state->n_sensors * samples * gather_us + pixels * pixel_us);
    const double first_rays = (double)state->n_sensors * samples + pixels;
    if (plan->technique == ORL_TECHNIQUE_GATHER)
        state->cost_s[ORL_STAGE_RENDER] +=
            us * fmin((double)plan->photons_global * leaf_us, first_rays * first_us);
}

/* What photons that fly to sensors in mid-air take, at the most: who flies finds out how many. */
static double most_in_air_s(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_foresight *f = &plan->foresight;
    if (state->n_sensors == 0 || !(f->emitted[1] > 0) || !orl_air_may_be_lit(state->world))
        return 0;
    return (double)orl_run_most_in_air(state) * f->seconds[1] / f->emitted[1];
}

/* Nobody knows yet what pixels take, or paths; nor photons of which a pilot found too few, nor
 * whether flights to sensors end early, where that makes more of a difference than a guess may. */
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
    if (isfinite(f->job_s))
        state->cost_s[ORL_STAGE_RENDER] += f->job_s - least;
}
