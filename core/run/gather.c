/* A job by the techniques of photon maps: the maps, then sensors and views from them. */
#include "run/stages.h"

#include "render/image.h"

struct work {
    struct orl_run_state *state;
    struct orl_gather gather;
};

static void compute_sensor(void *ctx, size_t index, uint32_t member)
{
    const struct work *work = ctx;
    struct orl_run_state *state = work->state;
    const struct orl_sensor *sensor = &state->sensors[index];
    const uint32_t samples = orl_run_sensor_samples(state, index);
    const struct orl_estimate e = orl_gather_sensor(
        &work->gather, orl_sub(sensor->position, state->world->geometry->center),
        orl_normalize(sensor->direction), samples, index, &state->searches[member]);
    orl_run_book_sensor(state, index, &e);
}

static int render_view(void *ctx, const struct orl_painting *painting, struct orl_error *err)
{
    const struct work *work = ctx;
    return orl_image_render(&work->gather, painting, err);
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

static enum orl_rest rest_of(enum orl_technique technique)
{
    return technique == ORL_TECHNIQUE_DIRECT        ? ORL_REST_DENSITY
           : technique == ORL_TECHNIQUE_PRECOMPUTED ? ORL_REST_RECORDS
                                                    : ORL_REST_GATHERED;
}

int orl_run_gather(struct orl_run_state *state, struct orl_error *err)
{
    struct work work = {.state = state};
    const struct orl_renderer renderer = {
        .ctx = &work, .sensor = compute_sensor, .view = render_view};
    const struct orl_photon_map *maps[ORL_MAP_KINDS];
    const enum orl_rest rest = rest_of(state->result->plan.technique);
    int code = orl_run_is_dark(state) ? 0 : orl_run_maps(state, err);
    if (code < 0)
        return code;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        maps[kind] = state->maps[kind];
    code = orl_gather_init(&work.gather, state->world, rest, maps, state->bandwidths,
                           state->job->seed, &state->searches[0]);
    if (code == 0 && state->job->n_views > 0)
        code = orl_gather_for_views(&work.gather, state->env->crew);
    if (code < 0) {
        orl_gather_done(&work.gather);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the final gather");
    }
    if (state->n_sensors > 0)
        warn_of_dielectrics(state);
    code = orl_run_render(state, &renderer, err);
    orl_gather_done(&work.gather);
    return code;
}
