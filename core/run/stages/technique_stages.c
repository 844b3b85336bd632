/* The photons, maps and render stages by the plan's technique (render/technique/technique.h). */
#include <math.h>
#include <string.h>

#include "render/technique/technique.h"
#include "run/cache/emission_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"
#include "run/stages/run_stages.h"

int orl_run_ensure_renderer(struct orl_run_state *state, struct orl_error *err)
{
    const enum orl_technique technique = state->result->plan.technique;
    struct orl_renderer *renderer = &state->renderer;
    if (!orl_technique_reads_maps(technique)) {
        const int code = orl_run_ensure_emission(state, err);
        if (code < 0)
            return code;
    }
    return renderer->methods
               ? 0
               : orl_renderer_create(technique, state->lit_scene, state->env->pool, renderer, err);
}

/* ---- Input of a technique -------------------------------------------------------------------- */

/* Returns the limit as for a requested caustic map. A plan stores fewer photons if a map would show
 * little of them, which says nothing about a single sensor. */
uint64_t orl_run_sensor_flux_limit(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const bool by_plan = state->job->photons_caustic != plan->photons_caustic;
    return by_plan && plan->photons_global > plan->photons_caustic ? plan->photons_global
                                                                   : plan->photons_caustic;
}

/* Returns the ray budget for photons that change no sensor: at most the cost of building and
 * reading the global map. There each photon takes a ray of its own and is indexed and read. */
static double idle_ray_budget(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const double of_a_photon = 2;
    const uint64_t photons = plan->photons_global > 0 ? plan->photons_global : ORL_DEFAULT_PHOTONS;
    return state->job->photons_exact ? INFINITY : of_a_photon * (double)photons;
}

static int get_emission(void *ctx, const struct orl_emission **ret_emission, struct orl_error *err)
{
    struct orl_run_state *state = ctx;
    const int code = orl_run_ensure_emission(state, err);
    *ret_emission = state->emission;
    return code;
}

static void report_progress(void *ctx, double fraction)
{
    orl_run_report_progress(ctx, fraction);
}

static void report_map_read(void *ctx, double share)
{
    orl_run_discount_map_reads(ctx, share);
}

static void replace_sensor(void *ctx, size_t index, const struct orl_estimate *estimate)
{
    orl_run_store_sensor(ctx, index, estimate);
}

/* Returns the input of a round, whose photon maps are made. */
static struct orl_technique_input make_input(struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    struct orl_technique_input input = {
        .lit_scene = state->lit_scene,
        .pool = state->env->pool,
        .searches = state->searches,
        .cancel = state->env->cancel,
        .seed = job->seed,
        .n_sensors = state->n_sensors,
        .n_views = job->n_views,
        .pixel_samples = orl_run_pixel_samples(state),
        .sums_of_pixels = job->goal.dgp_error > 0,
        .bandwidths = state->round.bandwidths,
        .memory_cache = state->env->memory_cache,
        .sensor_photons = {orl_run_sensor_flux_limit(state), idle_ray_budget(state)},
        .virtual_lights = state->result->plan.photons_global,
        .health = &state->result->health,
        .get_emission = get_emission,
        .report_progress = report_progress,
        .report_map_read = report_map_read,
        .replace_sensor = replace_sensor,
        .ctx = state};
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++) {
        input.maps[kind] = state->maps[kind];
        input.map_keys[kind] = state->keys[kind];
    }
    return input;
}

/* ---- The stages ------------------------------------------------------------------------------ */

/* Runs the photons and maps stages of a technique that reads maps; in the dark there are none. */
static int make_maps(struct orl_run_state *state, struct orl_error *err)
{
    const int code = orl_run_is_dark(state) ? 0 : orl_run_prepare_maps(state, err);
    return code == 0 ? orl_run_ensure_renderer(state, err) : code;
}

/* Begins the photons stage of a technique that traces its own. */
static int begin_photons(struct orl_run_state *state, struct orl_error *err)
{
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    const int code = orl_run_ensure_renderer(state, err);
    if (code == 0)
        orl_run_begin_work(state);
    return code;
}

int orl_run_technique(struct orl_run_state *state, struct orl_error *err)
{
    int code = orl_technique_reads_maps(state->result->plan.technique) ? make_maps(state, err)
                                                                       : begin_photons(state, err);
    if (code < 0)
        return code;
    const struct orl_renderer *renderer = &state->renderer;
    const struct orl_technique_input input = make_input(state);
    code = renderer->methods->prepare(renderer->technique, &input, err);
    if (code < 0)
        return code;
    code = orl_run_render(state, err);
    if (renderer->methods->finish)
        renderer->methods->finish(renderer->technique);
    return code;
}
