/* Rendering from photon maps, with any estimator of indirect light. */
#include "render/technique/photon_maps.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "render/gather/direction_sampling.h"

/* Seed salt: keeps these random streams distinct from those of maps. */
static const uint64_t sensor_flux_salt = 0x616972;

struct photon_maps {
    const struct orl_indirect_estimator *indirect;
    const struct orl_lit_scene *lit_scene;   /* borrowed */
    const struct orl_technique_input *input; /* borrowed, from prepare to finish */
    struct orl_gather gather;
    struct orl_direction_sampler sampler; /* for the sensors' rays */
    struct orl_sensor_flux *sensor_flux;  /* NULL: nothing redirects light into mid-air */
};

static int create(const struct orl_technique_definition *definition,
                  const struct orl_lit_scene *lit_scene, struct orl_thread_pool *pool,
                  void **ret_technique, struct orl_error *err)
{
    (void)pool;
    struct photon_maps *p = calloc(1, sizeof *p);
    *ret_technique = p;
    if (!p)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    p->indirect = definition->indirect;
    p->lit_scene = lit_scene;
    return 0;
}

static void destroy(void *technique)
{
    free(technique);
}

/* ---- Data derived from maps, and their cache ------------------------------------------------- */

/*
 * Makes the memory cache key; maps' keys include all that the data depend on: the scene, and the
 * simulation. Returns false if the memory cache is not used: maps of rounds are read once, with
 * their own bandwidths.
 */
static bool cache_key_text(const struct photon_maps *p, char ret_key[ORL_MEMORY_CACHE_KEY])
{
    const struct orl_technique_input *input = p->input;
    const enum orl_map_kind first = p->indirect->map;
    snprintf(ret_key, ORL_MEMORY_CACHE_KEY, "gather %s %s %s", p->indirect->name,
             input->maps[first] ? input->map_keys[first] : "none",
             input->maps[ORL_MAP_CAUSTIC] ? input->map_keys[ORL_MAP_CAUSTIC] : "none");
    return input->memory_cache && !input->bandwidths && input->maps[first];
}

static void free_gather(void *cached)
{
    orl_gather_done(cached);
    free(cached);
}

/* Takes the data of an earlier job from the memory cache, or computes them. */
static int load_or_make_gather(struct photon_maps *p)
{
    const struct orl_technique_input *input = p->input;
    char key[ORL_MEMORY_CACHE_KEY];
    int code = 0;
    struct orl_gather *cached =
        cache_key_text(p, key) ? orl_memory_cache_take(input->memory_cache, key) : NULL;
    if (cached) {
        p->gather = *cached;
        free(cached);
        orl_gather_attach(&p->gather, p->lit_scene, input->maps, input->seed);
        if (p->gather.leaf_irradiance)
            input->report_map_read(input->ctx,
                                   orl_leaf_irradiance_filled(p->gather.leaf_irradiance));
    } else {
        code = orl_gather_init(&p->gather, p->lit_scene, p->indirect, input->maps,
                               input->bandwidths, input->seed, input->pool, &input->searches[0]);
    }
    if (code == 0 && input->n_views > 0)
        code = orl_gather_for_views(&p->gather, input->pool);
    return code;
}

static void cache_gather(struct photon_maps *p)
{
    char key[ORL_MEMORY_CACHE_KEY];
    struct orl_gather *cached = cache_key_text(p, key) ? malloc(sizeof *cached) : NULL;
    if (!cached) {
        orl_gather_done(&p->gather);
        return;
    }
    const uint64_t bytes = orl_gather_detach(&p->gather);
    *cached = p->gather;
    orl_memory_cache_put(p->input->memory_cache, key, cached, bytes, free_gather);
}

/* Frees the sensors' data. */
static void free_sensor_data(struct photon_maps *p)
{
    orl_sensor_flux_free(p->sensor_flux);
    p->sensor_flux = NULL;
    orl_direction_sampler_done(&p->sampler);
    p->sampler = (struct orl_direction_sampler){.lit_scene = NULL};
}

/* Makes the sensors' data: discs for flux in mid-air, and importance sampling of rays. */
static int make_sensor_data(struct photon_maps *p)
{
    const size_t n = p->input->n_sensors;
    int code = orl_sensor_flux_new(&p->gather, n, &p->sensor_flux);
    if (code < 0 || n == 0)
        return code;
    code = orl_direction_sampler_init(&p->sampler, p->lit_scene, &p->gather.sobol, p->input->pool);
    p->gather.importance_sampled = true;
    p->gather.sampler = &p->sampler;
    return code;
}

static int prepare_maps(void *technique, const struct orl_technique_input *input,
                        struct orl_error *err)
{
    struct photon_maps *p = technique;
    p->input = input;
    int code = load_or_make_gather(p);
    if (code == 0)
        code = make_sensor_data(p);
    if (code < 0) {
        free_sensor_data(p);
        orl_gather_done(&p->gather);
        return orl_error_set(err, code, "%s for the final gather",
                             code == ORL_ERR_CANCELLED ? "cancelled while preparing maps"
                                                       : "out of memory");
    }
    p->gather.cancel = input->cancel;
    return 0;
}

static void finish_maps(void *technique)
{
    struct photon_maps *p = technique;
    free_sensor_data(p);
    cache_gather(p);
    p->input = NULL;
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static struct orl_shading_point place_of(const struct photon_maps *p,
                                         const struct orl_sensor_query *query,
                                         struct orl_surface_point *ret_surface_point)
{
    return orl_gather_sensor_point(&p->gather, query->position, query->normal, ret_surface_point);
}

static void compute_sensor(void *technique, const struct orl_sensor_query *query,
                           struct orl_sensor_estimate *ret_found,
                           struct orl_rgb ret_batches[ORL_MAP_BATCHES])
{
    const struct photon_maps *p = technique;
    struct orl_surface_point surface_point;
    struct orl_shading_point place = place_of(p, query, &surface_point);
    const struct orl_estimate e = orl_gather_sensor(&p->gather, &place, &surface_point,
                                                    query->samples, query->index, query->search);
    (void)ret_batches; /* only of paths */
    if (p->sensor_flux)
        orl_sensor_flux_set_sensor(p->sensor_flux, query->index, &place, &e);
    *ret_found = (struct orl_sensor_estimate){e, place.in_free_space};
}

static void load_sensor(void *technique, const struct orl_sensor_query *query,
                        const struct orl_sensor_estimate *found)
{
    const struct photon_maps *p = technique;
    struct orl_surface_point surface_point;
    if (!p->sensor_flux)
        return;
    struct orl_shading_point place = place_of(p, query, &surface_point);
    place.in_free_space = found->in_free_space;
    orl_sensor_flux_set_sensor(p->sensor_flux, query->index, &place, &found->estimate);
}

/* Adds caustics at sensors in mid-air, from photons traced for them. */
static int finish_sensors(void *technique, struct orl_error *err)
{
    struct photon_maps *p = technique;
    const struct orl_technique_input *input = p->input;
    const struct orl_emission *emission = NULL;
    if (!orl_sensor_flux_is_needed(p->sensor_flux))
        return 0;
    int code = input->get_emission(input->ctx, &emission, err);
    if (code < 0)
        return code;
    const struct orl_shoot_env env = {.emission = emission,
                                      .seed = orl_mix64(input->seed ^ sensor_flux_salt),
                                      .pool = input->pool,
                                      .cancel = input->cancel};
    code = orl_sensor_flux_collect(p->sensor_flux, &env, &input->sensor_photons, input->health);
    if (code < 0)
        return orl_error_set(err, code, "%s",
                             code == ORL_ERR_CANCELLED ? "cancelled while computing sensors"
                                                       : "out of memory for sensors in mid-air");
    for (size_t i = 0; i < input->n_sensors; i++) {
        const struct orl_estimate e = orl_sensor_flux_estimate(p->sensor_flux, i);
        input->replace_sensor(input->ctx, i, &e);
    }
    return 0;
}

/* ---- Views ----------------------------------------------------------------------------------- */

static int paint_view(void *technique, const struct orl_painting *painting, struct orl_error *err)
{
    const struct photon_maps *p = technique;
    return orl_image_render(&p->gather, painting, err);
}

const struct orl_technique_methods orl_photon_map_methods = {.create = create,
                                                             .prepare = prepare_maps,
                                                             .compute_sensor = compute_sensor,
                                                             .load_sensor = load_sensor,
                                                             .finish_sensors = finish_sensors,
                                                             .paint_view = paint_view,
                                                             .finish = finish_maps,
                                                             .destroy = destroy};
