#include "render/gather.h"

#include <stdlib.h>

#include "light/proxies.h"
#include "photon/facing.h"
#include "photon/records.h"
#include "render/icache.h"

enum { MOST_BOUNCES = 64, SURE_BOUNCES = 4 };
enum { NEIGHBOURS_CAUSTIC_RELIT = 32 }; /* seen by one ray of many: noise averages out */
enum { NEIGHBOURS_GLOBAL = 64, NEIGHBOURS_CAUSTIC = 300, NEIGHBOURS_RECORDS = 4 };
enum { RADIUS_PROBES = 256 };

/* A texel's photons, of an estimate's neighbours; and what is nearer than so many of its widths is
 * lit again. */
static const double texel_share = 0.25, near_texels = 0.5;

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The radius that k neighbours take at the map's own photons: at the median, or further out. */
static double typical_radius(const struct orl_photon_map *map, uint32_t k, double percentile,
                             double widest, struct orl_search *search)
{
    const uint64_t count = orl_photon_map_header(map)->count;
    double radii[RADIUS_PROBES];
    if (count == 0)
        return widest;
    for (uint32_t i = 0; i < RADIUS_PROBES; i++) {
        const struct orl_photon p = orl_photon_map_get(map, count * i / RADIUS_PROBES);
        const struct orl_density_query query = {
            .point = orl_v3(p.position[0], p.position[1], p.position[2]),
            .normal = orl_normal_decode(p.normal),
            .k = k,
            .max_radius = widest};
        radii[i] = orl_density_estimate(map, &query, search).radius;
    }
    qsort(radii, RADIUS_PROBES, sizeof *radii, compare_doubles);
    return radii[(int)(percentile * (RADIUS_PROBES - 1))];
}

/*
 * Dark corners may reach further than most for global photons, but not across the room. Caustics
 * end: where there are few photons a wider search would find another one's. Records are few, and
 * stand for 32 photons or more each.
 */
static void choose_radii(struct orl_gather *gather, enum orl_map_kind kind, double bandwidth,
                         double widest, struct orl_search *search)
{
    static const uint32_t neighbours[ORL_MAP_KINDS] = {NEIGHBOURS_GLOBAL, NEIGHBOURS_CAUSTIC,
                                                       NEIGHBOURS_RECORDS};
    const double k = fmax(round(bandwidth * neighbours[kind]), fmin(neighbours[kind], 8));
    gather->k[kind] = (uint32_t)fmin(k, ORL_SEARCH_MOST);
    if (!gather->maps[kind])
        return;
    const double far = typical_radius(gather->maps[kind], gather->k[kind], 0.95, widest, search);
    switch (kind) {
    case ORL_MAP_GLOBAL:
        gather->max_radius[kind] = fmin(4 * far, widest);
        gather->near = 2 * far;
        break;
    case ORL_MAP_PRECOMPUTED:
        gather->max_radius[kind] = fmin(8 * far, widest);
        break;
    default:
        gather->max_radius[kind] = fmin(far, widest);
    }
    const double near_surface = 0.25 * fmin(gather->max_radius[kind], 4 * far);
    gather->reach = gather->reach > 0 ? fmin(gather->reach, near_surface) : near_surface;
}

int orl_gather_init(struct orl_gather *gather, const struct orl_world *world, enum orl_rest rest,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS],
                    const double bandwidths[ORL_MAP_KINDS], uint64_t seed, struct orl_crew *crew,
                    struct orl_search *search)
{
    const double widest = fmax(0.1 * world->geometry->radius, 1e-9);
    const int unread = rest == ORL_REST_RECORDS ? ORL_MAP_GLOBAL : ORL_MAP_PRECOMPUTED;
    *gather = (struct orl_gather){.world = world, .rest = rest, .seed = seed};
    orl_sobol_init(&gather->sobol);
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++) {
        gather->maps[kind] = kind == unread ? NULL : maps[kind];
        choose_radii(gather, (enum orl_map_kind)kind, bandwidths ? bandwidths[kind] : 1, widest,
                     search);
    }
    if (gather->maps[ORL_MAP_GLOBAL]) {
        gather->leaves = orl_leaves_new(maps[ORL_MAP_GLOBAL], world, gather->k[ORL_MAP_GLOBAL],
                                        gather->max_radius[ORL_MAP_GLOBAL], crew);
        if (!gather->leaves)
            return ORL_ERR_NOMEM;
    }
    if (rest == ORL_REST_DENSITY && gather->maps[ORL_MAP_GLOBAL])
        return orl_adapt_init(&gather->adapt, maps[ORL_MAP_GLOBAL], widest, crew, search);
    return 0;
}

int orl_gather_for_views(struct orl_gather *gather, struct orl_crew *crew)
{
    if (gather->maps[ORL_MAP_CAUSTIC] && !gather->caustic_widths) {
        gather->caustic_widths =
            orl_spread_new(gather->maps[ORL_MAP_CAUSTIC], gather->k[ORL_MAP_CAUSTIC],
                           gather->max_radius[ORL_MAP_CAUSTIC], crew);
        if (!gather->caustic_widths)
            return ORL_ERR_NOMEM;
    }
    if (!gather->maps[ORL_MAP_GLOBAL] || gather->rest != ORL_REST_GATHERED || gather->texels)
        return 0;
    gather->texels = orl_texels_new(gather->maps[ORL_MAP_GLOBAL], gather->world,
                                    texel_share * gather->k[ORL_MAP_GLOBAL], crew);
    return gather->texels ? 0 : ORL_ERR_NOMEM;
}

void orl_gather_done(struct orl_gather *gather)
{
    orl_leaves_free(gather->leaves);
    orl_texels_free(gather->texels);
    orl_spread_free(gather->caustic_widths);
    gather->leaves = NULL;
    gather->texels = NULL;
    gather->caustic_widths = NULL;
    orl_adapt_done(&gather->adapt);
}

bool orl_gather_footing(const struct orl_gather *gather, struct orl_vec3 point,
                        struct orl_vec3 normal, struct orl_footing *ret_footing)
{
    const double rounding = gather->world->geometry->radius * 0x1p-18;
    return orl_footing_find(gather->world, point, normal, rounding, ret_footing);
}

/* The number found and the radius are the photons' of an adaptive estimate; of records they say no
 * more than that there were any. */
struct orl_density orl_gather_rest(const struct orl_gather *gather,
                                   const struct orl_footing *footing, struct orl_search *search)
{
    const struct orl_density density = {.found = 0};
    if (gather->rest == ORL_REST_DENSITY && gather->maps[ORL_MAP_GLOBAL]) {
        const struct orl_density_query query = {.point = footing->point,
                                                .normal = footing->normal,
                                                .k = ORL_ADAPT_MOST,
                                                .max_radius = gather->adapt.reach,
                                                .footing = footing};
        return orl_adapt_estimate(&gather->adapt, &query, search);
    }
    if (gather->rest == ORL_REST_RECORDS && gather->maps[ORL_MAP_PRECOMPUTED])
        return orl_records_estimate(gather->maps[ORL_MAP_PRECOMPUTED], footing,
                                    gather->max_radius[ORL_MAP_PRECOMPUTED], search);
    return density;
}

double orl_tally_variance(const struct orl_tally *tally)
{
    double variance = 0;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        variance += orl_batches_variance(&tally->parts[kind]);
    return variance + tally->known * tally->known;
}

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
 * near. The tally takes its parts.
 */
static struct orl_rgb met_irradiance(const struct orl_gather *gather, const struct orl_hit *hit,
                                     bool near, bool roughly, struct orl_random *random,
                                     struct orl_search *search, struct orl_tally *tally)
{
    const struct orl_vec3 lit = hit->front ? hit->normal : orl_neg(hit->normal);
    const struct orl_footing footing = {gather->world, hit->point, lit, hit->facet};
    struct orl_rgb irradiance = orl_gray(0);
    if (near || gather->rest != ORL_REST_GATHERED)
        irradiance = lit_again(gather, hit, &footing, random, search, tally);
    if (gather->rest == ORL_REST_RECORDS) {
        const struct orl_density rest =
            roughly && gather->maps[ORL_MAP_PRECOMPUTED]
                ? orl_records_glance(gather->maps[ORL_MAP_PRECOMPUTED], &footing,
                                     gather->max_radius[ORL_MAP_PRECOMPUTED], search)
                : orl_gather_rest(gather, &footing, search);
        tally->parts[ORL_MAP_PRECOMPUTED] = rest.parts;
        irradiance = orl_rgb_add(irradiance, rest.irradiance);
    } else if (gather->leaves && !near) {
        irradiance =
            orl_rgb_add(irradiance, orl_leaves_irradiance(gather->leaves, hit->point, lit, &footing,
                                                          search, &tally->parts[ORL_MAP_GLOBAL]));
    }
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

/* The diffuse part of what a ray of that weight sees of a surface, but for the glossy one. */
static struct orl_rgb diffuse_radiance(const struct orl_gather *gather,
                                       const struct orl_gather_ray *ray, const struct orl_hit *hit,
                                       struct orl_rgb weight, bool near, struct orl_random *random,
                                       struct orl_search *search)
{
    const struct orl_rgb diffuse = orl_material_diffuse(orl_world_material(gather->world, hit));
    const struct orl_rgb reflected = orl_rgb_scale(orl_rgb_mul(weight, diffuse), 1 / ORL_PI);
    if (ray->by_texels && gather->texels && !near && orl_texels_has(gather->texels, hit->facet)) {
        bool cut;
        const struct orl_texel *texel =
            orl_texels_at(gather->texels, hit->facet, hit->front, hit->point, &cut);
        if (!cut)
            return texel ? send_back_texel(ray, reflected, texel) : orl_gray(0);
    }
    struct orl_tally met = {.known = 0};
    const struct orl_rgb irradiance =
        met_irradiance(gather, hit, near, ray->by_texels, random, search, &met);
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

static struct orl_rgb trace_gather(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    const struct orl_world *world = gather->world;
    struct orl_vec3 origin = ray->origin, direction = ray->direction;
    bool outside = ray->outside, caustics = ray->of_lobe != NULL;
    struct orl_rgb sum = orl_gray(0), weight = orl_gray(1), clarity = orl_gray(1);
    const enum orl_lobes but_diffuse = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    struct orl_chance chance = ray->of_lobe ? *ray->of_lobe : orl_chance_found();
    uint32_t reflections = 0;
    search->health.paths++;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (outside) {
            struct orl_entry entry;
            sum = orl_rgb_add(
                sum, orl_rgb_mul(weight, orl_exterior_radiance(world, origin, direction, chance,
                                                               random, &search->health, &entry)));
            if (!entry.entered)
                return sum;
            weight = orl_rgb_mul(weight, entry.weight);
            clarity = entry.clarity;
            chance = entry.chance;
            origin = entry.origin;
            direction = entry.direction;
            outside = false;
        }
        search->health.rays++;
        if (!orl_geometry_intersect(world->geometry, origin, direction, INFINITY, &hit)) {
            search->health.rays_leaked += !world->open;
            weight = orl_rgb_mul(weight, orl_clarity_after(clarity, INFINITY));
            return orl_rgb_add(sum, orl_rgb_mul(weight, orl_world_dome_radiance(world, direction)));
        }
        if (bounce == 0 && ray->ret_distance)
            *ray->ret_distance = hit.distance;
        const struct orl_material *m = orl_world_material(world, &hit);
        const bool diffuse =
            orl_rgb_max(orl_material_diffuse(m)) > 0 && reflections < world->omit.most_reflections;
        const bool near = hit.distance < near_of(gather, ray->by_texels, &hit);
        weight = orl_rgb_mul(weight, orl_material_dimming(m, &hit, clarity));
        const struct orl_vec3 eye = orl_neg(direction);
        sum = orl_rgb_add(
            sum, orl_rgb_mul(weight, shining_radiance(world, &hit, eye, caustics, chance, random)));
        struct orl_rgb sent = orl_gray(0);
        const bool relit =
            diffuse && near && !known_radiance(gather, ray, &hit, weight, random, search, &sent);
        if (diffuse && (relit || !near))
            sent = diffuse_radiance(gather, ray, &hit, weight, near, random, search);
        sum = orl_rgb_add(sum, sent);
        if (diffuse && !relit && orl_material_is_matt(m))
            return sum;
        const enum orl_lobes lobes = relit ? ORL_LOBE_ALL : but_diffuse;
        const struct orl_scatter s =
            bounce == 0 && ray->first
                ? scatter_evenly(gather, ray->first, m, &hit, eye, lobes)
                : orl_scatter_sample(m, &hit, eye, ORL_TRANSPORT_EYE, lobes, random);
        if (s.event == ORL_EVENT_ABSORBED)
            return sum;
        weight = orl_rgb_mul(weight, s.weight);
        /* Dim lobes and long chains end by roulette. */
        const double survive = fmin(orl_rgb_max(weight), 1.0);
        if (bounce >= SURE_BOUNCES || survive < 0.2) {
            if (orl_random_uniform(random) >= survive)
                return sum;
            weight = orl_rgb_scale(weight, 1 / survive);
        }
        chance = s.event == ORL_EVENT_GLOSSY && !caustics
                     ? orl_chance_unsought()
                     : orl_chance_after(world, &hit, eye, &s, chance);
        reflections += s.event == ORL_EVENT_DIFFUSE;
        caustics = caustics && s.event != ORL_EVENT_DIFFUSE;
        if (s.transmitted && orl_world_leaves_clear(world, &hit))
            return orl_rgb_add(sum,
                               orl_rgb_mul(weight, orl_world_dome_radiance(world, s.direction)));
        outside = s.transmitted && !world->open &&
                  orl_world_crossing(world, &hit) == ORL_CROSSING_OUTWARDS;
        clarity = orl_scatter_clarity(m, &s, clarity);
        origin = orl_hit_leave(world->geometry, &hit, s.direction);
        direction = s.direction;
    }
    search->health.paths_capped++;
    return sum;
}

struct orl_rgb orl_gather_radiance(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search)
{
    return orl_health_keep(&search->health, trace_gather(gather, ray, random, search));
}

/* The scene that lights a place. */
static const struct orl_world *scene_of(const struct orl_gather *gather,
                                        const struct orl_place *place)
{
    return place->proxied ? orl_world_seen(gather->world) : gather->world;
}

struct orl_rgb orl_gather_direct(const struct orl_gather *gather, const struct orl_place *place,
                                 uint32_t sequence, uint32_t first, uint32_t rays,
                                 double *ret_variance)
{
    double u[2], squares = 0;
    /* Where there are no caustic photons the sun in mirrors is found by its images. */
    const struct orl_direct_query query = {
        .point = place->point,
        .normal = place->normal,
        .through_ports = true,
        .mirrored = place->outside ||
                    (orl_gather_catches(gather, place) && !gather->world->omit.mirror_caustics),
        .u = u};
    struct orl_random unused = {0}; /* the query has its numbers */
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = first; i < first + rays; i++) {
        orl_sobol_point(&gather->sobol, i, sequence, 2, u);
        const struct orl_rgb light = orl_direct_light(scene_of(gather, place), &query, &unused);
        sum = orl_rgb_add(sum, light);
        squares += orl_luma(light) * orl_luma(light);
    }
    const struct orl_rgb mean = orl_rgb_scale(sum, 1.0 / rays);
    const double luma = orl_luma(mean);
    if (ret_variance)
        *ret_variance = rays > 1 ? fmax(squares / rays - luma * luma, 0) / (rays - 1) : 0;
    return mean;
}
