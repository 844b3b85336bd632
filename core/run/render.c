#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/image.h"
#include "run/stages.h"

struct sensor_work {
    const struct orl_run_state *state;
    const struct orl_gather *gather;
    size_t first, count;
};

static void compute_sensor(void *arg, size_t index, uint32_t member)
{
    const struct sensor_work *work = arg;
    const struct orl_run_state *state = work->state;
    const size_t i = work->first + index;
    const uint32_t samples =
        state->job->gather_samples ? state->job->gather_samples : ORL_DEFAULT_GATHER_SAMPLES;
    if (atomic_load_explicit(state->env->cancel, memory_order_relaxed))
        return;
    state->result->illuminance_lx[i] = orl_gather_sensor(
        work->gather, orl_sub(state->sensors[i].position, state->world->geometry->center),
        orl_normalize(state->sensors[i].direction), samples, i, &state->searches[member]);
}

/* The sun behind a dielectric comes as caustic photons, which only surfaces catch. */
static void warn_of_dielectrics(struct orl_run_state *state)
{
    const struct orl_world *world = state->world;
    for (size_t i = 0; world->n_suns > 0 && i < world->geometry->n_facets; i++) {
        const uint32_t material = world->geometry->facets[i].material;
        if (world->description.materials[material].kind != ORL_MATERIAL_DIELECTRIC)
            continue;
        orl_run_warn(state,
                     "the sun through dielectrics (material '%s') reaches sensors that lie on "
                     "surfaces, but not those in mid-air",
                     world->description.materials[material].name);
        return;
    }
}

/* Rounds of a few hundred sensors, so that progress and cancelling are heard in between. */
static int render_sensors(struct orl_run_state *state, const struct orl_gather *gather,
                          double share, struct orl_error *err)
{
    enum { ROUND = 128 };
    const size_t n = state->n_sensors;
    if (n == 0)
        return 0;
    state->result->illuminance_lx = calloc(n, sizeof *state->result->illuminance_lx);
    if (!state->result->illuminance_lx)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    state->result->n_sensors = n;
    warn_of_dielectrics(state);
    for (size_t first = 0; first < n; first += ROUND) {
        struct sensor_work work = {state, gather, first, n - first < ROUND ? n - first : ROUND};
        orl_crew_for(state->env->crew, work.count, compute_sensor, &work);
        if (atomic_load(state->env->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while computing sensors");
        orl_run_progress(state, share * (double)(first + work.count) / (double)n);
    }
    return 0;
}

/* Where one view stands among all that is rendered. */
struct view_progress {
    const struct orl_run_state *state;
    double before, share;
};

static void view_progress(void *ctx, double fraction)
{
    const struct view_progress *progress = ctx;
    orl_run_progress(progress->state, progress->before + progress->share * fraction);
}

static int write_view(const struct orl_run_state *state, const struct orl_film *film,
                      const struct orl_view *view, const struct orl_view_result *result,
                      struct orl_error *err)
{
    char path[4096];
    const char *folder = state->env->output_folder;
    int length = snprintf(path, sizeof path, "%s/%s", folder, result->hdr);
    if (length < 0 || (size_t)length >= sizeof path)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
    int code = orl_film_write_hdr(film, view, path, err);
    if (code == 0) {
        snprintf(path, sizeof path, "%s/%s", folder, result->png);
        code = orl_film_write_png(film, path, err);
    }
    return code;
}

static int name_view(struct orl_view_result *result, const char *name, struct orl_error *err)
{
    const size_t size = strlen(name) + 5;
    result->name = strdup(name);
    result->hdr = malloc(size);
    result->png = malloc(size);
    if (!result->name || !result->hdr || !result->png)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    snprintf(result->hdr, size, "%s.hdr", name);
    snprintf(result->png, size, "%s.png", name);
    return 0;
}

static int render_view(struct orl_run_state *state, const struct orl_gather *gather, size_t index,
                       struct view_progress *progress, struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view_result *result = &state->result->views[index];
    const struct orl_image_env env = {.gather = gather,
                                      .crew = state->env->crew,
                                      .searches = state->searches,
                                      .cancel = state->env->cancel,
                                      .index = index,
                                      .progress = view_progress,
                                      .ctx = progress};
    const double started = state->env->now_s(state->env->ctx);
    struct orl_film film = {0};
    struct orl_view view;
    state->result->n_views = index + 1;
    int code = name_view(result, request->name, err);
    if (code == 0)
        code = orl_view_parse(request->view, &view, err);
    if (code == 0)
        orl_run_judge_view(state, request->name, &view);
    if (code == 0)
        code = orl_film_init(&film, request->width, request->height, err);
    if (code == 0)
        code = orl_image_render(&env, &view, &film, err);
    if (code == 0)
        code = write_view(state, &film, &view, result, err);
    orl_film_done(&film);
    result->seconds = state->env->now_s(state->env->ctx) - started;
    return code;
}

static int render_views(struct orl_run_state *state, const struct orl_gather *gather, double before,
                        struct orl_error *err)
{
    const size_t n = state->job->n_views;
    int code = 0;
    if (n == 0)
        return 0;
    state->result->views = calloc(n, sizeof *state->result->views);
    if (!state->result->views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < n && code == 0; i++) {
        struct view_progress progress = {state, before + (1 - before) * (double)i / (double)n,
                                         (1 - before) / (double)n};
        code = render_view(state, gather, i, &progress, err);
    }
    return code;
}

int orl_run_render(struct orl_run_state *state, struct orl_error *err)
{
    struct orl_gather gather;
    const struct orl_photon_map *maps[ORL_MAP_KINDS] = {state->maps[ORL_MAP_GLOBAL],
                                                        state->maps[ORL_MAP_CAUSTIC]};
    int code = orl_gather_init(&gather, state->world, maps, state->job->seed, &state->searches[0]);
    if (code < 0)
        return orl_error_set(err, code, "out of memory for the final gather");
    const double sensors_share = state->job->n_views == 0 ? 1 : state->n_sensors == 0 ? 0 : 0.2;
    code = render_sensors(state, &gather, sensors_share, err);
    if (code == 0)
        code = render_views(state, &gather, sensors_share, err);
    orl_gather_done(&gather);
    for (uint32_t i = 0; i < orl_crew_size(state->env->crew); i++)
        orl_health_add(&state->result->health, &state->searches[i].health);
    return code;
}
