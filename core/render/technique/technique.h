/*
 * The techniques by which a job is rendered, and the interface that all of them have. A technique
 * estimates the irradiance of sensors and paints views. Each is one file of this folder, which
 * begins with its estimator, bias and variance, and one row of the table in technique.c:
 *   backward     backward_technique.c     unbiased paths from the sensor or the eye
 *   gather       gather_technique.c       final gather of the density of global photons
 *   direct       direct_technique.c       density of global photons at the place itself
 *   precomputed  precomputed_technique.c  irradiance precomputed at a fraction of the photons
 *
 * Facts are the properties by which the planner, the costs and the diagnostics distinguish
 * techniques; nothing outside this folder depends on a technique's name for them. A caller renders
 * by the methods, in this order:
 *   create         once for a lit scene;
 *   prepare        for each round of the job, after its photon maps are made;
 *   sensors        compute_sensor or load_sensor for each of them, then finish_sensors;
 *   paint_view     for each view;
 *   finish         at the end of the round, if prepare succeeded;
 *   destroy        after the last round.
 *
 * Conventions: positions are in the moved coordinates of scene/geometry/geometry.h; irradiance is
 * in W/m2. Ownership: the input is borrowed from prepare to finish. Threads: compute_sensor and
 * load_sensor may run in any thread of the pool, each sensor once; all others are for the thread
 * that leads the pool. Errors: 0, or a negative enum orl_err with *err set. Results depend on the
 * input alone, never on threads or on the memory cache.
 */
#ifndef ORL_RENDER_TECHNIQUE_TECHNIQUE_H
#define ORL_RENDER_TECHNIQUE_TECHNIQUE_H

#include <stdatomic.h>

#include <oriel/base/memory_cache.h>
#include <oriel/job/plan.h>

#include "base/statistics/estimate.h"
#include "photon/emission/emit.h"
#include "photon/shooting/shoot.h"
#include "render/gather/sensor_flux.h"
#include "render/image/image.h"

/* ---- Facts ----------------------------------------------------------------------------------- */

/* Places at which a technique estimates indirect light by a hemisphere of rays that read the map
 * of global photons or records. */
enum orl_final_gather {
    ORL_GATHER_NOWHERE,        /* no place inside, where photons are stored */
    ORL_GATHER_WHERE_DOUBTFUL, /* places in views at which the records read differ */
    ORL_GATHER_EVERYWHERE
};

struct orl_technique_facts {
    const char *name; /* in jobs and results */
    /* The technique that results are compared with, and with which doubtful sensors are rendered
     * again. */
    enum orl_technique alternative;
    /* True if a value is the mean of independent samples, which later rounds can add to: an error
     * goal sets the samples of each sensor and pixel. Otherwise it sets photons. */
    bool samples_paths;
    /* Use of the global photons: stored in maps, or as virtual point lights of this run alone. */
    enum orl_photon_use photons;
    bool reads_map[ORL_MAP_KINDS]; /* photon maps that rendering reads */
    enum orl_final_gather final_gather;
    /* True if sensors and views show what a map holds at the place itself. Its photons are then of
     * the light that no shadow ray and no caustic photon counts (omit.counted_light). */
    bool shows_map;
    /* True if a value may be a single density estimate, without a mean over rays or records. */
    bool shows_density;
};

/* Returns the facts of a technique. Those of ORL_TECHNIQUE_AUTO hold until a plan is made: photon
 * maps of unknown use. */
const struct orl_technique_facts *orl_technique_facts(enum orl_technique technique);

/* Returns true if the technique renders from photon maps. */
static inline bool orl_technique_reads_maps(enum orl_technique technique)
{
    return orl_technique_facts(technique)->photons == ORL_PHOTONS_FOR_MAPS;
}

/* ---- Input ----------------------------------------------------------------------------------- */

/* Input of a round. */
struct orl_technique_input {
    const struct orl_lit_scene *lit_scene;
    struct orl_thread_pool *pool;
    struct orl_search *searches; /* one for each thread of the pool; they count into their health */
    atomic_bool *cancel;
    uint64_t seed; /* of all random numbers, other than those of continued samples */
    size_t n_sensors, n_views;
    uint32_t pixel_samples; /* paths: samples of a pixel */
    bool sums_of_pixels;    /* views serve sums over many pixels, such as glare */

    /* Photon maps; NULL: there are no photons of that kind. A map's key names its contents. */
    const struct orl_photon_map *maps[ORL_MAP_KINDS];
    const char *map_keys[ORL_MAP_KINDS];
    const double *bandwidths; /* by kind, kernel areas relative to the usual ones; NULL: usual */
    struct orl_memory_cache *memory_cache; /* data of earlier jobs with these maps; may be NULL */
    /* Limits for the photons that are traced for sensors in mid-air. */
    struct orl_sensor_flux_limits sensor_photons;
    uint64_t virtual_lights; /* wanted number of virtual point lights */

    struct orl_health *health; /* receives the counters of photons that the technique traces */
    /* Returns where photons start, which is computed at the first call. */
    int (*get_emission)(void *ctx, const struct orl_emission **ret_emission, struct orl_error *err);
    void (*report_progress)(void *ctx, double fraction); /* progress of prepare */
    /* Receives the share of the global map that earlier jobs have read, from the memory cache. */
    void (*report_map_read)(void *ctx, double share);
    /* Replaces the estimate of a sensor, in finish_sensors. */
    void (*replace_sensor)(void *ctx, size_t index, const struct orl_estimate *estimate);
    void *ctx;
};

/* A sensor to be estimated. */
struct orl_sensor_query {
    size_t index;                     /* names its random numbers */
    struct orl_vec3 position, normal; /* unit normal */
    uint32_t samples;                 /* rays or paths */
    /* Paths: seed of the samples of all rounds, and the number of samples in earlier ones. */
    uint64_t seed;
    uint32_t first;
    struct orl_search *search; /* of the calling thread; NULL in load_sensor */
};

/* Result of a sensor. */
struct orl_sensor_estimate {
    struct orl_estimate estimate;
    /* 1: it receives caustics otherwise than by density (render/gather/gather.h) */
    uint64_t in_free_space;
};

/* ---- Methods --------------------------------------------------------------------------------- */

struct orl_technique_definition;

struct orl_technique_methods {
    /* Makes *ret_technique, the data that depend on the lit scene alone, which is borrowed until
     * destroy. On failure it is NULL. */
    int (*create)(const struct orl_technique_definition *definition,
                  const struct orl_lit_scene *lit_scene, struct orl_thread_pool *pool,
                  void **ret_technique, struct orl_error *err);
    /* Makes the data of a round: virtual point lights, or data derived from maps. */
    int (*prepare)(void *technique, const struct orl_technique_input *input, struct orl_error *err);
    /* Estimates a sensor. ret_batches receives the mean of each batch of its samples, if the
     * technique samples paths. */
    void (*compute_sensor)(void *technique, const struct orl_sensor_query *query,
                           struct orl_sensor_estimate *ret_found,
                           struct orl_rgb ret_batches[ORL_MAP_BATCHES]);
    /* Takes the result of a sensor that another process has computed. NULL: it is not needed. */
    void (*load_sensor)(void *technique, const struct orl_sensor_query *query,
                        const struct orl_sensor_estimate *found);
    /* Traces photons for all sensors together and adds their light. NULL: there are none. */
    int (*finish_sensors)(void *technique, struct orl_error *err);
    int (*paint_view)(void *technique, const struct orl_painting *painting, struct orl_error *err);
    /* Frees the data of the round, or moves them to the memory cache. NULL: nothing to free. */
    void (*finish)(void *technique);
    void (*destroy)(void *technique); /* accepts NULL */
};

/* A technique. */
struct orl_technique_definition {
    struct orl_technique_facts facts;
    const struct orl_technique_methods *methods;
    /* Estimator of indirect light of a technique that reads maps (photon_maps.h); NULL: none. */
    const struct orl_indirect_estimator *indirect;
};

extern const struct orl_technique_definition orl_backward_technique, orl_gather_technique,
    orl_direct_technique, orl_precomputed_technique;

/* A technique that has been created for a lit scene. */
struct orl_renderer {
    const struct orl_technique_methods *methods; /* NULL: not created yet */
    void *technique;
};

/* Creates the renderer of a technique other than ORL_TECHNIQUE_AUTO. On failure its methods stay
 * NULL. */
int orl_renderer_create(enum orl_technique technique, const struct orl_lit_scene *lit_scene,
                        struct orl_thread_pool *pool, struct orl_renderer *ret_renderer,
                        struct orl_error *err);
void orl_renderer_destroy(struct orl_renderer *renderer); /* accepts an all-zero struct */

#endif
