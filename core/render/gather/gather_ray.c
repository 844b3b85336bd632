/* Rays of a final gather: the surfaces they meet, the light there, and their continuation. */
#include "render/gather/direction_sampling.h"
#include "render/gather/icache.h"
#include "scene/material/kinds.h"

enum { SURE_BOUNCES = 4 };
/* Smaller, because one ray of many sees it and noise averages out. */
enum { NEIGHBOURS_CAUSTIC_RELIT = 32 };

/* Surfaces nearer than this many texel widths are lit again. */
static const double near_texels = 0.5;

static const enum orl_lobes but_diffuse =
    (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);

/* Rays weaker than `dim` undergo Russian roulette. Glass of this transmissivity transmits more than
 * it reflects, except near grazing angles. */
static const double dim = 0.2, clear_glass = 0.5, half = 0.5;

/* Returns the irradiance of a diffuse surface that a ray met, by shadow rays and caustic
 * photons. */
static struct orl_rgb relight_surface(const struct orl_gather *gather, const struct orl_hit *hit,
                                      const struct orl_surface_point *surface_point,
                                      struct orl_random *random, struct orl_search *search,
                                      struct orl_tally *tally)
{
    const struct orl_vec3 lit = surface_point->normal;
    const struct orl_direct_query query = {
        .point = orl_hit_ray_origin(gather->lit_scene->geometry, hit, lit),
        .normal = lit,
        .through_ports = true};
    const struct orl_density caustic =
        orl_gather_caustic_k(gather, surface_point, NEIGHBOURS_CAUSTIC_RELIT, search);
    tally->parts[ORL_MAP_CAUSTIC] = caustic.parts;
    return orl_rgb_add(orl_direct_light(gather->lit_scene, &query, random), caustic.irradiance);
}

/* Returns the irradiance of a diffuse surface that a ray met: from a map, or lit again if it is
 * near or the map is unreliable there. *relit: in: near; out: lit again. The tally receives its
 * parts. */
static struct orl_rgb met_irradiance(const struct orl_gather *gather, const struct orl_hit *hit,
                                     bool *relit, bool roughly, struct orl_random *random,
                                     struct orl_search *search, struct orl_tally *tally)
{
    const struct orl_vec3 lit = orl_hit_facing(hit);
    const struct orl_surface_point surface_point = {gather->lit_scene, hit->point, lit, hit->facet};
    struct orl_rgb irradiance =
        gather->indirect->at_hit(gather, &surface_point, roughly, relit, search, tally);
    if (*relit || !gather->indirect->gathered)
        irradiance = orl_rgb_add(
            relight_surface(gather, hit, &surface_point, random, search, tally), irradiance);
    return irradiance;
}

/* Returns the radiance that the surface reflects along the ray. Photons are taken to have the
 * irradiance's colour. */
static struct orl_rgb reflect_irradiance(const struct orl_gather *gather,
                                         const struct orl_gather_ray *ray, struct orl_rgb weight,
                                         struct orl_rgb irradiance, const struct orl_tally *met)
{
    const struct orl_rgb sent = orl_rgb_mul(weight, irradiance);
    const double luma = orl_luma(irradiance);
    for (int kind = 0; kind < ORL_MAP_KINDS && ray->tally && luma > 0; kind++)
        if (gather->maps[kind])
            orl_batches_add(&ray->tally->parts[kind], &met->parts[kind],
                            ray->share * orl_luma(sent) / luma);
    return sent;
}

struct orl_rgb orl_gather_read_texel(const struct orl_gather_ray *ray,
                                     const struct orl_texel_fetch *fetch)
{
    const struct orl_texel *texel = fetch->texel;
    const struct orl_rgb irradiance = {(double)texel->irradiance[0], (double)texel->irradiance[1],
                                       (double)texel->irradiance[2]};
    const struct orl_rgb sent = orl_rgb_mul(fetch->weight, irradiance);
    const double share = ray->share * orl_luma(sent) / UINT8_MAX;
    for (int b = 0; b < ORL_MAP_BATCHES && ray->tally; b++)
        ray->tally->parts[ORL_MAP_GLOBAL].luma[b] += share * texel->parts[b];
    return sent;
}

/* Reads a texel at once, or stores it in the ray's ret_fetch for later. */
static struct orl_rgb reflect_texel(const struct orl_gather_ray *ray, struct orl_rgb weight,
                                    const struct orl_texel *texel)
{
    const struct orl_texel_fetch fetch = {texel, weight};
    if (!ray->ret_fetch || ray->ret_fetch->texel)
        return orl_gather_read_texel(ray, &fetch);
    *ray->ret_fetch = fetch;
    __builtin_prefetch(texel);
    return orl_gray(0);
}

/* Computes the reflected radiance of a near surface from cached records. Returns false if there are
 * none. The records may include one reflection more than the plan counts, which is negligible. */
static bool cached_radiance(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                            const struct orl_hit *hit, struct orl_rgb weight,
                            struct orl_random *random, struct orl_search *search,
                            struct orl_rgb *ret_radiance)
{
    const struct orl_vec3 lit = orl_hit_facing(hit);
    const struct orl_shading_point place = {
        .point = orl_hit_ray_origin(gather->lit_scene->geometry, hit, lit), .normal = lit};
    struct orl_cached_irradiance indirect;
    if (!ray->reads_records || !orl_icache_lookup(ray->icache, &place, &indirect))
        return false;
    const struct orl_surface_point surface_point = {gather->lit_scene, hit->point, lit, hit->facet};
    const struct orl_rgb diffuse =
        orl_material_diffuse(orl_lit_scene_material(gather->lit_scene, hit), hit);
    const struct orl_rgb reflected = orl_rgb_scale(orl_rgb_mul(weight, diffuse), 1 / ORL_PI);
    struct orl_tally met = {.record_error = 0};
    const struct orl_rgb direct =
        relight_surface(gather, hit, &surface_point, random, search, &met);
    if (ray->tally)
        ray->tally->record_error += ray->share * orl_luma(reflected) * indirect.standard_error;
    *ret_radiance = orl_rgb_add(reflect_irradiance(gather, ray, reflected, direct, &met),
                                orl_rgb_mul(reflected, indirect.irradiance));
    return true;
}

/* Returns the diffuse radiance of a surface along a ray of that weight. *relit: in: must be lit
 * again, because it is near; out: was lit again. */
static struct orl_rgb diffuse_radiance(const struct orl_gather *gather,
                                       const struct orl_gather_ray *ray, const struct orl_hit *hit,
                                       struct orl_rgb weight, bool *relit,
                                       struct orl_random *random, struct orl_search *search)
{
    const struct orl_rgb diffuse =
        orl_material_diffuse(orl_lit_scene_material(gather->lit_scene, hit), hit);
    const struct orl_rgb reflected = orl_rgb_scale(orl_rgb_mul(weight, diffuse), 1 / ORL_PI);
    if (ray->reads_texels && gather->texels && !*relit &&
        orl_texels_has(gather->texels, hit->facet)) {
        bool cut;
        const struct orl_texel *texel =
            orl_texels_at(gather->texels, hit->facet, hit->front, hit->point, &cut);
        if (!cut)
            return texel ? reflect_texel(ray, reflected, texel) : orl_gray(0);
    }
    struct orl_tally met = {.record_error = 0};
    const struct orl_rgb irradiance =
        met_irradiance(gather, hit, relit, ray->reads_texels, random, search, &met);
    return reflect_irradiance(gather, ray, reflected, irradiance, &met);
}

/* Returns the radiance that a surface emits. For a ray that must find caustics itself it adds suns
 * and lights by the surface's lobes. */
static struct orl_rgb emitted_radiance(const struct orl_lit_scene *lit_scene,
                                       const struct orl_hit *hit, struct orl_vec3 eye,
                                       bool caustics, struct orl_mis_pdf chance,
                                       struct orl_random *random)
{
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    const struct orl_mis_pdf found = orl_mis_pdf_zero();
    struct orl_rgb sum = orl_emitted_radiance(lit_scene, hit, eye, caustics ? &chance : &found);
    if (caustics && orl_material_has_lobes(m))
        sum = orl_rgb_add(sum, orl_direct_by_lobes(lit_scene, hit, m, eye, random));
    return sum;
}

/* Returns the distance below which a surface is not read from the map. */
static double near_of(const struct orl_gather *gather, bool reads_texels, const struct orl_hit *hit)
{
    return reads_texels && gather->texels && orl_texels_has(gather->texels, hit->facet)
               ? near_texels * orl_texels_width(gather->texels, hit->facet, hit->front)
               : gather->near;
}

/* ---- Tracing a ray --------------------------------------------------------------------------- */

/* State of a ray as it is traced. */
struct leg {
    struct orl_eye_path eye; /* must be first: the visitor receives a pointer to it */
    const struct orl_gather *gather;
    const struct orl_gather_ray *ray;
    struct orl_search *search;
    struct leg *through;     /* receives the other branch if the first surface is a dim pane */
    uint32_t reflections;    /* number of diffuse reflections */
    bool caustics;           /* true if it must find caustics itself */
    bool importance_sampled; /* true if matt surfaces draw importance-sampled rays */
    double by_cosine;        /* pdf of its direction if port rays compete with it; else 0 */
    bool weighed; /* by the balance heuristic: a small weight is then no reason for roulette */
};

static struct leg *leg_of(struct orl_eye_path *p)
{
    return (struct leg *)p;
}

/* Continues outdoors. Returns true if the ray comes in again. */
static bool continue_outdoors(struct orl_eye_path *p)
{
    return orl_exterior_continue(p, &leg_of(p)->search->health);
}

static void count_leak(struct orl_eye_path *p)
{
    struct orl_health *health = &leg_of(p)->search->health;
    health->rays++;
    health->rays_leaked += !p->lit_scene->open;
}

/*
 * Returns true if both ways are followed, reflected and transmitted: at a pane that reflects more
 * than it transmits, or does little of either. The scene behind may be a hundred times as bright as
 * the room; the few rays transmitted by chance would then carry most of the light.
 */
static bool is_dim_pane(const struct orl_material *m, const struct orl_hit *hit,
                        struct orl_vec3 eye)
{
    if (!orl_material_is_window(m) || orl_material_deviates(m) ||
        (m->kind == ORL_MATERIAL_GLASS &&
         orl_rgb_max(orl_glass_of(m)->transmissivity) > clear_glass))
        return false;
    const double through = orl_luma(orl_material_albedo(m, hit, eye, ORL_LOBE_TRANSMITTED));
    /* No pane reflects more than it does not transmit. */
    if (!(through > 0) || through > half)
        return false;
    const double back = orl_luma(orl_material_albedo(m, hit, eye, ORL_LOBE_REFLECTED));
    return through < back || through + back < dim;
}

/* Samples the lobes of a surface; stratified at the first one if the ray asks for it. */
static struct orl_surface_sample draw_by_lobes(struct orl_eye_path *p, const struct orl_material *m,
                                               enum orl_lobes lobes)
{
    const struct leg *leg = leg_of(p);
    const struct orl_sobol_slice *slice = leg->ray->slice;
    const struct orl_vec3 eye = orl_path_back(&p->path);
    double u[ORL_SOBOL_DIMENSIONS];
    if (p->bounce > 0 || !leg->ray->stratified)
        return orl_material_sample(m, &p->hit, eye, ORL_TRANSPORT_EYE, lobes, p->random);
    orl_sobol_point(&leg->gather->sobol, slice->index, slice->sequence, slice->skip + 3, u);
    return orl_material_sample_at(m, &p->hit, eye, ORL_TRANSPORT_EYE, lobes, u + slice->skip);
}

static void note_event(struct leg *leg, const struct orl_surface_sample *s)
{
    struct orl_eye_path *p = &leg->eye;
    /* For rays that need not find caustics, photons bring the light of lamps by lobes, mirrors and
     * dielectrics. That includes lamps outside, which a ray sees beyond a port. */
    p->chance =
        !leg->caustics && s->event != ORL_EVENT_DIFFUSE
            ? orl_mis_pdf_zero_straight()
            : orl_mis_pdf_update(p->lit_scene, &p->hit, orl_path_back(&p->path), s, p->chance);
    leg->reflections += s->event == ORL_EVENT_DIFFUSE;
    leg->caustics = leg->caustics && s->event != ORL_EVENT_DIFFUSE;
    leg->weighed = leg->weighed && s->event != ORL_EVENT_DIFFUSE;
    orl_eye_path_cross_port(p, s);
}

/* Starts the branch through a dim pane. */
static void branch_through_pane(const struct leg *leg, const struct orl_material *m)
{
    struct leg *through = leg->through;
    struct orl_eye_path *p = &through->eye;
    *through = *leg;
    const struct orl_surface_sample s = draw_by_lobes(p, m, ORL_LOBE_TRANSMITTED);
    if (s.event == ORL_EVENT_ABSORBED)
        return;
    p->seen = orl_gray(0);
    p->path.weight = orl_rgb_mul(p->path.weight, s.weight);
    note_event(through, &s);
    orl_path_spawn_ray(&p->path, p->lit_scene, &p->hit, &s);
    p->bounce++;
}

/*
 * At a matt surface that is lit again, ports, small mirrors and lenses may be in few directions and
 * send most of the light. By each of these strategies (direction_sampling.h) such a surface draws
 * one ray with a probability of a quarter, in addition to the ray that continues. Such a ray counts
 * if it meets its goal first. All rays are weighed by the multi-sample balance heuristic (Veach
 * 1997, section 9.2).
 */
static const struct orl_strategy_counts sampled_counts = {
    {[ORL_SAMPLE_PORT] = 0.25, [ORL_SAMPLE_TARGET] = 0.25}};

/* Returns the weight of a ray from a matt surface by the balance heuristic; by_cosine: its density
 * by the cosine. */
static double weight_of(const struct leg *leg, struct orl_vec3 from,
                        const struct orl_direction_sample *ray, double by_cosine)
{
    const struct orl_direction_sampler *const sampler = leg->gather->sampler;
    const struct orl_strategy_counts ray_counts =
        orl_direction_sampler_counts(sampler, sampled_counts);
    return by_cosine /
           (by_cosine + orl_direction_pdf(sampler, &ray_counts, from, orl_v3(0, 0, 0), ray));
}

static void follow_leg(struct leg *leg);

/* Aims a ray in one of the ways and adds the light that it finds; drawn: the ray that goes on. */
static void trace_sampled_ray(struct leg *leg, enum orl_strategy strategy,
                              const struct orl_surface_sample *drawn)
{
    struct orl_eye_path *p = &leg->eye;
    const struct orl_lit_scene *lit_scene = p->lit_scene;
    const struct orl_vec3 normal = orl_hit_facing(&p->hit);
    const struct orl_vec3 from = orl_hit_ray_origin(lit_scene->geometry, &p->hit, normal);
    struct orl_surface_sample s = *drawn;
    struct orl_direction_sample ray;
    const double which = orl_random_uniform(p->random), u0 = orl_random_uniform(p->random);
    const double u[3] = {u0, orl_random_uniform(p->random), which};
    if (!orl_direction_trace(leg->gather->sampler, strategy, from, normal, u, &ray))
        return;
    s.direction = ray.direction;
    struct leg at_target = *leg;
    struct orl_eye_path *q = &at_target.eye;
    at_target.importance_sampled = false;
    q->seen = orl_gray(0);
    const double by_cosine = orl_dot(s.direction, normal) / ORL_PI;
    q->path.weight =
        orl_rgb_mul(q->path.weight, orl_rgb_scale(s.weight, weight_of(leg, from, &ray, by_cosine)));
    note_event(&at_target, &s);
    at_target.weighed = true;
    orl_path_spawn_ray(&q->path, lit_scene, &q->hit, &s);
    orl_eye_path_set_next_hit(q, &ray.hit);
    q->bounce++;
    follow_leg(&at_target);
    p->seen = orl_rgb_add(p->seen, q->seen);
}

/* Aims rays in all ways that the scene has targets for. */
static void trace_sampled_rays(struct leg *leg, const struct orl_surface_sample *drawn)
{
    const struct orl_strategy_counts ray_counts =
        orl_direction_sampler_counts(leg->gather->sampler, sampled_counts);
    for (int strategy = 0; strategy < ORL_STRATEGIES; strategy++)
        if (ray_counts.rays[strategy] > 0 &&
            orl_random_uniform(leg->eye.random) < ray_counts.rays[strategy])
            trace_sampled_ray(leg, (enum orl_strategy)strategy, drawn);
}

static struct orl_surface_sample
draw_continuation(struct orl_eye_path *p, const struct orl_material *m, enum orl_lobes lobes)
{
    struct leg *leg = leg_of(p);
    const struct orl_surface_sample s = draw_by_lobes(p, m, lobes);
    if (!leg->importance_sampled || p->outside || s.event != ORL_EVENT_DIFFUSE || s.transmitted ||
        !orl_material_is_matt(m))
        return s;
    trace_sampled_rays(leg, &s);
    leg->by_cosine = orl_dot(s.direction, orl_hit_facing(&p->hit)) / ORL_PI;
    return s;
}

/* Returns the diffuse light of a surface that a leg meets. *ret_relit: the leg must continue to
 * find the rest of it. */
static struct orl_rgb met_diffuse(const struct leg *leg, bool *ret_relit)
{
    const struct orl_gather *gather = leg->gather;
    const struct orl_hit *hit = &leg->eye.hit;
    const struct orl_rgb weight = leg->eye.path.weight;
    struct orl_random *random = leg->eye.random;
    struct orl_rgb sent = orl_gray(0);
    const bool near = hit->distance < near_of(gather, leg->ray->reads_texels, hit);
    *ret_relit =
        near && !cached_radiance(gather, leg->ray, hit, weight, random, leg->search, &sent);
    return *ret_relit || !near
               ? diffuse_radiance(gather, leg->ray, hit, weight, ret_relit, random, leg->search)
               : sent;
}

/* Applies the balance heuristic to a ray from a matt surface, by what it meets first. */
static void weigh_leg(struct leg *leg)
{
    struct orl_eye_path *p = &leg->eye;
    const struct orl_direction_sample ray = {
        .direction = p->path.direction, .met = true, .hit = p->hit};
    const struct orl_vec3 from = orl_madd(p->hit.point, ray.direction, -p->hit.distance);
    const double weight = weight_of(leg, from, &ray, leg->by_cosine);
    p->path.weight = orl_rgb_scale(p->path.weight, weight);
    leg->by_cosine = 0;
    leg->weighed = weight < 1;
}

/* Adds what the surface emits and reflects. Returns the lobes that the maps do not account for. */
static enum orl_lobes shade_surface(struct orl_eye_path *p, const struct orl_material *m)
{
    struct leg *leg = leg_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    const bool diffuse = orl_rgb_max(orl_material_diffuse(m, &p->hit)) > 0 &&
                         leg->reflections < p->lit_scene->omit.most_reflections;
    bool relit = false;
    leg->search->health.rays++;
    if (leg->by_cosine > 0)
        weigh_leg(leg);
    if (p->bounce == 0 && !leg->ray->outside && leg->ray->ret_distance)
        *leg->ray->ret_distance = p->hit.distance;
    orl_eye_path_add_radiance(
        p, emitted_radiance(p->lit_scene, &p->hit, eye, leg->caustics, p->chance, p->random));
    if (diffuse)
        p->seen = orl_rgb_add(p->seen, met_diffuse(leg, &relit));
    if (diffuse && !relit && orl_material_is_matt(m))
        return ORL_LOBE_NONE;
    const enum orl_lobes lobes = relit ? ORL_LOBE_ALL : but_diffuse;
    if (p->bounce > 0 || !is_dim_pane(m, &p->hit, eye))
        return lobes;
    branch_through_pane(leg, m);
    return (enum orl_lobes)((uint32_t)lobes & ~(uint32_t)ORL_LOBE_TRANSMITTED);
}

/* Applies roulette to dim lobes and long chains. Returns false if the leg ends. */
static bool continue_leg(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    const double survive = fmin(orl_rgb_max(p->path.weight), 1.0);
    if (!leg_of(p)->weighed && (p->bounce >= SURE_BOUNCES || survive < dim) &&
        !orl_path_roulette(&p->path, survive, p->random))
        return false;
    note_event(leg_of(p), s);
    return true;
}

static const struct orl_path_visitor visitor = {.on_outdoors = continue_outdoors,
                                                .escaped = count_leak,
                                                .met = shade_surface,
                                                .draw = draw_continuation,
                                                .on_sampled = continue_leg};

static void follow_leg(struct leg *leg)
{
    orl_eye_path_trace(&leg->eye, &visitor, &leg->search->health);
}

static struct orl_rgb trace_gather(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    struct leg through;
    through.eye.bounce = 0;
    struct leg leg = {
        .eye = {.lit_scene = gather->lit_scene,
                .random = random,
                .path = orl_path_from(ray->origin, ray->direction),
                .chance = ray->finds_caustics ? ray->lobe_mis_pdf : orl_mis_pdf_zero(),
                .outside = ray->outside},
        .gather = gather,
        .ray = ray,
        .search = search,
        .through = &through,
        .caustics = ray->finds_caustics,
        .importance_sampled = ray->importance_sampled && !gather->lit_scene->scene->mist};
    search->health.paths++;
    if (ray->first_hit != ORL_FIRST_HIT_UNKNOWN)
        orl_eye_path_set_next_hit(&leg.eye,
                                  ray->first_hit == ORL_FIRST_HIT_SURFACE ? ray->hit : NULL);
    follow_leg(&leg);
    if (through.eye.bounce == 0)
        return leg.eye.seen;
    follow_leg(&through);
    return orl_rgb_add(leg.eye.seen, through.eye.seen);
}

struct orl_rgb orl_gather_radiance(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    return orl_health_filter(&search->health, trace_gather(gather, ray, random, search));
}
