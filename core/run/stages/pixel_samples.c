/* Samples per pixel, and the number of rounds. */
#include "run/run_state.h"
#include "run/stages/run_stages.h"

uint32_t orl_run_pixel_samples(const struct orl_run_state *state)
{
    const uint32_t asked = state->job->pixel_samples;
    return asked                                ? asked
           : orl_job_asks_for_glare(state->job) ? ORL_DEFAULT_GLARE_PIXEL_SAMPLES
                                                : ORL_DEFAULT_PIXEL_SAMPLES;
}

/* Returns the number of rounds. By photon maps each costs the full time of the views, however few
 * the photons: use the fewest whose spread has some degrees of freedom. */
uint32_t orl_run_count_batches(const struct orl_run_state *state)
{
    enum { OF_PATHS = 8, OF_MAPS = 4 };
    const uint32_t most = orl_run_pixel_samples(state);
    if (!orl_job_asks_for_glare(state->job))
        return 1;
    if (state->result->plan.technique != ORL_TECHNIQUE_BACKWARD)
        return OF_MAPS;
    return most < OF_PATHS ? most : OF_PATHS;
}
