/* Rays that gather: what they meet, how it is lit, and where they go on. */
#include "photon/density/records.h"
#include "render/gather/icache.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 4 };
enum { NEIGHBOURS_CAUSTIC_RELIT = 32 }; /* seen by one ray of many: noise averages out */

static const double near_texels = 0.5; /* what is nearer than so many of its widths is lit again */

static const enum orl_lobes but_diffuse =
    (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);

/* Rays that are weaker are followed by lot; glass of such a transmissivity mirrors less than it
 * lets through, but towards grazing. */
static const double dim = 0.2, clear_glass = 0.5;

/* A diffuse surface that a ray met, lit by shadow rays and caustic photons. */
static struct orl_rgb lit_again(const struct orl_gather *gather, const struct orl_hit *hit,
                                const struct orl_footing *footing, struct orl_random *random,
                                struct orl_search *search, struct orl_tally *tally)
{
    const struct orl_vec3 lit = footing->normal;
    const struct orl_direct_query query = {.point =
                                               orl_hit_leave(gather->world->geometry, hit, lit),
                                           .normal = lit,
                                           .through_ports = true};
    const struct orl_density caustic =
        orl_gather_caustic_by(gather, footing, NEIGHBOURS_CAUSTIC_RELIT, search);
    tally->parts[ORL_MAP_CAUSTIC] = caustic.parts;
    return orl_rgb_add(orl_direct_light(gather->world, &query, random), caustic.irradiance);
}

/*
 * The irradiance that a ray finds where it meets a diffuse surface: from a map, or lit again when
 * near or, which *relit then says, crowded. The tally takes its parts.
 */
static struct orl_rgb met_irradiance(const struct orl_gather *gather, const struct orl_hit *hit,
                                     bool *relit, bool roughly, struct orl_random *random,
                                     struct orl_search *search, struct orl_tally *tally)
{
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    const struct orl_footing footing = {gather->world, hit->point, lit, hit->facet};
    struct orl_rgb irradiance = orl_gray(0);
    if (gather->rest == ORL_REST_RECORDS) {
        const struct orl_density rest =
            roughly && gather->maps[ORL_MAP_PRECOMPUTED]
                ? orl_records_glance(gather->maps[ORL_MAP_PRECOMPUTED], &footing,
                                     gather->max_radius[ORL_MAP_PRECOMPUTED], search)
                : orl_gather_rest(gather, &footing, search);
        tally->parts[ORL_MAP_PRECOMPUTED] = rest.parts;
        irradiance = rest.irradiance;
    } else if (gather->leaves && !*relit) {
        irradiance = orl_leaves_irradiance(gather->leaves, hit->point, lit, &footing, search,
                                           &tally->parts[ORL_MAP_GLOBAL], relit);
    }
    if (*relit || gather->rest != ORL_REST_GATHERED)
        irradiance =
            orl_rgb_add(lit_again(gather, hit, &footing, random, search, tally), irradiance);
    return irradiance;
}

/* What the surface sends back of it along the ray; photons are of no colour of their own. */
static struct orl_rgb send_back(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                                struct orl_rgb weight, struct orl_rgb irradiance,
                                const struct orl_tally *met)
{
    const struct orl_rgb sent = orl_rgb_mul(weight, irradiance);
    const double luma = orl_luma(irradiance);
    for (int kind = 0; kind < ORL_MAP_KINDS && ray->tally && luma > 0; kind++)
        if (gather->maps[kind])
            orl_batches_add(&ray->tally->parts[kind], &met->parts[kind],
                            ray->share * orl_luma(sent) / luma);
    return sent;
}

struct orl_rgb orl_gather_read(const struct orl_gather_ray *ray, const struct orl_glimpse *glimpse)
{
    const struct orl_texel *texel = glimpse->texel;
    const struct orl_rgb irradiance = {(double)texel->irradiance[0], (double)texel->irradiance[1],
                                       (double)texel->irradiance[2]};
    const struct orl_rgb sent = orl_rgb_mul(glimpse->weight, irradiance);
    const double share = ray->share * orl_luma(sent) / UINT8_MAX;
    for (int b = 0; b < ORL_MAP_BATCHES && ray->tally; b++)
        ray->tally->parts[ORL_MAP_GLOBAL].luma[b] += share * texel->parts[b];
    return sent;
}

/* By a texel: at once, or as a glimpse. */
static struct orl_rgb send_back_texel(const struct orl_gather_ray *ray, struct orl_rgb weight,
                                      const struct orl_texel *texel)
{
    const struct orl_glimpse glimpse = {texel, weight};
    if (!ray->ret_glimpse || ray->ret_glimpse->texel)
        return orl_gather_read(ray, &glimpse);
    *ray->ret_glimpse = glimpse;
    __builtin_prefetch(texel);
    return orl_gray(0);
}

/*
 * The same of a surface that is met near, where records know the rest that it is lit by; false
 * where they do not. They may know of one reflection more than the plan counts: next to nothing.
 */
static bool known_radiance(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                           const struct orl_hit *hit, struct orl_rgb weight,
                           struct orl_random *random, struct orl_search *search,
                           struct orl_rgb *ret_radiance)
{
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    const struct orl_place place = {.point = orl_hit_leave(gather->world->geometry, hit, lit),
                                    .normal = lit};
    struct orl_cached rest;
    if (!ray->known || !orl_icache_lookup(ray->known, &place, &rest))
        return false;
    const struct orl_footing footing = {gather->world, hit->point, lit, hit->facet};
    const struct orl_rgb diffuse = orl_material_diffuse(orl_world_material(gather->world, hit));
    const struct orl_rgb reflected = orl_rgb_scale(orl_rgb_mul(weight, diffuse), 1 / ORL_PI);
    struct orl_tally met = {.known = 0};
    const struct orl_rgb direct = lit_again(gather, hit, &footing, random, search, &met);
    if (ray->tally)
        ray->tally->known += ray->share * orl_luma(reflected) * rest.standard_error;
    *ret_radiance = orl_rgb_add(send_back(gather, ray, reflected, direct, &met),
                                orl_rgb_mul(reflected, rest.irradiance));
    return true;
}

/*
 * The diffuse part of what a ray of that weight sees of a surface, but for the glossy one; *relit:
 * lit again, as what is near is to be, and as it then turns out to have been.
 */
static struct orl_rgb diffuse_radiance(const struct orl_gather *gather,
                                       const struct orl_gather_ray *ray, const struct orl_hit *hit,
                                       struct orl_rgb weight, bool *relit,
                                       struct orl_random *random, struct orl_search *search)
{
    const struct orl_rgb diffuse = orl_material_diffuse(orl_world_material(gather->world, hit));
    const struct orl_rgb reflected = orl_rgb_scale(orl_rgb_mul(weight, diffuse), 1 / ORL_PI);
    if (ray->by_texels && gather->texels && !*relit && orl_texels_has(gather->texels, hit->facet)) {
        bool cut;
        const struct orl_texel *texel =
            orl_texels_at(gather->texels, hit->facet, hit->front, hit->point, &cut);
        if (!cut)
            return texel ? send_back_texel(ray, reflected, texel) : orl_gray(0);
    }
    struct orl_tally met = {.known = 0};
    const struct orl_rgb irradiance =
        met_irradiance(gather, hit, relit, ray->by_texels, random, search, &met);
    return send_back(gather, ray, reflected, irradiance, &met);
}

/*
 * What a surface shines and, to a ray that is to find caustics itself, what its lobes send on of
 * suns and lights.
 */
static struct orl_rgb shining_radiance(const struct orl_world *world, const struct orl_hit *hit,
                                       struct orl_vec3 eye, bool caustics, struct orl_chance chance,
                                       struct orl_random *random)
{
    const struct orl_material *m = orl_world_material(world, hit);
    const struct orl_chance found = orl_chance_found();
    struct orl_rgb sum = orl_shining(world, hit, eye, caustics ? &chance : &found);
    if (caustics && orl_material_has_lobes(m))
        sum = orl_rgb_add(sum, orl_direct_by_lobes(world, hit, m, eye, random));
    return sum;
}

/* What is met closer than that is not read from the map. */
static double near_of(const struct orl_gather *gather, bool by_texels, const struct orl_hit *hit)
{
    return by_texels && gather->texels && orl_texels_has(gather->texels, hit->facet)
               ? near_texels * orl_texels_width(gather->texels, hit->facet, hit->front)
               : gather->near;
}

static struct orl_scatter scatter_evenly(const struct orl_gather *gather,
                                         const struct orl_even *even, const struct orl_material *m,
                                         const struct orl_hit *hit, struct orl_vec3 eye,
                                         enum orl_lobes lobes)
{
    double u[ORL_SOBOL_DIMENSIONS];
    orl_sobol_point(&gather->sobol, even->index, even->sequence, even->skip + 3, u);
    return orl_scatter_sample_at(m, hit, eye, ORL_TRANSPORT_EYE, lobes, u + even->skip);
}

/* A ray on its way. */
struct leg {
    struct orl_vec3 origin, direction;
    struct orl_rgb weight, clarity;
    struct orl_chance chance;
    uint32_t reflections; /* diffuse ones */
    int bounce;
    bool outside, caustics;
    bool clear; /* nothing is in its way to the domes */
};

/* Sent on by a surface. */
static void send_on(const struct orl_world *world, struct leg *leg, const struct orl_hit *hit,
                    const struct orl_scatter *s)
{
    const struct orl_vec3 eye = orl_neg(leg->direction);
    leg->chance = s->event == ORL_EVENT_GLOSSY && !leg->caustics
                      ? orl_chance_unsought()
                      : orl_chance_after(world, hit, eye, s, leg->chance);
    leg->reflections += s->event == ORL_EVENT_DIFFUSE;
    leg->caustics = leg->caustics && s->event != ORL_EVENT_DIFFUSE;
    leg->clear = s->transmitted && orl_world_leaves_clear(world, hit);
    leg->outside =
        s->transmitted && !world->open && orl_world_crossing(world, hit) == ORL_CROSSING_OUTWARDS;
    leg->clarity = orl_scatter_clarity(orl_world_material(world, hit), s, leg->clarity);
    leg->origin = orl_hit_leave(world->geometry, hit, s->direction);
    leg->direction = s->direction;
    leg->bounce++;
}

/* Dim lobes and long chains end by roulette: whether it goes on. */
static bool survives(struct leg *leg, struct orl_random *random)
{
    const double survive = fmin(orl_rgb_max(leg->weight), 1.0);
    if (leg->bounce < SURE_BOUNCES && survive >= dim)
        return true;
    if (orl_random_uniform(random) >= survive)
        return false;
    leg->weight = orl_rgb_scale(leg->weight, 1 / survive);
    return true;
}

/*
 * Whether both ways are followed, back and through: of a pane that is darker to look through than
 * it mirrors, or lets and sends hardly any light on. What is behind may be a hundred times as
 * bright as the room, and then the few rays that chance lets through are most of the light.
 */
static bool is_dim_pane(const struct orl_material *m, const struct orl_hit *hit,
                        struct orl_vec3 eye)
{
    if (!orl_material_is_window(m) || m->kind == ORL_MATERIAL_DIELECTRIC ||
        (m->kind == ORL_MATERIAL_GLASS && orl_rgb_max(m->transmissivity) > clear_glass))
        return false;
    const double through = orl_luma(orl_material_albedo(m, hit, eye, ORL_LOBE_TRANSMITTED));
    const double back = orl_luma(orl_material_albedo(m, hit, eye, ORL_LOBE_REFLECTED));
    return through > 0 && (through < back || through + back < dim);
}

/* What a surface does with it: with its first one evenly, if asked. */
static struct orl_scatter scatter(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                                  const struct leg *leg, const struct orl_hit *hit,
                                  enum orl_lobes lobes, struct orl_random *random)
{
    const struct orl_material *m = orl_world_material(gather->world, hit);
    const struct orl_vec3 eye = orl_neg(leg->direction);
    return leg->bounce == 0 && ray->first
               ? scatter_evenly(gather, ray->first, m, hit, eye, lobes)
               : orl_scatter_sample(m, hit, eye, ORL_TRANSPORT_EYE, lobes, random);
}

/* The way through a dim pane. */
static void look_through(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                         const struct leg *leg, const struct orl_hit *hit,
                         struct orl_random *random, struct leg *ret_through)
{
    const struct orl_scatter s = scatter(gather, ray, leg, hit, ORL_LOBE_TRANSMITTED, random);
    if (s.event == ORL_EVENT_ABSORBED)
        return;
    *ret_through = *leg;
    ret_through->weight = orl_rgb_mul(leg->weight, s.weight);
    send_on(gather->world, ret_through, hit, &s);
}

/* The diffuse light of a surface that a leg meets; ret_relit: it goes on to find more of it. */
static struct orl_rgb met_diffuse(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                                  const struct leg *leg, const struct orl_hit *hit,
                                  struct orl_random *random, struct orl_search *search,
                                  bool *ret_relit)
{
    struct orl_rgb sent = orl_gray(0);
    const bool near = hit->distance < near_of(gather, ray->by_texels, hit);
    *ret_relit = near && !known_radiance(gather, ray, hit, leg->weight, random, search, &sent);
    return *ret_relit || !near
               ? diffuse_radiance(gather, ray, hit, leg->weight, ret_relit, random, search)
               : sent;
}

/* It goes on outdoors, and in again: true; else it has ended there, its light in the sum. */
static bool comes_in(const struct orl_world *world, struct leg *leg, struct orl_random *random,
                     struct orl_health *health, struct orl_rgb *sum)
{
    struct orl_entry entry;
    const struct orl_rgb seen = orl_exterior_radiance(world, leg->origin, leg->direction,
                                                      leg->chance, random, health, &entry);
    *sum = orl_rgb_add(*sum, orl_rgb_mul(leg->weight, seen));
    if (!entry.entered)
        return false;
    leg->weight = orl_rgb_mul(leg->weight, entry.weight);
    leg->clarity = entry.clarity;
    leg->chance = entry.chance;
    leg->origin = entry.origin;
    leg->direction = entry.direction;
    leg->outside = false;
    return true;
}

/*
 * Follows a leg to its end. ret_through takes the other one, where the first surface is a dim pane:
 * then it is no longer at bounce 0.
 */
static struct orl_rgb follow(const struct orl_gather *gather, const struct orl_gather_ray *ray,
                             struct leg leg, struct leg *ret_through, struct orl_random *random,
                             struct orl_search *search)
{
    const struct orl_world *world = gather->world;
    struct orl_rgb sum = orl_gray(0);
    while (leg.bounce < MOST_BOUNCES) {
        struct orl_hit hit;
        bool relit = false;
        if (leg.clear)
            return orl_rgb_add(
                sum, orl_rgb_mul(leg.weight, orl_world_dome_radiance(world, leg.direction)));
        if (leg.outside && !comes_in(world, &leg, random, &search->health, &sum))
            return sum;
        search->health.rays++;
        if (!orl_geometry_intersect(world->geometry, leg.origin, leg.direction, INFINITY, &hit)) {
            search->health.rays_leaked += !world->open;
            leg.weight = orl_rgb_mul(leg.weight, orl_clarity_after(leg.clarity, INFINITY));
            return orl_rgb_add(
                sum, orl_rgb_mul(leg.weight, orl_world_dome_radiance(world, leg.direction)));
        }
        if (leg.bounce == 0 && !ray->outside && ray->ret_distance)
            *ray->ret_distance = hit.distance;
        const struct orl_material *m = orl_world_material(world, &hit);
        const struct orl_vec3 eye = orl_neg(leg.direction);
        const bool diffuse = orl_rgb_max(orl_material_diffuse(m)) > 0 &&
                             leg.reflections < world->omit.most_reflections;
        leg.weight = orl_rgb_mul(leg.weight, orl_material_dimming(m, &hit, leg.clarity));
        sum = orl_rgb_add(
            sum, orl_rgb_mul(leg.weight,
                             shining_radiance(world, &hit, eye, leg.caustics, leg.chance, random)));
        if (diffuse)
            sum = orl_rgb_add(sum, met_diffuse(gather, ray, &leg, &hit, random, search, &relit));
        if (diffuse && !relit && orl_material_is_matt(m))
            return sum;
        enum orl_lobes lobes = relit ? ORL_LOBE_ALL : but_diffuse;
        if (leg.bounce == 0 && is_dim_pane(m, &hit, eye)) {
            look_through(gather, ray, &leg, &hit, random, ret_through);
            lobes = (enum orl_lobes)((uint32_t)lobes & ~(uint32_t)ORL_LOBE_TRANSMITTED);
        }
        const struct orl_scatter s = scatter(gather, ray, &leg, &hit, lobes, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return sum;
        leg.weight = orl_rgb_mul(leg.weight, s.weight);
        if (!survives(&leg, random))
            return sum;
        send_on(world, &leg, &hit, &s);
    }
    search->health.paths_capped++;
    return sum;
}

static struct orl_rgb trace_gather(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    const struct leg first = {.origin = ray->origin,
                              .direction = ray->direction,
                              .weight = orl_gray(1),
                              .clarity = orl_gray(1),
                              .chance = ray->of_lobe ? *ray->of_lobe : orl_chance_found(),
                              .outside = ray->outside,
                              .caustics = ray->of_lobe != NULL};
    struct leg through = {.bounce = 0};
    search->health.paths++;
    const struct orl_rgb sum = follow(gather, ray, first, &through, random, search);
    return through.bounce == 0
               ? sum
               : orl_rgb_add(sum, follow(gather, ray, through, NULL, random, search));
}

struct orl_rgb orl_gather_radiance(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    return orl_health_keep(&search->health, trace_gather(gather, ray, random, search));
}
