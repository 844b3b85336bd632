/* A year from its request to its rows: load -> skies -> paths, sun and hours, block by block. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "annual/panels.h"
#include "annual/product.h"
#include "annual/scope.h"
#include "annual/sunlight.h"
#include "annual/trace.h"
#include "run/scene.h"
#include "scene/geometry/stand.h"

enum { BLOCK = 64 }; /* sensors at a time */
/* What panels send where changes with the sun as their directions' cells do: they take more nodes.
 */
static const struct orl_sun_spacing usual_spacing = {6, 15}, panel_spacing = {4, 7.5};

struct year {
    const struct orl_annual_request *request;
    const struct orl_annual_env *env;
    struct orl_annual_result *result;
    struct orl_bins bins;
    struct orl_hours hours;
    struct orl_sun_nodes nodes;
    struct orl_frame *node_frames; /* as the scene has them */
    struct orl_sun_terms terms;
    size_t n_sun; /* nodes and beams */
    struct orl_lights *lights;
    struct orl_world *world;
    struct orl_annual_scene scene;
    struct orl_panels panels;
    uint32_t batch_samples;
    /* Of the sensors of a block: */
    size_t first, count;
    struct orl_place places[BLOCK];
    float *bin_sums;                    /* [sensor][batch][bin] */
    double *sun_sums;                   /* [sensor][batch][nodes, beams] */
    float *rows;                        /* [sensor][of each][column] */
    struct orl_annual_factors *factors; /* by sensor */
    double *sun_by_batch;               /* of those */
    struct orl_health *healths;         /* by member */
};

enum row { ROW_TOTAL, ROW_STRAIGHT, ROW_SE, ROW_MIRRORED, ROW_SQUARES, ROWS };

/* ---- What all stages need -------------------------------------------------------------------- */

static void warn(struct year *y, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void warn(struct year *y, const char *format, ...)
{
    struct orl_annual_result *r = y->result;
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (y->env->run->warned)
        y->env->run->warned(y->env->run->ctx, text);
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    if (!grown)
        return;
    r->warnings = grown;
    grown[r->n_warnings] = strdup(text);
    r->n_warnings += grown[r->n_warnings] != NULL;
}

static double now(const struct year *y)
{
    return y->env->run->now_s(y->env->run->ctx);
}

/* Books what has passed since *since, which becomes now. */
static void book(struct year *y, enum orl_annual_stage stage, double *since)
{
    const double t = now(y);
    y->result->timings_s[stage] += t - *since;
    *since = t;
}

static int out_of_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a year");
}

static int cancelled(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
}

/* ---- Load ------------------------------------------------------------------------------------ */

/* The scene and the lamps in it, as a job of no sky loads them. */
static int load_scene(struct year *y, struct orl_error *err)
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
    state.stage_started = state.started_s = now(y);
    int code = orl_run_load(&state, err);
    y->lights = state.lights;
    if (code == 0)
        code = orl_lights_admit(&state.scene->description, err);
    orl_scene_release(state.scene);
    orl_health_add(&y->result->health, &result.health);
    y->result->warnings = result.warnings;
    y->result->n_warnings = result.n_warnings;
    result.warnings = NULL;
    result.n_warnings = 0;
    orl_result_done(&result);
    return code;
}

static int make_world(struct year *y, struct orl_error *err)
{
    int code = load_scene(y, err);
    if (code == 0)
        code = orl_world_new(y->lights, &y->world, err);
    if (code == 0)
        code = orl_annual_admit(y->world, err);
    if (code < 0 || !y->world)
        return code;
    if (y->world->n_emitters > 0)
        warn(y, "the scene's lamps are left out: a year of daylight has no lamps on");
    y->world->n_emitters = 0;
    return 0;
}

/* ---- Skies ----------------------------------------------------------------------------------- */

static int read_hours(struct year *y, struct orl_error *err)
{
    const struct orl_annual_request *request = y->request;
    const struct orl_files *files = y->env->run->files;
    struct orl_weather weather = {0};
    struct orl_file file;
    int code = files->open(files->ctx, request->weather_file, &file, err);
    if (code < 0)
        return code;
    code = orl_weather_parse(request->weather_file, file.data, file.size, &weather, err);
    files->close(files->ctx, &file);
    if (code < 0)
        return code;
    y->result->latitude_deg = weather.latitude_deg;
    y->result->longitude_deg = weather.longitude_deg;
    y->result->time_zone_h = weather.time_zone_h;
    code = orl_hours_init(&y->hours, &y->bins, &weather, request->weather_file, request->north_deg,
                          request->ground_reflectance, y->env->run->crew, err);
    orl_weather_done(&weather);
    if (code < 0)
        return code;
    if (y->hours.n_missing > 0)
        warn(y, "%zu hours of the weather file were not measured: they have no value",
             y->hours.n_missing);
    if (y->hours.n_warned > 0)
        warn(y, "at %zu hours with light the sky's model says, first: %s", y->hours.n_warned,
             y->hours.warning);
    return 0;
}

/* Nodes of the columns that have a sun. */
static int place_nodes(struct year *y)
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
    const int code = orl_sun_nodes_init(
        &y->nodes, y->result->latitude_deg, suns, n,
        orl_sun_spacing_at(y->result->latitude_deg,
                           orl_annual_has_panels(y->world) ? panel_spacing : usual_spacing));
    free(suns);
    y->node_frames = malloc((y->nodes.count + 1) * sizeof *y->node_frames);
    if (code < 0 || !y->node_frames)
        return ORL_ERR_NOMEM;
    for (size_t k = 0; k < y->nodes.count; k++)
        y->node_frames[k] = orl_frame_about(orl_turn_to_scene(north, y->nodes.at[k]));
    return 0;
}

static int prepare(struct year *y, struct orl_error *err)
{
    double since = now(y);
    int code = make_world(y, err);
    book(y, ORL_ANNUAL_LOAD, &since);
    orl_bins_init(&y->bins);
    if (code == 0)
        code = read_hours(y, err);
    if (code < 0)
        return code;
    if (place_nodes(y) < 0)
        return out_of_memory(err);
    if (orl_annual_scene_init(&y->scene, y->world, &y->bins, orl_turn_by(y->request->north_deg),
                              y->node_frames, y->nodes.count, y->request->seed,
                              y->env->run->crew) < 0)
        return orl_crew_cancelled(y->env->run->crew) ? cancelled(err) : out_of_memory(err);
    y->n_sun = y->nodes.count + (y->scene.map ? orl_sun_map_beams(y->scene.map)->count : 0);
    code = orl_sun_terms_init(&y->terms, &y->hours, &y->nodes, y->node_frames, y->scene.map,
                              y->env->run->crew);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? cancelled(err) : out_of_memory(err);
    code = orl_panels_init(&y->panels, y->world, &y->hours, &y->scene.sobol, y->request->seed,
                           y->env->run->crew);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code,
                             "more than %d kinds of BSDF panes, by material and "
                             "direction, are too many for a year",
                             ORL_PANEL_MOST_KINDS);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? cancelled(err) : out_of_memory(err);
    y->result->n_columns = y->hours.n_columns;
    y->result->n_steps = y->hours.n_steps;
    y->result->steps = y->hours.steps;
    y->result->step_of_column = y->hours.step_of_column;
    y->result->n_nodes = y->nodes.count;
    y->hours.steps = NULL;
    y->hours.step_of_column = NULL;
    book(y, ORL_ANNUAL_SKIES, &since);
    return 0;
}

/* ---- Blocks ---------------------------------------------------------------------------------- */

static float *row_of(const struct year *y, size_t sensor, enum row row)
{
    return y->rows + (sensor * ROWS + row) * y->hours.n_columns;
}

static void trace_batch(void *arg, size_t index, uint32_t member)
{
    struct year *y = arg;
    const size_t sensor = index / ORL_ANNUAL_BATCHES;
    const struct orl_annual_batch batch = {.seed = y->request->seed,
                                           .sensor = y->first + sensor,
                                           .batch = (uint32_t)(index % ORL_ANNUAL_BATCHES),
                                           .samples = y->batch_samples};
    struct orl_annual_sums sums = {.bins = y->bin_sums + index * ORL_BINS,
                                   .nodes = y->sun_sums + index * y->n_sun,
                                   .beams = y->sun_sums + index * y->n_sun + y->nodes.count};
    memset(sums.bins, 0, ORL_BINS * sizeof *sums.bins);
    memset(sums.nodes, 0, y->n_sun * sizeof *sums.nodes);
    orl_annual_trace(&y->scene, &y->places[sensor], &batch, &sums, &y->healths[member]);
}

static void find_sun(void *arg, size_t index, uint32_t member)
{
    struct year *y = arg;
    const struct orl_sunlit_hours sun = {row_of(y, index, ROW_STRAIGHT),
                                         row_of(y, index, ROW_MIRRORED),
                                         row_of(y, index, ROW_SQUARES)};
    const uint64_t name = y->request->seed + y->first + index;
    (void)member;
    orl_sunlit_hours_find(&y->scene, &y->hours, &y->places[index], name, &sun);
    orl_panels_add(&y->panels, &y->places[index], name, sun.mirrored, sun.squares);
}

static void fill_factors(void *arg, size_t index, uint32_t member)
{
    struct year *y = arg;
    const size_t batch = index * ORL_ANNUAL_BATCHES;
    const struct orl_annual_coefficients coefficients = {y->bin_sums + batch * ORL_BINS,
                                                         y->sun_sums + batch * y->n_sun, y->n_sun};
    (void)member;
    orl_annual_factors_fill(&y->factors[index], &y->bins, &coefficients,
                            y->sun_by_batch + batch * y->n_sun);
}

static void multiply(void *arg, size_t tile, uint32_t member)
{
    struct year *y = arg;
    (void)member;
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_annual_row row = {row_of(y, i, ROW_STRAIGHT), row_of(y, i, ROW_MIRRORED),
                                           row_of(y, i, ROW_SQUARES), row_of(y, i, ROW_TOTAL),
                                           row_of(y, i, ROW_SE)};
        orl_annual_multiply(&y->factors[i], &y->hours, &y->terms, tile, &row);
    }
}

static void place_sensors(struct year *y)
{
    for (size_t i = 0; i < y->count; i++) {
        const struct orl_sensor *sensor = &y->request->sensors[y->first + i];
        const struct orl_vec3 normal = orl_normalize(sensor->direction);
        const struct orl_vec3 at = orl_sub(sensor->position, y->world->geometry->center);
        struct orl_place *place = &y->places[i];
        *place = (struct orl_place){.point = orl_stand(y->world->geometry, at, normal),
                                    .normal = normal};
        place->outside = orl_world_is_outside(y->world, place->point);
    }
}

static int hand_over(struct year *y, struct orl_error *err)
{
    const size_t columns = y->hours.n_columns, bytes = columns * sizeof(float);
    for (size_t i = 0; i < y->count; i++) {
        const size_t sensor = y->first + i;
        const float *total = row_of(y, i, ROW_TOTAL), *direct = row_of(y, i, ROW_STRAIGHT);
        const float *se = row_of(y, i, ROW_SE);
        if (y->env->row) {
            const int code = y->env->row(y->env->ctx, sensor, total, direct, se, err);
            if (code < 0)
                return code;
            continue;
        }
        memcpy(y->result->total + sensor * columns, total, bytes);
        memcpy(y->result->direct + sensor * columns, direct, bytes);
        memcpy(y->result->se + sensor * columns, se, bytes);
    }
    return 0;
}

static int run_block(struct year *y, struct orl_error *err)
{
    struct orl_crew *crew = y->env->run->crew;
    double since = now(y);
    place_sensors(y);
    int code = orl_crew_try(crew, y->count * ORL_ANNUAL_BATCHES, trace_batch, y);
    book(y, ORL_ANNUAL_PATHS, &since);
    if (code == 0)
        code = orl_crew_try(crew, y->count, find_sun, y);
    book(y, ORL_ANNUAL_SUN, &since);
    if (code == 0)
        code = orl_crew_try(crew, y->count, fill_factors, y);
    if (code == 0)
        code = orl_crew_try(crew, y->hours.n_tiles, multiply, y);
    if (code < 0)
        return code == ORL_ERR_CANCELLED ? cancelled(err) : out_of_memory(err);
    code = hand_over(y, err);
    book(y, ORL_ANNUAL_HOURS, &since);
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int make_room(struct year *y)
{
    const size_t columns = y->hours.n_columns, n = y->request->n_sensors;
    const size_t batches = (n < BLOCK ? n : BLOCK) * ORL_ANNUAL_BATCHES;
    struct orl_annual_result *r = y->result;
    y->bin_sums = malloc(batches * ORL_BINS * sizeof *y->bin_sums);
    y->sun_sums = malloc((batches * y->n_sun + 1) * sizeof *y->sun_sums);
    y->rows = malloc(((size_t)BLOCK * ROWS * columns + 1) * sizeof *y->rows);
    y->factors = malloc(BLOCK * sizeof *y->factors);
    y->sun_by_batch = malloc((batches * y->n_sun + 1) * sizeof *y->sun_by_batch);
    y->healths = calloc(orl_crew_size(y->env->run->crew), sizeof *y->healths);
    if (!y->bin_sums || !y->sun_sums || !y->factors || !y->sun_by_batch || !y->rows || !y->healths)
        return ORL_ERR_NOMEM;
    if (y->env->row)
        return 0;
    r->total = malloc((n * columns + 1) * sizeof *r->total);
    r->direct = malloc((n * columns + 1) * sizeof *r->direct);
    r->se = malloc((n * columns + 1) * sizeof *r->se);
    return r->total && r->direct && r->se ? 0 : ORL_ERR_NOMEM;
}

static int run_year(struct year *y, struct orl_error *err)
{
    const struct orl_run_env *run = y->env->run;
    const size_t n = y->request->n_sensors;
    int code = prepare(y, err);
    if (code == 0 && make_room(y) < 0)
        code = out_of_memory(err);
    if (code == 0 && y->env->begins)
        code = y->env->begins(y->env->ctx, y->result, err);
    for (y->first = 0; y->first < n && code == 0; y->first += y->count) {
        if (run->progress)
            run->progress(run->ctx, ORL_STAGE_RENDER, (double)y->first / (double)n,
                          (double)y->first / (double)n);
        y->count = n - y->first < BLOCK ? n - y->first : BLOCK;
        code = run_block(y, err);
    }
    for (uint32_t i = 0; y->healths && i < orl_crew_size(run->crew); i++)
        orl_health_add(&y->result->health, &y->healths[i]);
    return code;
}

static void let_go(struct year *y)
{
    orl_panels_done(&y->panels);
    orl_annual_scene_done(&y->scene);
    orl_world_free(y->world);
    orl_lights_release(y->lights);
    orl_hours_done(&y->hours);
    orl_sun_nodes_done(&y->nodes);
    free(y->node_frames);
    orl_sun_terms_done(&y->terms);
    free(y->bin_sums);
    free(y->sun_sums);
    free(y->factors);
    free(y->sun_by_batch);
    free(y->rows);
    free(y->healths);
    free(y);
}

int orl_annual_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                   struct orl_annual_result *ret_result, struct orl_error *err)
{
    const uint32_t samples = request->samples > 0 ? request->samples : ORL_ANNUAL_SAMPLES;
    const uint32_t of_batch = (samples + ORL_ANNUAL_BATCHES - 1) / ORL_ANNUAL_BATCHES;
    struct orl_annual_result result = {.seed = request->seed,
                                       .threads = orl_crew_size(env->run->crew),
                                       .samples = of_batch * ORL_ANNUAL_BATCHES,
                                       .n_sensors = request->n_sensors};
    int code = orl_annual_validate(request, err);
    if (code < 0)
        return code;
    struct year *y = calloc(1, sizeof *y);
    if (!y)
        return out_of_memory(err);
    y->request = request;
    y->env = env;
    y->result = &result;
    y->batch_samples = of_batch;
    const double started = now(y);
    orl_crew_heed(env->run->crew, env->run->cancel);
    code = run_year(y, err);
    orl_crew_heed(env->run->crew, NULL);
    result.total_s = now(y) - started;
    let_go(y);
    if (code < 0) {
        orl_annual_done(&result);
        return code;
    }
    if (env->run->progress)
        env->run->progress(env->run->ctx, ORL_STAGE_RENDER, 1, 1);
    *ret_result = result;
    return 0;
}
