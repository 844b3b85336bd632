/* A year from its request to its rows: load -> skies -> paths, sun and hours, block by block. */
#include <stdlib.h>
#include <string.h>

#include "annual/blocks.h"
#include "annual/scope.h"
#include "run/scene.h"

/* Half an hour: a patch of sun moves by a quarter of its distance from the window. */
static const struct orl_sun_spacing spacing = {4, 7.5};

/* ---- Load ------------------------------------------------------------------------------------ */

static int admit_sources(const struct orl_description *description, struct orl_error *err)
{
    if (description->n_distants == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID,
                  "a year has skies and suns of its own, but the scene has the distant source "
                  "'%.100s'",
                  description->distants[0].name);
    orl_error_at(err, NULL, 0, "scene");
    orl_error_hint(err, "Leave sky and sun out of the scene");
    return ORL_ERR_INVALID;
}

/* The scene and the lamps in it, as a job of no sky loads them. */
static int load_scene(struct orl_year *y, struct orl_error *err)
{
    struct orl_job job;
    struct orl_result result = {0};
    struct orl_run_env env = *y->env->run;
    double told = 0;
    orl_job_init(&job);
    job.scene_files = y->request->scene_files;
    job.n_scene_files = y->request->n_scene_files;
    job.seed = y->request->seed;
    env.progress = NULL;
    struct orl_run_state state = {.job = &job, .env = &env, .result = &result, .told = &told};
    state.swaps = y->variant ? y->variant->swaps : NULL;
    state.stage_started = state.started_s = orl_year_now(y);
    int code = orl_run_load(&state, err);
    y->lights = state.lights;
    if (code == 0)
        code = admit_sources(&state.scene->description, err);
    orl_scene_release(state.scene);
    orl_health_add(&y->result->health, &result.health);
    y->result->warnings = result.warnings;
    y->result->n_warnings = result.n_warnings;
    result.warnings = NULL;
    result.n_warnings = 0;
    orl_result_done(&result);
    return code;
}

static void warn_of_curved(struct orl_year *y)
{
    uint32_t first = 0;
    const size_t n = orl_annual_count_curved(y->world, &first);
    if (n == 0)
        return;
    const struct orl_description *d = &y->world->scene->description;
    const struct orl_surface *surface = &d->surfaces[y->world->geometry->facets[first].surface];
    orl_year_warn(y,
                  "sunlight that %zu curved panes or polished surfaces mirror is left out (first: "
                  "%.100s at %.200s:%d): make them of flat pieces",
                  n, surface->name, surface->file, surface->line);
}

static int make_world(struct orl_year *y, struct orl_error *err)
{
    int code = load_scene(y, err);
    if (code == 0)
        code = orl_world_new(y->lights, &y->world, err);
    if (code == 0)
        code = orl_annual_admit(y->world, err);
    if (code < 0 || !y->world)
        return code;
    warn_of_curved(y);
    if (y->world->n_emitters > 0)
        orl_year_warn(y, "the scene's lamps are left out: a year of daylight has no lamps on");
    y->world->n_emitters = 0;
    return 0;
}

/* ---- Skies ----------------------------------------------------------------------------------- */

/* Nodes of the columns that have a sun. */
static int place_nodes(struct orl_year *y)
{
    const struct orl_hours *hours = &y->hours;
    const struct orl_turn north = orl_turn_by(y->request->north_deg);
    struct orl_vec3 *suns = malloc((hours->n_columns + 1) * sizeof *suns);
    size_t n = 0;
    if (!suns)
        return ORL_ERR_NOMEM;
    for (size_t c = 0; c < hours->n_columns; c++)
        if (hours->suns[c].normal_lx > 0)
            suns[n++] = hours->sky_suns[c];
    const int code = orl_sun_nodes_init(&y->nodes, y->result->latitude_deg, suns, n,
                                        orl_sun_spacing_at(y->result->latitude_deg, spacing));
    free(suns);
    y->node_frames = malloc((y->nodes.count + 1) * sizeof *y->node_frames);
    if (code < 0 || !y->node_frames)
        return ORL_ERR_NOMEM;
    for (size_t k = 0; k < y->nodes.count; k++)
        y->node_frames[k] = orl_frame_about(orl_turn_to_scene(north, y->nodes.at[k]));
    return 0;
}

static int prepare(struct orl_year *y, struct orl_error *err)
{
    double since = orl_year_now(y);
    int code = make_world(y, err);
    orl_year_book(y, ORL_ANNUAL_LOAD, &since);
    orl_bins_init(&y->bins);
    orl_year_tell(y, ORL_STAGE_MAPS, 0);
    if (code == 0)
        code = y->variant && y->variant->hours_of
                   ? orl_year_borrow_hours(y, y->variant->hours_of, err)
                   : orl_year_read_hours(y, err);
    if (code < 0)
        return code;
    if (place_nodes(y) < 0)
        return orl_year_no_memory(err);
    if (orl_annual_scene_init(&y->scene, y->world, &y->bins, orl_turn_by(y->request->north_deg),
                              y->node_frames, y->nodes.count, y->nodes.a_circle, y->request->seed,
                              y->env->run->crew) < 0)
        return orl_crew_cancelled(y->env->run->crew) ? orl_year_cancelled(err)
                                                     : orl_year_no_memory(err);
    if (y->scene.mirrors.n_left_out > 0)
        orl_year_warn(y,
                      "flat mirrors and panes lie in more planes than a year follows: the sun's "
                      "reflections in %zu of them, the smallest, are left out",
                      y->scene.mirrors.n_left_out);
    y->n_beams = y->scene.map ? orl_sun_map_beams(y->scene.map)->count : 0;
    y->n_sun = y->nodes.count + y->n_beams;
    code = orl_sun_terms_init(&y->terms, &y->hours, &y->nodes, y->node_frames, y->scene.map,
                              y->env->run->crew);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? orl_year_cancelled(err) : orl_year_no_memory(err);
    code = orl_panels_init(&y->panels, y->world, &y->hours, &y->scene.sobol, y->request->seed,
                           y->env->run->crew);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code,
                             "more than %d kinds of BSDF panes, by material and "
                             "direction, are too many for a year",
                             ORL_PANEL_MOST_KINDS);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? orl_year_cancelled(err) : orl_year_no_memory(err);
    y->result->n_nodes = y->nodes.count;
    orl_year_tell_hours(y);
    orl_year_book(y, ORL_ANNUAL_SKIES, &since);
    return 0;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int run_year(struct orl_year *y, struct orl_error *err)
{
    const int code = prepare(y, err);
    return code < 0 ? code : orl_year_run_blocks(y, err);
}

static void let_go(struct orl_year *y)
{
    orl_panels_done(&y->panels);
    orl_annual_scene_done(&y->scene);
    orl_world_free(y->world);
    orl_lights_release(y->lights);
    if (y->variant && y->variant->hours_of) {
        free(y->hours.steps);
        free(y->hours.step_of_column);
    } else {
        orl_hours_done(&y->hours);
    }
    orl_sun_nodes_done(&y->nodes);
    free(y->node_frames);
    orl_sun_terms_done(&y->terms);
    orl_year_blocks_done(y);
    free(y);
}

int orl_year_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                 const struct orl_year_variant *variant, struct orl_annual_result *ret_result,
                 struct orl_error *err)
{
    const uint32_t samples = request->samples > 0 ? request->samples : ORL_ANNUAL_SAMPLES;
    const uint32_t of_batch = (samples + ORL_ANNUAL_BATCHES - 1) / ORL_ANNUAL_BATCHES;
    struct orl_annual_result result = {.seed = request->seed,
                                       .threads = orl_crew_size(env->run->crew),
                                       .samples = of_batch * ORL_ANNUAL_BATCHES,
                                       .n_sensors = request->n_sensors};
    struct orl_year *y = calloc(1, sizeof *y);
    if (!y)
        return orl_year_no_memory(err);
    y->variant = variant;
    y->request = request;
    y->env = env;
    y->result = &result;
    y->batch_samples = of_batch;
    y->started_s = orl_year_now(y);
    orl_year_tell(y, ORL_STAGE_LOAD, 0);
    orl_crew_heed(env->run->crew, env->run->cancel);
    const int code = run_year(y, err);
    orl_crew_heed(env->run->crew, NULL);
    result.total_s = orl_year_now(y) - y->started_s;
    let_go(y);
    if (code < 0) {
        orl_annual_done(&result);
        return code;
    }
    *ret_result = result;
    return 0;
}
