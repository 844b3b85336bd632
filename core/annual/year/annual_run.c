/* Runs a year from its request to its rows: load, skies, then paths, sun and hours chunk by
 * chunk. */
#include <stdlib.h>
#include <string.h>

#include "annual/coefficients/sensor_chunks.h"
#include "annual/year/annual_year.h"
#include "run/cache/scene_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"

/* Half an hour: a patch of sun moves by a quarter of its distance from the window. */
static const struct orl_sun_spacing spacing = {4, 7.5};

/* ---- Load ------------------------------------------------------------------------------------ */

static int check_no_sources(const struct orl_parsed_scene *parsed_scene, struct orl_error *err)
{
    if (parsed_scene->n_distant_sources == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID,
                  "a year has skies and suns of its own, but the scene has the distant source "
                  "'%.100s'",
                  parsed_scene->distant_sources[0].name);
    orl_error_at(err, NULL, 0, "scene");
    orl_error_hint(err, "Leave sky and sun out of the scene");
    return ORL_ERR_INVALID;
}

/* Digests the scene: its files, and the material overrides. */
static int name_scene(struct orl_year *y, const struct orl_scene *scene, struct orl_error *err)
{
    const struct orl_parsed_scene *const parsed_scene = &scene->parsed_scene;
    struct orl_sha256 hash;
    struct orl_annual_result *const r = y->result;
    for (size_t i = 0; i < parsed_scene->n_files; i++)
        if (!orl_year_has_text(r->scene_read, r->n_scene_read, parsed_scene->files[i]) &&
            orl_year_add_text(&r->scene_read, &r->n_scene_read, parsed_scene->files[i]) < 0)
            return orl_year_no_memory(err);
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, parsed_scene->digest, ORL_SHA256_BYTES);
    orl_scene_digest_build(scene, &hash);
    if (y->overrides->material_overrides)
        orl_material_overrides_digest(y->overrides->material_overrides, &hash);
    if (y->overrides->window_groups)
        orl_sha256_add(&hash, &y->overrides->window_groups->n_groups,
                       sizeof y->overrides->window_groups->n_groups);
    orl_sha256_finish(&hash, y->digest);
    return 0;
}

static void warn_of_sensors(void *ctx, const char *text)
{
    orl_year_warn(ctx, "%s", text);
}

/* Warns of the sensors of a range that lie in the planes of surfaces. */
static void check_planes(struct orl_year *y, const struct orl_scene *scene,
                         const struct orl_sensor_range *range, size_t *n_warned)
{
    enum { MOST = 20 };
    char text[480];
    if (!orl_run_describe_sensors_in_planes(scene, y->request->sensors + range->first, range->count,
                                            y->env->run->pool, text, sizeof text))
        return;
    const size_t before = (*n_warned)++;
    if (before < MOST)
        orl_year_warn(y, "%s%.100s%s%s", range->name ? "grid '" : "",
                      range->name ? range->name : "", range->name ? "': " : "", text);
    else if (before == MOST)
        orl_year_warn(y, "more grids have sensors in planes of surfaces: they are not listed");
}

/* Checks sensors grid by grid; without grids, all at once. */
static int check_ranges(struct orl_year *y, const struct orl_scene *scene)
{
    const struct orl_annual_request *r = y->request;
    const size_t n = r->n_grids > 0 ? r->n_grids : 1;
    size_t n_in_planes = 0;
    struct orl_sensor_range *const ranges = malloc(n * sizeof *ranges);
    if (!ranges)
        return ORL_ERR_NOMEM;
    ranges[0] = (struct orl_sensor_range){NULL, 0, r->n_sensors};
    for (size_t i = 0; i < r->n_grids; i++)
        ranges[i] =
            (struct orl_sensor_range){r->grids[i].name, r->grids[i].first, r->grids[i].count};
    for (size_t i = 0; i < n; i++)
        check_planes(y, scene, &ranges[i], &n_in_planes);
    struct orl_sensor_check check = {.scene = scene,
                                     .sensors = r->sensors,
                                     .ranges = ranges,
                                     .n_ranges = n,
                                     .pool = y->env->run->pool,
                                     .warn = warn_of_sensors,
                                     .ctx = y};
    const int code = orl_run_check_sensor_spaces(&check);
    free(ranges);
    return code;
}

/* Warns, once per job, of sensors in planes of surfaces, and of sensors apart from their grid. */
static int check_sensors(struct orl_year *y, const struct orl_scene *scene, struct orl_error *err)
{
    if (y->overrides->sensors_checked)
        return 0;
    const int code = check_ranges(y, scene);
    if (code < 0)
        orl_error_set(err, code, "%s while checking the sensors",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    return code;
}

/* Loads the scene and its lamps, like a job without a sky. */
static int load_scene(struct orl_year *y, struct orl_error *err)
{
    struct orl_job job;
    struct orl_result result = {0};
    struct orl_run_env env = *y->env->run;
    struct orl_progress progress = {0};
    orl_job_init(&job);
    job.scene_files = y->request->scene_files;
    job.n_scene_files = y->request->n_scene_files;
    job.seed = y->request->seed;
    env.progress = NULL;
    struct orl_run_state state = {
        .job = &job, .env = &env, .result = &result, .progress = &progress};
    state.sensors = y->request->sensors;
    state.n_sensors = y->request->n_sensors;
    state.material_overrides = y->overrides->material_overrides;
    state.clock.stage_started = state.clock.started_s = orl_year_now(y);
    int code = orl_run_load_scene(&state, err);
    y->lights = state.lights;
    if (code == 0)
        code = check_no_sources(&state.scene->parsed_scene, err);
    if (code == 0)
        code = name_scene(y, state.scene, err);
    orl_health_add(&y->result->health, &result.health);
    y->result->warnings = result.warnings;
    y->result->n_warnings = result.n_warnings;
    result.warnings = NULL;
    result.n_warnings = 0;
    orl_result_done(&result);
    if (code == 0)
        code = check_sensors(y, state.scene, err);
    orl_scene_release(state.scene);
    return code;
}

/* ---- Skies ----------------------------------------------------------------------------------- */

/* Places the nodes for all suns of the file, also where none was measured. */
static int place_nodes(struct orl_year *y)
{
    const struct orl_year_suns *suns = &y->hours.suns;
    const struct orl_sky_rotation north = orl_sky_rotation_by_north(y->request->north_deg);
    const double share = 1.0 / (1U << y->request->sun_halvings);
    struct orl_sun_spacing steps = orl_sun_spacing_at(y->result->site.latitude_deg, spacing);
    steps.declination_deg *= share;
    steps.hour_angle_deg *= share;
    const int code = orl_sun_grid_init(&y->nodes, y->result->site.latitude_deg, suns->in_sky,
                                       suns->count, steps);
    y->node_frames = orl_arrays_new(&y->arrays, y->nodes.count, sizeof *y->node_frames);
    if (code < 0 || !y->node_frames)
        return ORL_ERR_NOMEM;
    for (size_t k = 0; k < y->nodes.count; k++)
        y->node_frames[k] = orl_frame_about(orl_sky_rotation_to_scene(north, y->nodes.at[k]));
    return 0;
}

static int prepare_year(struct orl_year *y, struct orl_error *err)
{
    double since = orl_year_now(y);
    int code = load_scene(y, err);
    orl_year_add_timing(y, ORL_ANNUAL_LOAD, &since);
    orl_bins_init(&y->bins);
    orl_year_report_progress(y, ORL_STAGE_MAPS, 0);
    if (code == 0)
        code = y->overrides->hours_of ? orl_year_borrow_hours(y, y->overrides->hours_of, err)
                                      : orl_year_read_hours(y, err);
    if (code < 0)
        return code;
    if (place_nodes(y) < 0)
        return orl_year_no_memory(err);
    orl_annual_cache_init(&y->cache, y);
    for (size_t i = 0; y->cache.store && i < y->hours.suns.count; i++)
        y->hours.suns.at[i].wanted = true; /* later jobs may have sunlight there */
    code = orl_year_find_sun_weights(y, err);
    if (code < 0)
        return code;
    y->result->n_nodes = y->nodes.count;
    orl_year_move_hours(y);
    orl_year_add_timing(y, ORL_ANNUAL_SKIES, &since);
    return 0;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int run_year(struct orl_year *y, struct orl_error *err)
{
    int code = prepare_year(y, err);
    if (code == 0 && y->overrides->prepared)
        code = y->overrides->prepared(y->overrides->ctx, y, err);
    if (code == 0)
        code = orl_year_run_chunks(y, err);
    if (code == 0)
        orl_annual_cache_report(&y->cache);
    return code;
}

static void free_year(struct orl_year *y)
{
    orl_year_inputs_done(y);
    orl_lights_release(y->lights);
    if (y->overrides->hours_of) /* the rest is borrowed */
        y->hours =
            (struct orl_hours){.steps = y->hours.steps, .step_of_column = y->hours.step_of_column};
    orl_hours_done(&y->hours);
    orl_sun_grid_done(&y->nodes);
    orl_arrays_free(&y->arrays);
    free(y);
}

int orl_year_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                 const struct orl_year_overrides *overrides, struct orl_annual_result *ret_result,
                 struct orl_error *err)
{
    static const struct orl_year_overrides no_overrides = {.sun_only = false};
    const uint32_t samples = request->samples > 0 ? request->samples : ORL_ANNUAL_SAMPLES;
    const uint32_t of_batch = (samples + ORL_ANNUAL_BATCHES - 1) / ORL_ANNUAL_BATCHES;
    struct orl_annual_result result = {.seed = request->seed,
                                       .threads = orl_thread_pool_size(env->run->pool),
                                       .samples = of_batch * ORL_ANNUAL_BATCHES,
                                       .n_sensors = request->n_sensors};
    struct orl_year *y = calloc(1, sizeof *y);
    if (!y)
        return orl_year_no_memory(err);
    y->overrides = overrides ? overrides : &no_overrides;
    y->request = request;
    y->env = env;
    y->result = &result;
    y->batch_samples = of_batch;
    y->n_window_groups = 1;
    if (y->overrides->window_groups)
        y->n_window_groups += (uint32_t)y->overrides->window_groups->n_groups;
    y->started_s = orl_year_now(y);
    orl_year_report_progress(y, ORL_STAGE_LOAD, 0);
    orl_thread_pool_set_cancel(env->run->pool, env->run->cancel);
    const int code = run_year(y, err);
    orl_thread_pool_set_cancel(env->run->pool, NULL);
    result.total_s = orl_year_now(y) - y->started_s;
    free_year(y);
    if (code < 0) {
        orl_annual_done(&result);
        return code;
    }
    *ret_result = result;
    return 0;
}
