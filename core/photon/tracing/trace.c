#include "photon/tracing/trace.h"

#include <string.h>

#include "light/path.h"

/* ---- Path owner ------------------------------------------------------------------------------ */

/*
 * The estimator that is responsible for a caustic photon's path (partition of path space).
 *
 * Photons that sensors count in free space (orl_counting_discs) carry only light that the sensor
 * does not sample itself. A sensor samples suns by their images in flat mirrors, and by the lobes
 * of one pane.
 *
 * For backward paths (render/backward/backward.h), photons carry only light that paths find by
 * chance. Paths sample suns and lamps, with their images, from all surfaces with lobes. They hit
 * lights only by chance by way of curved or refracting surfaces, or of mirrors with more
 * orientations than there are images.
 */

enum path_estimator {
    ESTIMATOR_SHADOW_RAYS, /* straight so far */
    /* by mirrors of the image classes, if the image is shown; lamps by one mirror */
    ESTIMATOR_VIRTUAL_LIGHTS,
    /* sensors: a sun by the lobes of one pane; paths: any light by any lobes */
    ESTIMATOR_LOBES,
    ESTIMATOR_NONE,
};

#define OWNER_NO_LAMP UINT32_MAX
struct path_owner {
    enum path_estimator estimator;
    int16_t image;           /* the sun's image from which the photon comes; negative: none */
    bool for_backward_paths; /* true: for backward paths; false: for a sensor */
    /* light of a lamp by a mirror that has its image (light/virtual_lamps.h) */
    bool lamp_has_image;
    uint32_t lamp; /* the lamp's facet; OWNER_NO_LAMP for a sun */
};

/* Returns the image node in which a photon starts; for a sun it is the sun's own node. */
static int16_t image_of(const struct orl_lit_scene *lit_scene,
                        const struct orl_photon_ray *photon_ray)
{
    const struct orl_virtual_suns *images = &lit_scene->images;
    if (photon_ray->lamp || photon_ray->image >= 0)
        return photon_ray->lamp ? -1 : photon_ray->image;
    for (size_t i = 0; i < images->n_nodes; i++)
        if (images->nodes[i].is_sun && images->nodes[i].sun == photon_ray->sun)
            return (int16_t)i;
    return -1;
}

static struct path_owner path_owner_init(const struct orl_lit_scene *lit_scene,
                                         const struct orl_photon_ray *photon_ray,
                                         bool for_backward_paths)
{
    const struct orl_deflection deflection = photon_ray->deflection;
    struct path_owner path_owner = {.estimator = ESTIMATOR_SHADOW_RAYS,
                                    .image = image_of(lit_scene, photon_ray),
                                    .for_backward_paths = for_backward_paths,
                                    .lamp =
                                        photon_ray->lamp ? photon_ray->lamp_facet : OWNER_NO_LAMP};
    const bool by_sensor =
        !for_backward_paths && !photon_ray->lamp; /* sensors sample only suns by one pane's lobes */
    if ((deflection.mirror && deflection.lobe) || (deflection.lobe && !by_sensor))
        path_owner.estimator = for_backward_paths ? ESTIMATOR_LOBES : ESTIMATOR_NONE;
    else if (deflection.mirror || deflection.lobe)
        path_owner.estimator = deflection.mirror ? ESTIMATOR_VIRTUAL_LIGHTS : ESTIMATOR_LOBES;
    return path_owner;
}

/* Returns true if no other estimator finds the photon in its current state. */
static bool path_owner_is_none(const struct path_owner *path_owner,
                               const struct orl_lit_scene *lit_scene)
{
    const bool has_image =
        path_owner->lamp_has_image ||
        (path_owner->image >= 0 && lit_scene->images.nodes[path_owner->image].shown);
    return path_owner->estimator == ESTIMATOR_NONE ||
           (path_owner->estimator == ESTIMATOR_VIRTUAL_LIGHTS && !has_image);
}

/* Handles a reflection by a mirror: updates the image. A lamp has images in its first mirror
 * only. */
static enum path_estimator estimator_after_mirror(struct path_owner *path_owner,
                                                  const struct orl_lit_scene *lit_scene,
                                                  uint32_t facet)
{
    const struct orl_virtual_suns *images = &lit_scene->images;
    const int16_t class = orl_virtual_suns_class(images, facet);
    if (path_owner->lamp != OWNER_NO_LAMP) {
        path_owner->lamp_has_image =
            path_owner->estimator == ESTIMATOR_SHADOW_RAYS &&
            orl_virtual_lamps_contain(&lit_scene->virtual_lamps, path_owner->lamp, facet);
        return path_owner->lamp_has_image ? ESTIMATOR_VIRTUAL_LIGHTS : ESTIMATOR_NONE;
    }
    path_owner->image =
        class < 0 || path_owner->image < 0
            ? -1
            : images->next[(size_t)path_owner->image * images->n_mirrors + (size_t) class];
    return path_owner->image < 0 ? ESTIMATOR_NONE : ESTIMATOR_VIRTUAL_LIGHTS;
}

/* The first lobes on the light's path decide: backward paths that reach them sample lights from
 * there. */
static enum path_estimator estimator_for_paths(struct path_owner *path_owner,
                                               const struct orl_lit_scene *lit_scene,
                                               const struct orl_hit *hit,
                                               enum orl_scatter_event event)
{
    if (path_owner->estimator == ESTIMATOR_LOBES || path_owner->estimator == ESTIMATOR_NONE)
        return path_owner->estimator;
    if (event == ORL_EVENT_MIRROR)
        return estimator_after_mirror(path_owner, lit_scene, hit->facet);
    return event == ORL_EVENT_GLOSSY && !path_owner_is_none(path_owner, lit_scene) ? ESTIMATOR_LOBES
                                                                                   : ESTIMATOR_NONE;
}

static enum path_estimator estimator_for_sensor(struct path_owner *path_owner,
                                                const struct orl_lit_scene *lit_scene,
                                                const struct orl_hit *hit,
                                                enum orl_scatter_event event)
{
    const bool straight = path_owner->estimator == ESTIMATOR_SHADOW_RAYS && path_owner->image >= 0;
    const bool lamp = path_owner->lamp != OWNER_NO_LAMP;
    if (event == ORL_EVENT_MIRROR &&
        (straight || lamp || path_owner->estimator == ESTIMATOR_VIRTUAL_LIGHTS))
        return estimator_after_mirror(path_owner, lit_scene, hit->facet);
    if (event == ORL_EVENT_GLOSSY && straight &&
        orl_material_transmits_lobes(orl_lit_scene_material(lit_scene, hit)))
        return ESTIMATOR_LOBES;
    return ESTIMATOR_NONE;
}

/* Updates the state after an event at a hit, other than straight transmission. */
static void path_owner_update(struct path_owner *path_owner, const struct orl_lit_scene *lit_scene,
                              const struct orl_hit *hit, enum orl_scatter_event event)
{
    path_owner->estimator = path_owner->for_backward_paths
                                ? estimator_for_paths(path_owner, lit_scene, hit, event)
                                : estimator_for_sensor(path_owner, lit_scene, hit, event);
}

/* ---- Tracing of a photon --------------------------------------------------------------------- */

/* Parameters of a trace: the scene, and the photons that are wanted. */
struct trace_params {
    const struct orl_lit_scene *lit_scene;
    /* discs in which photons are counted; NULL: photons are deposited */
    const struct orl_counting_discs *discs;
    bool caustic, unsampled_only;
    enum orl_lobes lobes;
    uint32_t most_reflections;
};

/* State of a photon. */
struct photon_state {
    struct orl_path path; /* its weight is the flux */
    double roulette_u, survival;
    double reflected;                    /* value of the photon ray */
    double focus, lamp_distance, spread; /* spotlight's beam, until the photon is scattered */
    struct orl_deflection deflection;
    bool crossed, outside, lamp;
    uint8_t batch;
    enum orl_photon_class class;
    struct path_owner path_owner; /* used with discs or unsampled_only */
    uint32_t reflections;
    int bounces, unstored;
};

/*
 * Russian roulette: returns false if the survival probability has fallen to the photon's roulette
 * number. roulette_scale: factor by which the flux is reduced in addition (strata/strata.c); or 1.
 */
static bool survives_roulette(struct photon_state *c, struct orl_rgb weight, double roulette_scale)
{
    const double probability = orl_smaller(orl_luma(weight) / roulette_scale, 1);
    c->survival *= probability;
    if (!(c->survival > c->roulette_u))
        return false;
    c->path.weight = orl_rgb_scale(orl_rgb_mul(c->path.weight, weight), 1 / probability);
    return true;
}

/*
 * Returns true if roulette ends the photon at a matt surface. The result depends on the albedo
 * only, so it is known before a direction is sampled, and most photons end there.
 */
static bool roulette_ends_at(const struct photon_state *c, const struct orl_material *m,
                             struct orl_rgb albedo, double roulette_scale, bool caustic)
{
    return orl_material_is_matt(m) &&
           (caustic ||
            !(c->survival * orl_smaller(orl_luma(albedo) / roulette_scale, 1) > c->roulette_u));
}

/* Applies the path to a hit: absorption by the medium, and the spread of a spotlight's beam
 * (scene/material/lamp.c). Returns false if the photon ends. */
static bool attenuate_to_hit(struct photon_state *c, const struct orl_material *m,
                             const struct orl_hit *hit)
{
    if (c->focus > 0) {
        const double before = c->spread;
        c->lamp_distance += hit->distance;
        c->spread = fmax(orl_spotlight_falloff(c->focus, c->lamp_distance), 1e-12);
        c->path.weight = orl_rgb_scale(c->path.weight, c->spread / before);
    }
    const struct orl_rgb left = orl_hit_transmittance(m, hit, c->path.medium_transmissivity);
    return orl_medium_is_clear(left) || survives_roulette(c, left, 1);
}

/* Handles a ray that hits nothing; from inside a sealed building it is counted as a leak. */
static void count_leak(const struct orl_lit_scene *lit_scene, const struct photon_state *c,
                       struct orl_health *health)
{
    if (lit_scene->open || !c->crossed || c->outside)
        return;
    if (health->rays_leaked++ == 0) {
        health->leak_from = c->path.origin;
        health->leak_towards = c->path.direction;
    }
}

static enum orl_photon_class class_after(enum orl_photon_class class, enum orl_scatter_event event)
{
    if (event == ORL_EVENT_STRAIGHT || class == ORL_PHOTON_INDIRECT)
        return class;
    return event == ORL_EVENT_DIFFUSE ? ORL_PHOTON_INDIRECT : ORL_PHOTON_CAUSTIC;
}

/* Returns true for caustic photons by deflections that the plan omits. */
static bool is_omitted(const struct orl_lit_scene *lit_scene, struct orl_deflection deflection)
{
    return (deflection.mirror && lit_scene->omit.mirror_caustics) ||
           (deflection.lobe && lit_scene->omit.lobe_caustics);
}

/* Returns true if no other estimator finds the photon in its current state; false outdoors. */
static bool is_unsampled(const struct trace_params *t, const struct photon_state *c)
{
    return !c->outside && path_owner_is_none(&c->path_owner, t->lit_scene);
}

/* Counts the photon in the discs on its way to the hit (NULL: none). */
static void count_in_discs(const struct trace_params *t, const struct photon_state *c,
                           const struct orl_hit *hit, struct orl_deposits *deposits)
{
    const struct orl_ray_segment ray_segment = {.origin = c->path.origin,
                                                .direction = c->path.direction,
                                                .distance = hit ? hit->distance : INFINITY,
                                                .flux = c->path.weight,
                                                .focus = c->focus,
                                                .lamp_distance = c->lamp_distance,
                                                .spread = c->spread,
                                                .lamp = c->lamp,
                                                .batch = c->batch % ORL_MAP_BATCHES};
    if (is_unsampled(t, c))
        orl_counting_discs_record(t->discs, &ray_segment, &deposits->crossings);
}

/* Returns the lobes that may scatter the photon: illums transmit light that comes straight from
 * suns and lamps. */
static enum orl_lobes lobes_for(const struct trace_params *t, const struct photon_state *c)
{
    const bool straight = c->class == ORL_PHOTON_DIRECT && c->reflections == 0;
    return straight ? (enum orl_lobes)(t->lobes | ORL_LOBE_ILLUM) : t->lobes;
}

static struct trace_params trace_params_of(const struct orl_lit_scene *lit_scene, bool caustic)
{
    const uint32_t most = lit_scene->omit.most_reflections;
    return (struct trace_params){
        .lit_scene = lit_scene,
        .caustic = caustic,
        .lobes =
            caustic ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED) : ORL_LOBE_ALL,
        .most_reflections = most < ORL_ALL_REFLECTIONS ? most : UINT32_MAX};
}

/* Initialises a photon. Returns false if it is not wanted. */
static bool init_photon(const struct trace_params *t, const struct orl_photon_ray *photon_ray,
                        uint8_t batch, struct photon_state *c, struct orl_deposits *deposits)
{
    const struct orl_deflection deflection = photon_ray->deflection;
    /* Members are set one by one: clearing the whole struct first takes longer than the rest. */
    c->path.origin = photon_ray->origin;
    c->path.direction = photon_ray->direction;
    c->path.weight = orl_health_filter(&deposits->health, photon_ray->flux);
    c->path.medium_transmissivity =
        photon_ray->from_port ? photon_ray->medium_transmissivity : orl_gray(1);
    c->roulette_u = photon_ray->roulette_u;
    c->survival = 1;
    c->spread =
        photon_ray->lamp_distance > 0
            ? fmax(orl_spotlight_falloff(photon_ray->focus, photon_ray->lamp_distance), 1e-12)
            : 1;
    c->reflected = photon_ray->reflected;
    c->focus = photon_ray->focus;
    c->lamp_distance = photon_ray->lamp_distance;
    c->deflection = deflection;
    c->crossed = photon_ray->from_port;
    c->outside = false;
    c->lamp = photon_ray->lamp;
    c->batch = batch;
    c->class = !photon_ray->from_light                  ? ORL_PHOTON_INDIRECT
               : (deflection.mirror || deflection.lobe) ? ORL_PHOTON_CAUSTIC
                                                        : ORL_PHOTON_DIRECT;
    c->reflections = 0;
    c->bounces = c->unstored = 0;
    if (t->discs || t->unsampled_only)
        c->path_owner = path_owner_init(t->lit_scene, photon_ray, t->unsampled_only);
    if (t->caustic && is_omitted(t->lit_scene, deflection))
        return false;
    deposits->health.photons++;
    orl_sum_add(&deposits->flux, orl_luma(c->path.weight));
    return true;
}

/* Handles the hit of the photon's ray (NULL: none), and deposits a photon if one is wanted.
 * Returns false if the photon ends. */
static bool handle_hit(const struct trace_params *t, struct photon_state *c,
                       const struct orl_hit *hit, struct orl_deposits *deposits)
{
    const struct orl_lit_scene *lit_scene = t->lit_scene;
    const struct orl_deflection deflection = c->deflection;
    deposits->health.rays++;
    if (!hit) {
        count_leak(lit_scene, c, &deposits->health);
        return false;
    }
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    const struct orl_rgb albedo = orl_material_diffuse(m, hit);
    const bool diffuse = orl_rgb_max(albedo) > 0;
    if (!attenuate_to_hit(c, m, hit))
        return false;
    c->unstored++;
    if (diffuse && !c->outside && !t->discs &&
        (t->caustic
             ? (deflection.mirror || deflection.lobe) && (!t->unsampled_only || is_unsampled(t, c))
             : c->reflections < t->most_reflections)) {
        if (t->caustic || !lit_scene->omit.counted_light || c->class == ORL_PHOTON_INDIRECT)
            orl_deposit(deposits, hit, c->path.weight, c->batch, c->class);
        c->unstored = 0;
    }
    return !roulette_ends_at(c, m, albedo, c->class == ORL_PHOTON_INDIRECT ? 1 : c->reflected,
                             t->caustic);
}

/* Applies a scattering event. Returns false if the photon is absorbed, or is not wanted after
 * it. */
static bool apply_scatter(const struct trace_params *t, struct photon_state *c,
                          const struct orl_hit *hit, const struct orl_surface_sample *s,
                          struct orl_deposits *deposits)
{
    const double roulette_scale = c->class == ORL_PHOTON_INDIRECT ? 1 : c->reflected;
    if (s->event == ORL_EVENT_ABSORBED ||
        !survives_roulette(c, orl_health_filter(&deposits->health, s->weight),
                           s->event == ORL_EVENT_DIFFUSE ? roulette_scale : 1))
        return false;
    if (s->transmitted) {
        const enum orl_port_crossing crossing = orl_lit_scene_crossing(t->lit_scene, hit);
        /* The port itself emits light that crosses it inwards for the first time. */
        if (crossing == ORL_CROSSING_INWARDS && !c->crossed)
            return false;
        c->crossed = c->crossed || crossing != ORL_CROSSING_NONE;
        c->outside = orl_lit_scene_outside_after(t->lit_scene, hit, true, c->outside);
    }
    c->deflection = orl_deflection_after(c->deflection, s->event);
    c->reflections += s->event == ORL_EVENT_DIFFUSE;
    if (t->caustic ? is_omitted(t->lit_scene, c->deflection)
                   : c->reflections >= t->most_reflections)
        return false;
    c->class = class_after(c->class, s->event);
    if ((t->discs || t->unsampled_only) && s->event != ORL_EVENT_STRAIGHT)
        path_owner_update(&c->path_owner, t->lit_scene, hit, s->event);
    if (s->event == ORL_EVENT_DIFFUSE || s->event == ORL_EVENT_GLOSSY)
        c->focus = 0;
    orl_path_spawn_ray(&c->path, t->lit_scene, hit, s);
    if (++c->bounces < ORL_TRACE_MOST_BOUNCES && c->unstored < ORL_TRACE_MOST_UNSTORED)
        return true;
    orl_deposits_count_capped(deposits, c->path.weight);
    return false;
}

void orl_trace_photon(const struct orl_lit_scene *lit_scene,
                      const struct orl_photon_ray *photon_ray, bool caustic, uint8_t batch,
                      struct orl_random *random, struct orl_deposits *deposits)
{
    const struct trace_params t = trace_params_of(lit_scene, caustic);
    struct orl_surface_sample s;
    struct orl_hit hit;
    struct photon_state c;
    if (!init_photon(&t, photon_ray, batch, &c, deposits))
        return;
    do {
        const bool met = orl_path_intersect(lit_scene, &c.path, &hit);
        if (!handle_hit(&t, &c, met ? &hit : NULL, deposits))
            return;
        s = orl_material_sample(orl_lit_scene_material(lit_scene, &hit), &hit,
                                orl_path_back(&c.path), ORL_TRANSPORT_LIGHT, lobes_for(&t, &c),
                                random);
    } while (apply_scatter(&t, &c, &hit, &s, deposits));
}

/* ---- Many photons at once -------------------------------------------------------------------- */

enum { AT_ONCE = ORL_EMISSIONS_AT_ONCE };
_Static_assert((int)AT_ONCE <= UINT8_MAX + 1, "a photon has its number where its batch will stand");

/* Photons that take each step together. */
struct photon_wavefront {
    struct trace_params trace_params;
    struct orl_deposits *deposits;
    struct orl_random *randoms;
    struct photon_state states[AT_ONCE];
    uint16_t active[AT_ONCE];
    size_t n, n_parallel; /* number of active photons; those with parallel rays come first */
    struct orl_ray rays[AT_ONCE];
    struct orl_hit hits[AT_ONCE]; /* hits of the active photons, in their order */
    bool found[AT_ONCE];
    struct orl_bsdf_query queries[AT_ONCE];
    double u[AT_ONCE][3];
    /* indices among the active photons, of those that are scattered */
    uint16_t scattered[AT_ONCE];
    struct orl_surface_sample samples[AT_ONCE];
};

static void trace_rays(struct photon_wavefront *w)
{
    const struct orl_geometry *g = w->trace_params.lit_scene->geometry;
    for (size_t i = 0; i < w->n; i++) {
        const struct orl_path *path = &w->states[w->active[i]].path;
        w->rays[i] = (struct orl_ray){path->origin, path->direction};
    }
    orl_geometry_intersect_many(g, w->rays, w->n_parallel, true, w->hits, w->found);
    orl_geometry_intersect_many(g, w->rays + w->n_parallel, w->n - w->n_parallel, false,
                                w->hits + w->n_parallel, w->found + w->n_parallel);
    w->n_parallel = 0;
}

/* Handles the hits of all active photons, and samples scattering for those that do not end. */
static size_t scatter_all(struct photon_wavefront *w)
{
    size_t n = 0;
    for (size_t i = 0; i < w->n; i++) {
        const struct orl_hit *hit = &w->hits[i];
        struct photon_state *c = &w->states[w->active[i]];
        struct orl_random *random = &w->randoms[w->active[i]];
        if (w->trace_params.discs)
            count_in_discs(&w->trace_params, c, w->found[i] ? hit : NULL, w->deposits);
        if (!handle_hit(&w->trace_params, c, w->found[i] ? hit : NULL, w->deposits))
            continue;
        for (int k = 0; k < 3; k++)
            w->u[n][k] = orl_random_uniform(random);
        w->queries[n] = (struct orl_bsdf_query){
            orl_lit_scene_material(w->trace_params.lit_scene, hit), hit, orl_path_back(&c->path),
            ORL_TRANSPORT_LIGHT, lobes_for(&w->trace_params, c)};
        w->scattered[n++] = (uint16_t)i;
    }
    orl_material_sample_many(w->queries, (const double(*)[3])w->u, n, w->samples);
    return n;
}

static void advance_wavefront(struct photon_wavefront *w)
{
    size_t left = 0;
    trace_rays(w);
    const size_t n = scatter_all(w);
    for (size_t k = 0; k < n; k++) {
        const uint16_t i = w->scattered[k], photon = w->active[i];
        if (apply_scatter(&w->trace_params, &w->states[photon], &w->hits[i], &w->samples[k],
                          w->deposits))
            w->active[left++] = photon;
    }
    w->n = left;
}

/* Sorts the wavefront's deposits by photon, as if each had been traced alone, and sets their
 * batches. */
static void sort_deposits(struct orl_deposits *deposits, size_t first)
{
    const size_t n = deposits->count - first;
    size_t next[AT_ONCE + 1] = {0};
    if (n == 0 || !orl_deposits_reserve(deposits, n))
        return;
    struct orl_photon *left = deposits->photons + first, *sorted = left + n;
    for (size_t i = 0; i < n; i++)
        next[left[i].batch + 1]++;
    for (size_t k = 0; k < AT_ONCE; k++)
        next[k + 1] += next[k];
    for (size_t i = 0; i < n; i++) {
        struct orl_photon *p = &sorted[next[left[i].batch]++];
        *p = left[i];
        p->batch %= ORL_MAP_BATCHES;
    }
    memcpy(left, sorted, n * sizeof *left);
}

void orl_trace_many(const struct orl_lit_scene *lit_scene, const struct orl_photon_ray *photon_rays,
                    const bool *is_emitted, size_t n, bool caustic, struct orl_random *randoms,
                    struct orl_deposits *deposits)
{
    const size_t first = deposits->count;
    struct photon_wavefront w;
    w.trace_params = trace_params_of(lit_scene, caustic);
    w.trace_params.discs = deposits->discs;
    w.trace_params.unsampled_only = deposits->unsampled_only;
    w.deposits = deposits;
    w.randoms = randoms;
    w.n = w.n_parallel = 0;
    uint16_t others[AT_ONCE];
    size_t n_others = 0;
    for (size_t i = 0; i < n; i++) {
        if (!is_emitted[i] ||
            !init_photon(&w.trace_params, &photon_rays[i], (uint8_t)i, &w.states[i], deposits))
            continue;
        if (photon_rays[i].parallel)
            w.active[w.n_parallel++] = (uint16_t)i;
        else
            others[n_others++] = (uint16_t)i;
    }
    memcpy(w.active + w.n_parallel, others, n_others * sizeof *others);
    w.n = w.n_parallel + n_others;
    while (w.n > 0)
        advance_wavefront(&w);
    sort_deposits(deposits, first);
}
