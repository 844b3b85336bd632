/* The backward technique: samples of a place (the light there, and the paths that estimate it),
 * and the irradiance of sensors as their mean. */
#include "render/backward/backward.h"

#include "scene/built/scene.h"
#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"

enum { SURE_BOUNCES = 3 };
/* Weights below which paths undergo Russian roulette: in general, and in the first bounces, which
 * were importance sampled. */
static const double certain_weight = 0.25, dimmest_aimed = 0.002;
/*
 * Weight below which surfaces that a path meets are lit only with a probability. It is low because
 * a patch of sun can be a thousand times as bright as its surroundings. If few such paths saw it in
 * a pane, it would be an outlier.
 */
static const double dimmest_lit = 0.02;

/* State of a path since the last place where all parts of the light were estimated. */
struct path_state {
    struct orl_eye_path eye; /* must be first: the visitor receives a pointer to it */
    struct orl_tracer *tracer;
    double importance;           /* weight of the path's start in the sample, at most about 1 */
    uint32_t reflections;        /* number of diffuse reflections before the start */
    double cos_start, travelled; /* cosine at that place, and length travelled since */
    bool straight;               /* true if the path has met only panes since then */
    struct orl_mirror_history history; /* mirrors met since the last lobe or diffuse surface */
    bool been_outside;
};

/* A place on a path where light is estimated. */
struct shade_point {
    struct orl_shading_point place;
    double importance;
    uint32_t reflections;
    bool is_first; /* true for the sample's first place: its numbers and rays are those of params */
    const struct orl_sample_params *params; /* set if is_first */
};

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct shade_point *shade_point);

static struct path_state *path_state_of(struct orl_eye_path *p)
{
    return (struct path_state *)p;
}

/* Returns a new path with weight 1 and no MIS correction. */
static struct path_state path_state_from(struct orl_tracer *tracer, struct orl_vec3 origin,
                                         struct orl_vec3 direction)
{
    return (struct path_state){.eye = {.lit_scene = tracer->backward->lit_scene,
                                       .random = &tracer->random,
                                       .path = orl_path_from(origin, direction)},
                               .tracer = tracer,
                               .importance = 1,
                               .history = orl_mirror_history_begin(direction)};
}

/* ---- Paths ----------------------------------------------------------------------------------- */

/*
 * Adds the light that a diffuse surface on the path reflects. Virtual lights account for it if they
 * see the place that the path started from; the path adds the share that they leave
 * (orl_vpl_clamped_share).
 */
static void add_diffuse(struct path_state *w, struct orl_rgb albedo)
{
    struct orl_eye_path *p = &w->eye;
    const struct orl_lit_scene *lit_scene = p->lit_scene;
    const struct orl_hit *hit = &p->hit;
    const struct orl_vec3 lit = orl_hit_facing(hit);
    const double left =
        w->straight ? orl_vpl_clamped_share(&w->tracer->backward->vpls, w->cos_start,
                                            orl_dot(p->path.direction, hit->normal), w->travelled)
                    : 1;
    if (!(left > 0) || w->reflections >= lit_scene->omit.most_reflections)
        return;
    const double matters = w->importance * left * orl_rgb_max(orl_rgb_mul(p->path.weight, albedo));
    const double chance = fmin(matters / dimmest_lit, 1);
    if (chance < 1 && !(orl_random_uniform(p->random) < chance))
        return;
    const struct shade_point shade_point = {
        .place = {.point = orl_hit_ray_origin(lit_scene->geometry, hit, lit), .normal = lit},
        .importance = fmin(matters / chance, 1),
        .reflections = w->reflections + 1};
    orl_eye_path_add_radiance(p,
                              orl_rgb_scale(orl_rgb_mul(albedo, light_at(w->tracer, &shade_point)),
                                            left / (chance * ORL_PI)));
}

/* Adds a sun's disc only if no shadow ray could have sampled it. */
static void add_sun(struct orl_eye_path *p)
{
    const struct path_state *w = path_state_of(p);
    const bool deflected = w->history.reflections > 0 || w->history.left_classes;
    if (!deflected || w->been_outside || isfinite(p->chance.pdf))
        return;
    const struct orl_rgb sun = orl_lit_scene_sun_radiance(p->lit_scene, p->path.direction);
    if (orl_rgb_max(sun) > 0 && !orl_virtual_suns_counted(p->lit_scene, &w->history))
        orl_eye_path_add_radiance(p, sun);
}

/* Applies Russian roulette to dim and to long paths. The threshold of the first bounces is lower,
 * because importance-sampled rays have small weights only for being many. */
static bool survives(struct path_state *w)
{
    const double matters = w->importance * orl_rgb_max(w->eye.path.weight);
    const double chance =
        fmin(matters / (w->eye.bounce < SURE_BOUNCES ? dimmest_aimed : certain_weight), 1);
    return !(chance < 1) || orl_path_roulette(&w->eye.path, chance, w->eye.random);
}

/* Adds the light that the surface emits and reflects. The path continues by mirrors, panes and
 * lobes. */
static enum orl_lobes shade_surface(struct orl_eye_path *p, const struct orl_material *m)
{
    struct path_state *w = path_state_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    w->travelled += p->hit.distance;
    orl_eye_path_add_radiance(p, orl_emitted_radiance(p->lit_scene, &p->hit, eye, &p->chance));
    if (orl_rgb_max(albedo) > 0)
        add_diffuse(w, albedo);
    if (orl_material_has_lobes(m))
        orl_eye_path_add_radiance(p, orl_direct_by_lobes(p->lit_scene, &p->hit, m, eye, p->random));
    return survives(w) ? (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED)
                       : ORL_LOBE_NONE;
}

static bool note_event(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    struct path_state *w = path_state_of(p);
    p->chance = orl_mis_pdf_update(p->lit_scene, &p->hit, orl_path_back(&p->path), s, p->chance);
    orl_eye_path_cross_port(p, s);
    p->clear = p->clear && p->outside;
    if (s->event == ORL_EVENT_STRAIGHT)
        return true;
    w->straight = false;
    if (s->event == ORL_EVENT_GLOSSY)
        w->history = orl_mirror_history_begin(s->direction);
    else if (s->event == ORL_EVENT_MIRROR)
        orl_mirror_history_add(&w->history, &p->lit_scene->images, p->hit.facet);
    else
        w->history.left_classes = true;
    return true;
}

/* Continues the path outdoors, where virtual lights account for nothing (vpl.c). Shadow rays to
 * mirror images account for the suns there. */
static bool continue_outdoors(struct orl_eye_path *p)
{
    struct path_state *w = path_state_of(p);
    w->straight = false;
    w->been_outside = true;
    return orl_exterior_continue(p, w->tracer->health);
}

/* Handles scattering by a volume, where suns and lamps have been sampled already. */
static bool handle_volume_event(struct orl_eye_path *p)
{
    struct path_state *w = path_state_of(p);
    w->straight = false;
    w->history = orl_mirror_history_begin(p->path.direction);
    return survives(w);
}

static const struct orl_path_visitor visitor = {.on_outdoors = continue_outdoors,
                                                .escaped = add_sun,
                                                .met = shade_surface,
                                                .scattered = handle_volume_event,
                                                .on_sampled = note_event};

/* Follows the path to its end and returns the radiance that it has collected. */
static struct orl_rgb follow_path(struct path_state *w)
{
    orl_eye_path_trace(&w->eye, &visitor, w->tracer->health);
    return w->eye.seen;
}

struct orl_rgb orl_backward_radiance(struct orl_tracer *tracer, struct orl_vec3 origin,
                                     struct orl_vec3 direction, bool outside,
                                     struct orl_mis_pdf chance)
{
    struct path_state w = path_state_from(tracer, origin, direction);
    w.eye.chance = chance;
    w.eye.outside = outside;
    tracer->health->paths++;
    return follow_path(&w);
}

/* ---- Light at a place ------------------------------------------------------------------------ */

/* Returns the normal that cosines are measured from. */
static struct orl_vec3 normal_of(const struct shade_point *shade_point)
{
    return shade_point->place.textured ? shade_point->place.shading : shade_point->place.normal;
}

/* Dimensions of a sample's sequence, by use. */
enum slot { SLOT_SUN, SLOT_LAMPS, SLOT_STRATEGIES };

/* Returns numbers in [0,1) for the n-th of each sample's draws in that slot. */
static void draw_numbers(struct orl_tracer *tracer, const struct shade_point *shade_point,
                         uint32_t slot, uint32_t each, uint32_t n, uint32_t count, double *ret_u)
{
    const struct orl_sample_params *s = shade_point->params;
    if (shade_point->is_first)
        orl_sobol_point(&tracer->backward->sobol, s->index * each + n,
                        s->sequence + slot * 0x9e3779b9U, count, ret_u);
    else
        for (uint32_t i = 0; i < count; i++)
            ret_u[i] = orl_random_uniform(&tracer->random);
}

static struct orl_rgb direct_light(struct orl_tracer *tracer, const struct shade_point *shade_point)
{
    const struct orl_lit_scene *lit_scene = tracer->backward->lit_scene;
    double u[2];
    const struct orl_direct_query query = {
        .point = shade_point->place.point,
        .normal = shade_point->place.normal,
        .shading = shade_point->place.textured ? &shade_point->place.shading : NULL,
        .through_ports = true,
        .mirrored = true,
        .u = u};
    draw_numbers(tracer, shade_point, SLOT_SUN, 1, 0, 2, u);
    return orl_direct_light(shade_point->place.proxied ? orl_lit_scene_seen(lit_scene) : lit_scene,
                            &query, &tracer->random);
}

static struct orl_rgb some_lamps(struct orl_tracer *tracer, const struct shade_point *shade_point)
{
    double u;
    draw_numbers(tracer, shade_point, SLOT_LAMPS, 1, 0, 1, &u);
    return orl_vpl_irradiance(&tracer->backward->vpls, tracer->group, u,
                              shade_point->is_first ? shade_point->params->lamps : 1,
                              shade_point->place.point, normal_of(shade_point));
}

/* Reflects a direction about a turned normal that points below the surface back above it. Returns
 * false if the direction is left as it is. */
static bool fold_direction(const struct shade_point *shade_point, struct orl_vec3 *direction)
{
    const double cosine = orl_dot(*direction, shade_point->place.normal);
    if (!shade_point->place.textured || cosine > 0)
        return false;
    *direction = orl_madd(*direction, shade_point->place.normal, -2 * cosine);
    return true;
}

/* Returns the contribution of one importance-sampled ray. */
static struct orl_rgb trace_sampled_ray(struct orl_tracer *tracer,
                                        const struct shade_point *shade_point,
                                        const struct orl_strategy_counts *ray_counts,
                                        enum orl_strategy strategy, const double u[3])
{
    struct orl_direction_sample ray_sample;
    tracer->health->paths++;
    if (!orl_direction_sample_traced(&tracer->backward->sampler, ray_counts, strategy,
                                     shade_point->place.point, normal_of(shade_point), u,
                                     &ray_sample))
        return orl_gray(0);
    const double cosine = orl_dot(ray_sample.direction, normal_of(shade_point));
    const bool folded = fold_direction(shade_point, &ray_sample.direction);
    struct path_state w = path_state_from(tracer, shade_point->place.point, ray_sample.direction);
    w.eye.path.weight = orl_gray(ray_sample.weight / ORL_PI);
    w.importance = shade_point->importance;
    w.reflections = shade_point->reflections;
    w.cos_start = cosine;
    w.straight = !folded; /* virtual lights have not accounted for light from there */
    if (!folded)
        orl_eye_path_set_next_hit(&w.eye, ray_sample.met ? &ray_sample.hit : NULL);
    return orl_rgb_scale(follow_path(&w), ORL_PI);
}

static struct orl_rgb sampled_light(struct orl_tracer *tracer,
                                    const struct shade_point *shade_point)
{
    const struct orl_strategy_counts *ray_counts =
        shade_point->is_first ? &shade_point->params->ray_counts : &tracer->backward->bounce_counts;
    struct orl_rgb sum = orl_gray(0);
    for (int strategy = 0; strategy < ORL_STRATEGIES; strategy++) {
        const double wanted = ray_counts->rays[strategy], whole = floor(wanted);
        const bool more = wanted > whole && orl_random_uniform(&tracer->random) < wanted - whole;
        const uint32_t rays = (uint32_t)whole + more, each = (uint32_t)ceil(wanted);
        for (uint32_t n = 0; n < rays; n++) {
            double u[3];
            draw_numbers(tracer, shade_point, SLOT_STRATEGIES + (uint32_t)strategy, each, n, 3, u);
            sum = orl_rgb_add(sum, trace_sampled_ray(tracer, shade_point, ray_counts,
                                                     (enum orl_strategy)strategy, u));
        }
    }
    return sum;
}

/* Returns the light at places that photons do not reach: outdoors, and on surfaces that a BSDF
 * stands for. */
static struct orl_rgb light_outside(struct orl_tracer *tracer,
                                    const struct shade_point *shade_point)
{
    const struct orl_lit_scene *lit_scene = tracer->backward->lit_scene;
    double u[3];
    draw_numbers(tracer, shade_point, SLOT_STRATEGIES, 1, 0, 3, u);
    struct orl_vec3 direction = orl_hemisphere_about(normal_of(shade_point), u[0], u[1]);
    fold_direction(shade_point, &direction);
    if (shade_point->place.proxied)
        return orl_rgb_scale(orl_exterior_radiance(
                                 orl_lit_scene_seen(lit_scene), shade_point->place.point, direction,
                                 orl_mis_pdf_zero(), &tracer->random, tracer->health, NULL),
                             ORL_PI);
    struct path_state w = path_state_from(tracer, shade_point->place.point, direction);
    w.importance = shade_point->importance;
    w.reflections = shade_point->reflections;
    w.eye.outside = true;
    return orl_rgb_scale(follow_path(&w), ORL_PI);
}

static struct orl_rgb light_at(struct orl_tracer *tracer, const struct shade_point *shade_point)
{
    const uint32_t most = tracer->backward->lit_scene->omit.most_reflections;
    struct orl_rgb sum = direct_light(tracer, shade_point);
    if (shade_point->place.outside)
        return orl_rgb_add(sum, light_outside(tracer, shade_point));
    if (shade_point->reflections < most && !tracer->backward->lit_scene->scene->mist)
        sum = orl_rgb_add(sum, some_lamps(tracer, shade_point));
    return orl_rgb_add(sum, sampled_light(tracer, shade_point));
}

struct orl_rgb orl_backward_sample_irradiance(struct orl_tracer *tracer,
                                              const struct orl_shading_point *place,
                                              const struct orl_sample_params *params)
{
    const struct shade_point shade_point = {
        .place = *place, .importance = 1, .is_first = true, .params = params};
    return light_at(tracer, &shade_point);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

enum { LAMPS_A_SAMPLE = 8 };
/* Rays per strategy: for a sensor's sample, and for a surface that one of its rays meets. */
static const struct orl_strategy_counts at_sensors = {{1, 1, 1, 0.5}}, deeper = {{1, 1, 0.5, 0.25}};

int orl_backward_init(struct orl_backward *backward, const struct orl_lit_scene *lit_scene,
                      struct orl_thread_pool *pool)
{
    *backward = (struct orl_backward){.lit_scene = lit_scene};
    orl_sobol_init(&backward->sobol);
    const int code =
        orl_direction_sampler_init(&backward->sampler, lit_scene, &backward->sobol, pool);
    backward->bounce_counts = orl_direction_sampler_counts(&backward->sampler, deeper);
    return code;
}

int orl_backward_set_vpls(struct orl_backward *backward, struct orl_thread_pool *pool,
                          uint64_t seed, const struct orl_photon *photons, size_t count,
                          uint64_t emitted)
{
    orl_vpls_done(&backward->vpls);
    backward->seed = seed;
    return orl_vpls_init(&backward->vpls, backward->lit_scene, pool, photons, count, emitted);
}

void orl_backward_done(struct orl_backward *backward)
{
    orl_direction_sampler_done(&backward->sampler);
    orl_vpls_done(&backward->vpls);
}

/* Returns the mean of one group's samples; rays receives each sample's contribution to the
 * sensor. */
static struct orl_rgb sample_group(const struct orl_backward *b,
                                   const struct orl_shading_point *place,
                                   const struct orl_sample_range *range, uint32_t group,
                                   struct orl_health *health, struct orl_ray_moments *rays)
{
    const uint32_t first = range->first / ORL_MAP_BATCHES;
    const uint32_t samples =
        range->samples / ORL_MAP_BATCHES > 0 ? range->samples / ORL_MAP_BATCHES : 1;
    const uint64_t name = range->index * ORL_MAP_BATCHES + group;
    struct orl_sample_params params = {
        .sequence = (uint32_t)orl_mix64(range->seed ^ orl_mix64(name + 1)),
        .ray_counts = orl_direction_sampler_counts(&b->sampler, at_sensors),
        .lamps = LAMPS_A_SAMPLE};
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = first; i < first + samples && !orl_is_cancelled(b->cancel); i++) {
        struct orl_tracer tracer = {
            .backward = b,
            .group = group,
            .random = orl_random_stream(range->seed, ORL_PURPOSE_SENSOR, (name << 24) + i),
            .health = health};
        params.index = i;
        const struct orl_rgb light =
            orl_health_filter(health, orl_backward_sample_irradiance(&tracer, place, &params));
        orl_ray_moments_add(rays, orl_luma(light) / samples / ORL_MAP_BATCHES);
        sum = orl_rgb_add(sum, light);
    }
    return orl_rgb_scale(sum, 1.0 / samples);
}

struct orl_estimate orl_backward_irradiance(const struct orl_backward *backward,
                                            struct orl_vec3 position, struct orl_vec3 normal,
                                            const struct orl_sample_range *range,
                                            struct orl_health *health,
                                            struct orl_rgb ret_groups[ORL_MAP_BATCHES])
{
    const struct orl_lit_scene *lit_scene = backward->lit_scene;
    struct orl_shading_point place = {
        .point = orl_offset_from_surface(lit_scene->geometry, position, normal), .normal = normal};
    place.outside = orl_lit_scene_is_outside(lit_scene, place.point);
    struct orl_ray_moments rays = {0, 0};
    for (uint32_t group = 0; group < ORL_MAP_BATCHES; group++)
        ret_groups[group] = sample_group(backward, &place, range, group, health, &rays);
    struct orl_estimate estimate = orl_estimate_of_mean(ret_groups, ORL_MAP_BATCHES);
    estimate.rays = rays;
    return estimate;
}
