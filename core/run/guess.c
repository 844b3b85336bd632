/* What the stages of a job are going to take, roughly, before anything was measured. */
#include <math.h>

#include "run/stages.h"

/* Rough costs, microseconds on one core: a photon traced, one indexed, a gather ray, what one reads
 * of the map for the first time, all of it at the most by photons, a path by backward. */
static const double photon_us = 1.5, index_us = 0.25, gather_us = 2.5, first_us = 10, leaf_us = 0.5,
                    path_us = 10;
/* Of a pixel, by technique. */
static const double pixel_us[] = {[ORL_TECHNIQUE_AUTO] = 20,
                                  [ORL_TECHNIQUE_DIRECT] = 20,
                                  [ORL_TECHNIQUE_PRECOMPUTED] = 6,
                                  [ORL_TECHNIQUE_GATHER] = 16};

static double pixels_of(const struct orl_job *job)
{
    double pixels = 0;
    for (size_t i = 0; i < job->n_views; i++)
        pixels += (double)job->views[i].width * job->views[i].height;
    return pixels;
}

/* Microseconds of all views, and of all sensors, on one core. */
static double views_us(const struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    const double samples = job->pixel_samples ? job->pixel_samples : ORL_DEFAULT_PIXEL_SAMPLES;
    const enum orl_technique technique = state->result->plan.technique;
    return pixels_of(job) *
           (technique == ORL_TECHNIQUE_BACKWARD ? samples * path_us : pixel_us[technique]);
}

static double sensors_us(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const double samples =
        state->job->gather_samples ? state->job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    const double rays = (double)state->n_sensors * samples;
    double us = rays * (plan->technique == ORL_TECHNIQUE_BACKWARD ? path_us : gather_us);
    if (plan->technique == ORL_TECHNIQUE_GATHER)
        us +=
            fmin((double)plan->photons_global * leaf_us, (rays + pixels_of(state->job)) * first_us);
    return us;
}

double orl_run_sensors_share(const struct orl_run_state *state)
{
    const double sensors = sensors_us(state), all = sensors + views_us(state);
    return all > 0 ? sensors / all : 1;
}

void orl_run_guess_costs(struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const bool planned = plan->technique != ORL_TECHNIQUE_AUTO;
    const double photons = planned ? (double)(plan->photons_global + plan->photons_caustic)
                                   : 2.0 * ORL_DEFAULT_PHOTONS;
    const double crew = orl_crew_size(state->env->crew), us = 1e-6 / crew;
    state->cost_s[ORL_STAGE_LOAD] = 0.2;
    state->cost_s[ORL_STAGE_BVH] = 0.05;
    state->cost_s[ORL_STAGE_PLAN] = 0.1;
    state->cost_s[ORL_STAGE_PHOTONS] = us * photons * photon_us;
    if (plan->foresight.known)
        state->cost_s[ORL_STAGE_PHOTONS] = plan->foresight.photons_s;
    state->cost_s[ORL_STAGE_MAPS] =
        plan->technique == ORL_TECHNIQUE_BACKWARD ? 0 : us * photons * index_us;
    state->cost_s[ORL_STAGE_RENDER] = us * (sensors_us(state) + views_us(state));
}
