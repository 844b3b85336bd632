/* The irradiance of a sensor, on a surface or in free space: sunlight through BSDF panes, then the
 * hemisphere, densities, and their sum. */
#include "base/sampling/sampling.h"
#include "bsdf/tree/shirley.h"
#include "render/gather/direction_sampling.h"
#include "render/gather/gather.h"
#include "render/gather/sensor_flux.h"
#include "scene/geometry/geometry.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

/* ---- Sunlight through panes ------------------------------------------------------------------ */

/*
 * Light of suns through BSDF panes at a place where no photon is stored. Half of the points are
 * uniform over a pane, half are drawn along the sun lobe (direction_sampling.h). A lobe a few
 * degrees wide lights a place from a thousandth of the pane. Uniform points miss that part, and the
 * sun lobe's points find it. Points are weighed by the balance heuristic of Veach and Guibas 1995.
 */
struct orl_pane_query {
    const struct orl_lit_scene *lit_scene;
    bool by_sun_lobes; /* true if half of the points are drawn along sun lobes, by the sampler */
    const struct orl_direction_sampler *sampler; /* made for that lit scene; set if by_sun_lobes */
    const struct orl_sobol *sobol;
    const struct orl_shading_point *place;
    /* Names of the sequences of uniform points and of those drawn, for all panes. */
    uint32_t sequences[2];
};

enum { PANE_POINTS = 64 }; /* points per pane, sun and strategy */

/* A pane and a sun whose light it may send to the place. */
struct pane {
    const struct orl_pane_query *query;
    uint32_t facet;
    const struct orl_port *port; /* NULL: the pane is no port */
    const struct orl_sun *sun;
    const struct orl_window_lobe *window_lobe; /* NULL: only uniform points */
};

/* A point of a pane, relative to the place. */
struct seen {
    struct orl_hit hit;
    struct orl_vec3 eye; /* from the point to the place */
    double distance;
};

/* Returns the window lobe of a port for a sun, or NULL if there is none. */
static const struct orl_window_lobe *find_window_lobe(const struct orl_pane_query *query,
                                                      int32_t port, const struct orl_sun *sun)
{
    const struct orl_direction_sampler *sampler = query->sampler;
    if (!query->by_sun_lobes || sampler->n_window_lobes == 0 || port == ORL_NO_PORT)
        return NULL;
    for (uint32_t i = sampler->first_window_lobe[port]; i < sampler->first_window_lobe[port + 1];
         i++)
        if (sampler->sun_lobes[sampler->window_lobes[i].sun_lobe].sun == sun)
            return &sampler->window_lobes[i];
    return NULL;
}

static struct seen seen_of(const struct pane *pane, const struct orl_hit *hit)
{
    const struct orl_vec3 way = orl_sub(pane->query->place->point, hit->point);
    const double d = orl_length(way);
    return (struct seen){*hit, orl_scale(way, 1 / d), d};
}

static struct seen spread_point(const struct pane *pane, const double u[2])
{
    struct orl_hit hit = {.facet = pane->facet};
    orl_facet_sample(pane->query->lit_scene->geometry, pane->facet, u, &hit.point, &hit.normal);
    return seen_of(pane, &hit);
}

/* Draws a point along the sun lobe. Returns false if none of the sun lobe reaches the place from
 * the pane. Occlusion is tested later. */
static bool draw_point(const struct pane *pane, const double u[2], struct seen *ret_seen)
{
    const struct orl_direction_sampler *sampler = pane->query->sampler;
    const struct orl_geometry *g = pane->query->lit_scene->geometry;
    const struct orl_vec3 from = pane->query->place->point;
    const struct orl_vec3 center = pane->window_lobe->center,
                          normal = orl_facet_normal(g, pane->facet);
    struct orl_vec3 direction;
    struct orl_hit hit;
    if (!orl_window_lobe_sample(pane->window_lobe, &sampler->sun_lobes[pane->window_lobe->sun_lobe],
                                sampler->cells, from, u, &direction))
        return false;
    const double t = orl_dot(orl_sub(center, from), normal) / orl_dot(direction, normal);
    const double near = 1e-4 * t;
    if (!(t > 0) || !isfinite(t) ||
        !orl_geometry_intersect(g, orl_add(from, orl_scale(direction, t - near)), direction,
                                2 * near, &hit) ||
        hit.facet != pane->facet)
        return false;
    *ret_seen = seen_of(pane, &hit);
    return true;
}

/* Returns the density of points per steradian, summed over both strategies. */
static double pdf_of(const struct pane *pane, const struct seen *seen)
{
    const struct orl_direction_sampler *sampler = pane->query->sampler;
    const double leaves = fmax(fabs(orl_dot(seen->eye, seen->hit.normal)), 1e-9);
    const double area = orl_facet_area(pane->query->lit_scene->geometry, pane->facet);
    double density = seen->distance * seen->distance / (area * leaves);
    if (pane->window_lobe)
        density +=
            orl_window_lobe_pdf(pane->window_lobe, &sampler->sun_lobes[pane->window_lobe->sun_lobe],
                                sampler->cells, pane->query->place->point, orl_neg(seen->eye));
    return PANE_POINTS * density;
}

/* Returns the light from a point, divided by the density of points. */
static struct orl_rgb light_from(const struct pane *pane, const struct seen *seen,
                                 struct orl_vec3 light)
{
    const struct orl_lit_scene *lit_scene = pane->query->lit_scene;
    const struct orl_hit *hit = &seen->hit;
    const double arrives = -orl_dot(seen->eye, pane->query->place->normal);
    if (!(seen->distance > 0) || !(arrives > 0) ||
        (pane->port && !orl_port_owns(lit_scene->geometry, pane->port, hit->point)))
        return orl_gray(0);
    const struct orl_rgb f =
        orl_material_eval_lobes(orl_lit_scene_material(lit_scene, hit), hit, light, seen->eye);
    if (!(orl_rgb_max(f) > 0))
        return orl_gray(0);
    const struct orl_rgb from_sun = orl_transmittance(
        lit_scene, orl_hit_ray_origin(lit_scene->geometry, hit, light), light, INFINITY, true);
    const struct orl_rgb to_eye =
        orl_transmittance(lit_scene, orl_hit_ray_origin(lit_scene->geometry, hit, seen->eye),
                          seen->eye, seen->distance * (1 - 1e-6), true);
    const double measure = fabs(orl_dot(light, hit->normal)) * arrives / pdf_of(pane, seen);
    return orl_rgb_scale(
        orl_rgb_mul(orl_rgb_mul(f, from_sun), orl_rgb_mul(to_eye, pane->sun->irradiance)), measure);
}

static struct orl_rgb light_by_pane(const struct pane *pane)
{
    const struct orl_pane_query *query = pane->query;
    struct orl_rgb sum = orl_gray(0);
    for (int way = 0; way < (pane->window_lobe ? 2 : 1); way++)
        for (uint32_t i = 0; i < PANE_POINTS; i++) {
            double u[4];
            struct seen seen;
            orl_sobol_point(query->sobol, i,
                            (uint32_t)orl_mix64(orl_mix64(query->sequences[way]) + pane->facet), 4,
                            u);
            if (way == 0)
                seen = spread_point(pane, u);
            else if (!draw_point(pane, u, &seen))
                continue;
            sum = orl_rgb_add(sum, light_from(pane, &seen, orl_sun_sample(pane->sun, u + 2)));
        }
    return sum;
}

/* Returns one estimate of the irradiance at the place, W/m2. */
static struct orl_rgb orl_sun_through_panes(const struct orl_pane_query *query)
{
    const struct orl_lit_scene *lit_scene = query->lit_scene;
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t f = 0; f < lit_scene->geometry->n_facets; f++) {
        const uint32_t material = orl_facet_material(lit_scene->geometry, f);
        const int32_t port = lit_scene->port_of_facet[f];
        if (!orl_material_transmits_lobes(&lit_scene->materials[material]) ||
            !(orl_facet_area(lit_scene->geometry, f) > 0))
            continue;
        for (size_t s = 0; s < lit_scene->n_suns; s++) {
            const struct pane pane = {
                query, f, port == ORL_NO_PORT ? NULL : &lit_scene->ports[port], &lit_scene->suns[s],
                find_window_lobe(query, port, &lit_scene->suns[s])};
            sum = orl_rgb_add(sum, light_by_pane(&pane));
        }
    }
    return sum;
}

/* ---- The sensor ------------------------------------------------------------------------------ */

/* Number of groups of rays. Each group has its own sequences; their spread gives the error. */
enum { GROUPS = 16, SUN_RAYS = 16, GRAZING_SUN_RAYS = 128 }; /* in each group */
/* Divisors of the rays: SHARE_AIMED of those guided by photons, SHARE_PORTS of those towards ports
 * and towards targets. */
enum { HEMISPHERES = 4, SHARE_AIMED = 16, SHARE_PORTS = 8 };
/* A caustic bias is small below this share of the rest's error, or of all light. The share of light
 * is less than for scatter, because the bias is known only to a half of itself. */
static const double beside_indirect = 0.5, beside_light = 0.002;
/* Divisor of the rays, and least number of rays, that check a density. */
enum { SHARE_CHECKED = 16, LEAST_CHECKED = 128 };
/* Limits for a significant difference: in joint standard errors, which are large because the rays'
 * error has three degrees of freedom, and as a share of the light. */
static const double differs_in_errors = 5, differs_by = 0.15;
/* Distance of a grazing sun from the sensor's plane, in the sun's radii. */
static const double grazing_discs = 2;

/* Sequence names, all distinct for any seed. */
enum {
    OF_DIRECT,
    OF_HEMISPHERE,
    OF_PANES,
    OF_AIMED = 1 << 30,
    OF_BLUR,
    OF_BEAMS,
    OF_PORTS,
    OF_TARGETS
};

static uint32_t sequence_of(const struct orl_gather *gather, uint64_t what, uint64_t name)
{
    return (uint32_t)orl_mix64(orl_mix64(orl_mix64(gather->seed) + what) + name);
}

static struct orl_rgb caustics_in_free_space(const struct orl_gather *gather,
                                             const struct orl_shading_point *place, uint64_t name)
{
    const struct orl_pane_query query = {
        .lit_scene = gather->lit_scene,
        .by_sun_lobes = gather->importance_sampled,
        .sampler = gather->sampler,
        .sobol = &gather->sobol,
        .place = place,
        .sequences = {sequence_of(gather, OF_PANES, name), sequence_of(gather, OF_BEAMS, name)}};
    return orl_sun_through_panes(&query);
}

/* Returns the size of the facet's surface: a leaf is no surface for a sensor a metre above it. */
static double size_of(const struct orl_geometry *geometry, uint32_t facet)
{
    struct orl_quadric room;
    return sqrt(orl_instance_facet(geometry, facet, &room).area);
}

/* Finds the surface that a sensor lies on: close behind it, facing the same way, and diffuse.
 * Returns false if there is none. */
static bool lies_on_surface(const struct orl_gather *gather, const struct orl_shading_point *place,
                            struct orl_surface_point *ret_surface_point)
{
    struct orl_hit hit;
    if (!orl_geometry_intersect(gather->lit_scene->geometry, place->point, orl_neg(place->normal),
                                gather->reach, &hit) ||
        hit.distance > size_of(gather->lit_scene->geometry, hit.facet))
        return false;
    if (fabs(orl_dot(hit.normal, place->normal)) < 0.9 ||
        !(orl_rgb_max(orl_material_diffuse(orl_lit_scene_material(gather->lit_scene, &hit), &hit)) >
          0))
        return false;
    *ret_surface_point = (struct orl_surface_point){.lit_scene = gather->lit_scene,
                                                    .point = hit.point,
                                                    .normal = orl_hit_facing(&hit),
                                                    .facet = hit.facet};
    return true;
}

/*
 * Strategies for the rays of a group: by the cosine; towards bright patches of photons; at points
 * of the ports, so that a deep room does not depend on one ray of a thousand that meets its window;
 * at small mirrors and lenses. The last two count only if they meet their goal first
 * (direction_sampling.h). A direction is weighed by the sum of the densities of all four, each
 * times its number of rays: the multi-sample balance heuristic of Veach and Guibas 1995.
 */
enum ray_strategy { BY_COSINE, BY_GUIDE, BY_PORT, BY_TARGET, RAY_STRATEGIES };

struct ray_set {
    const struct orl_guide_distribution *guide;
    uint32_t rays[RAY_STRATEGIES];
    bool to_ports_or_targets; /* true if some rays are drawn towards ports or targets */
};

/* A ray, and its direction on the square of scene/material/scatter.h. */
struct ray_sample {
    struct orl_direction_sample
        ray; /* without a weight; its hit is set only if the set has rays to ports or targets */
    double u[2];
};

/* Sets a ray's direction by the cosine from u, which may be guided by bright patches. */
static bool draw_cosine(const struct orl_gather *gather, const struct orl_shading_point *place,
                        const struct ray_set *ray_set, struct ray_sample *ret)
{
    ret->ray.direction = orl_hemisphere_about(place->normal, ret->u[0], ret->u[1]);
    if (!(orl_dot(ret->ray.direction, place->normal) > 0))
        return false;
    ret->ray.met = ray_set->to_ports_or_targets &&
                   orl_geometry_intersect(gather->lit_scene->geometry, place->point,
                                          ret->ray.direction, INFINITY, &ret->ray.hit);
    return true;
}

/* Draws a ray; returns false if it counts for nothing. */
static bool draw_ray(const struct orl_gather *gather, const struct orl_shading_point *place,
                     const struct ray_set *ray_set, enum ray_strategy strategy,
                     const struct orl_sobol_slice *slice, struct ray_sample *ret)
{
    double u[3];
    orl_sobol_point(&gather->sobol, slice->index, slice->sequence, slice->skip, u);
    if (strategy == BY_GUIDE)
        orl_guide_distribution_sample(ray_set->guide, u);
    ret->u[0] = u[0];
    ret->u[1] = u[1];
    if (strategy == BY_COSINE || strategy == BY_GUIDE)
        return draw_cosine(gather, place, ray_set, ret);
    if (!orl_direction_trace(gather->sampler,
                             strategy == BY_PORT ? ORL_SAMPLE_PORT : ORL_SAMPLE_TARGET,
                             place->point, place->normal, u, &ret->ray))
        return false;
    const struct orl_frame frame = orl_frame_about(place->normal);
    const struct orl_vec3 local = orl_to_local(&frame, ret->ray.direction);
    const struct orl_square at = orl_disk_to_square(local.x, local.y);
    ret->u[0] = 0.5 * (at.x + 1);
    ret->u[1] = 0.5 * (at.y + 1);
    return true;
}

/* Returns the expected number of rays of the set in that direction, per projected solid angle
 * over pi. */
static double combined_pdf(const struct orl_gather *gather, const struct orl_shading_point *place,
                           const struct ray_set *ray_set, const struct ray_sample *ray_sample)
{
    double pdf_sum = ray_set->rays[BY_COSINE];
    if (ray_set->rays[BY_GUIDE] > 0)
        pdf_sum +=
            ray_set->rays[BY_GUIDE] * orl_guide_distribution_pdf(ray_set->guide, ray_sample->u);
    if (!ray_set->to_ports_or_targets || !ray_sample->ray.met)
        return pdf_sum;
    const struct orl_strategy_counts ray_counts = {
        {[ORL_SAMPLE_PORT] = ray_set->rays[BY_PORT],
         [ORL_SAMPLE_TARGET] = ray_set->rays[BY_TARGET]}};
    return pdf_sum + ORL_PI *
                         orl_direction_pdf(gather->sampler, &ray_counts, place->point,
                                           place->normal, &ray_sample->ray) /
                         fmax(orl_dot(ray_sample->ray.direction, place->normal), 1e-9);
}

/* Returns what is known about a ray's first hit: rays are traced before if some of the set are
 * drawn towards ports or targets. */
static enum orl_first_hit first_hit_of(const struct ray_set *ray_set,
                                       const struct ray_sample *ray_sample)
{
    if (!ray_set->to_ports_or_targets)
        return ORL_FIRST_HIT_UNKNOWN;
    return ray_sample->ray.met ? ORL_FIRST_HIT_SURFACE : ORL_FIRST_HIT_NOTHING;
}

/*
 * Returns a group's estimate of the hemisphere by scrambled Sobol points, up to the event at each
 * ray's first surface. A sensor needs no gradients. The tally receives the rays' photon parts, and
 * seen each ray's contribution to the sensor.
 */
static struct orl_rgb gather_group(const struct orl_gather *gather,
                                   const struct orl_shading_point *place,
                                   const struct ray_set *ray_set, uint64_t name,
                                   struct orl_search *search, struct orl_tally *tally,
                                   struct orl_ray_moments *seen)
{
    const uint32_t sequences[RAY_STRATEGIES] = {
        sequence_of(gather, OF_HEMISPHERE, name), sequence_of(gather, OF_AIMED, name),
        sequence_of(gather, OF_PORTS, name), sequence_of(gather, OF_TARGETS, name)};
    struct orl_rgb sum = orl_gray(0);
    uint32_t number = 0;
    for (int strategy = 0; strategy < RAY_STRATEGIES; strategy++)
        for (uint32_t i = 0; i < ray_set->rays[strategy] && !orl_is_cancelled(gather->cancel);
             i++) {
            struct orl_random random =
                orl_random_stream(gather->seed, ORL_PURPOSE_SENSOR, (name << 24) + ++number);
            const struct orl_sobol_slice slice = {
                .index = i,
                .sequence = sequences[strategy],
                .skip = strategy == BY_COSINE || strategy == BY_GUIDE ? 2 : 3};
            struct ray_sample ray_sample;
            if (!draw_ray(gather, place, ray_set, (enum ray_strategy)strategy, &slice, &ray_sample))
                continue;
            const struct orl_gather_ray ray = {
                .origin = place->point,
                .direction = ray_sample.ray.direction,
                .outside = place->outside,
                .stratified = true,
                .slice = &slice,
                .first_hit = first_hit_of(ray_set, &ray_sample),
                .hit = &ray_sample.ray.hit,
                .importance_sampled = ray_set->to_ports_or_targets,
                .tally = tally,
                .share = ORL_PI / combined_pdf(gather, place, ray_set, &ray_sample) / HEMISPHERES};
            const struct orl_rgb radiance = orl_gather_radiance(gather, &ray, &random, search);
            orl_ray_moments_add(seen, ray.share * orl_luma(radiance));
            sum = orl_rgb_add(sum, orl_rgb_scale(radiance, ray.share * HEMISPHERES));
        }
    return sum;
}

/*
 * Estimates the hemisphere by few groups. A Sobol sequence of n rays has an error of about
 * n^(-3/4). G groups of n / G rays have G^(1/4) times that: 16 groups would double it. Four groups
 * give their own error with three degrees of freedom, to which the photons add theirs.
 */
static struct orl_estimate gather_samples(const struct orl_gather *gather,
                                          const struct orl_shading_point *place, uint32_t samples,
                                          uint64_t index, struct orl_search *search,
                                          struct orl_tally *tally)
{
    const uint32_t each = samples / HEMISPHERES > 0 ? samples / HEMISPHERES : 1;
    struct orl_guide_distribution guide;
    struct orl_rgb means[HEMISPHERES];
    struct orl_ray_moments seen = {0, 0};
    orl_guide_distribution_build(&gather->guide, place->point, place->normal, samples, &guide);
    const bool to_ports_or_targets = gather->importance_sampled && !place->outside;
    const bool ports = to_ports_or_targets && gather->lit_scene->n_ports > 0;
    const bool targets = to_ports_or_targets && gather->sampler->targets.n > 0;
    const uint32_t share = (each + SHARE_PORTS - 1) / SHARE_PORTS;
    const struct ray_set ray_set = {
        &guide,
        {[BY_COSINE] = each,
         [BY_GUIDE] = guide.useful ? (each + SHARE_AIMED - 1) / SHARE_AIMED : 0,
         [BY_PORT] = ports ? share : 0,
         [BY_TARGET] = targets ? share : 0},
        ports || targets};
    for (uint32_t group = 0; group < HEMISPHERES; group++)
        means[group] = gather_group(gather, place, &ray_set, index * HEMISPHERES + group, search,
                                    tally, &seen);
    struct orl_estimate estimate = orl_estimate_of_mean(means, HEMISPHERES);
    estimate.rays = seen;
    return estimate;
}

/* Returns the rays per sun. A sun that the sensor's plane cuts, or nearly, gets more, because most
 * of its rays miss. */
static uint32_t sun_rays(const struct orl_gather *gather, struct orl_vec3 normal)
{
    for (size_t i = 0; i < gather->lit_scene->n_suns; i++) {
        const struct orl_sun *sun = &gather->lit_scene->suns[i];
        const double half = sqrt(fmax(0, 1 - sun->cos_half_angle * sun->cos_half_angle));
        if (fabs(orl_dot(sun->frame.n, normal)) < grazing_discs * half)
            return GRAZING_SUN_RAYS;
    }
    return SUN_RAYS;
}

/* Returns the light of suns and lamps, directly and, in free space, through panes: the mean of
 * the groups. */
static struct orl_estimate sample_lights(const struct orl_gather *gather,
                                         const struct orl_shading_point *place, uint64_t index,
                                         struct orl_health *health)
{
    const bool by_panes =
        orl_gather_has_free_caustics(gather, place) && !gather->lit_scene->omit.lobe_caustics;
    const uint32_t rays = sun_rays(gather, place->normal);
    struct orl_rgb means[GROUPS];
    for (uint32_t group = 0; group < GROUPS; group++) {
        const uint64_t name = index * GROUPS + group;
        const uint32_t sequence = sequence_of(gather, OF_DIRECT, name);
        means[group] =
            orl_health_filter(health, orl_gather_direct(gather, place, sequence, 0, rays, NULL));
        if (by_panes)
            means[group] =
                orl_rgb_add(means[group],
                            orl_health_filter(health, caustics_in_free_space(gather, place, name)));
    }
    return orl_estimate_of_mean(means, GROUPS);
}

/* Returns one map's part of a sensor: the density at it, if any, and the photons that rays saw. */
static struct orl_estimate estimate_by_map(const struct orl_density *density,
                                           const struct orl_batches *seen,
                                           struct orl_health *health)
{
    struct orl_batches parts = *seen;
    orl_batches_add(&parts, &density->parts, 1);
    return (struct orl_estimate){.value = orl_health_filter(health, density->irradiance),
                                 .standard_error = sqrt(orl_batches_variance(&parts)),
                                 .degrees_of_freedom = ORL_MAP_BATCHES - 1,
                                 .bias = density->bias,
                                 .third_cumulant = orl_batches_third_cumulant(&parts)};
}

struct orl_shading_point orl_gather_sensor_point(const struct orl_gather *gather,
                                                 struct orl_vec3 position,
                                                 struct orl_vec3 direction,
                                                 struct orl_surface_point *ret_surface_point)
{
    struct orl_shading_point place = {
        .point = orl_offset_from_surface(gather->lit_scene->geometry, position, direction),
        .normal = direction};
    place.outside = orl_lit_scene_is_outside(gather->lit_scene, place.point);
    place.in_free_space = !lies_on_surface(gather, &place, ret_surface_point);
    return place;
}

/*
 * Returns true if the density has too few photons or shows bias, and suns' images in flat mirrors
 * give all caustics instead. In a whole building photons lie far apart, and none may lie where a
 * pane mirrors the sun. Outside, rays find them.
 */
static bool is_too_blurred(const struct orl_gather *gather, const struct orl_shading_point *place,
                           const struct orl_density *caustic,
                           const struct orl_virtual_sun_blur *blur,
                           const struct orl_estimate *indirect)
{
    const double light = orl_luma(indirect->value) + orl_luma(caustic->irradiance);
    const double bias = fmax(fabs(caustic->bias), fabs(orl_luma(blur->excess.value)));
    return gather->only_virtual_suns && !place->in_free_space && !place->outside &&
           (caustic->found < gather->k[ORL_MAP_CAUSTIC] ||
            bias > fmax(beside_indirect * indirect->standard_error, beside_light * light));
}

/* Returns a density less the blur of suns in flat mirrors; its bias is reduced to that of its other
 * light. */
static struct orl_estimate remove_blur(struct orl_estimate caustic,
                                       const struct orl_virtual_sun_blur *blur)
{
    const double luma = orl_luma(caustic.value);
    if (blur->found == 0 || !(blur->mean > 0))
        return caustic;
    caustic.bias *= luma > 0 ? fmax(1 - blur->mean / luma, 0) : 0;
    struct orl_estimate excess = blur->excess;
    excess.value = orl_rgb_scale(excess.value, -1);
    excess.third_cumulant = -excess.third_cumulant;
    return orl_estimate_add(caustic, excess);
}

/*
 * Compares a density with a few rays of a hemisphere, which read the map elsewhere. A disc that
 * includes a bright place beyond a wall, or misses photons that are few and heavy, has a small
 * scatter and a wrong value. If the two differ by more than both scatter, the difference is taken
 * as its bias.
 */
static void check_density(const struct orl_gather *gather, const struct orl_shading_point *place,
                          uint32_t samples, uint64_t index, struct orl_search *search,
                          struct orl_estimate *density)
{
    struct orl_tally tally = {.record_error = 0};
    const uint32_t rays = samples / SHARE_CHECKED;
    const struct orl_estimate seen = gather_samples(
        gather, place, rays > LEAST_CHECKED ? rays : LEAST_CHECKED, index, search, &tally);
    const double luma = orl_luma(density->value), off = luma - orl_luma(seen.value);
    const double scatter = hypot(density->standard_error,
                                 hypot(seen.standard_error, sqrt(orl_tally_variance(&tally))));
    if (fabs(off) > fmax(differs_in_errors * scatter, differs_by * luma))
        density->bias = copysign(fmax(fabs(off), fabs(density->bias)), off);
}

struct orl_estimate orl_gather_sensor(const struct orl_gather *gather,
                                      struct orl_shading_point *place,
                                      const struct orl_surface_point *surface_point,
                                      uint32_t samples, uint64_t index, struct orl_search *search)
{
    static const struct orl_density none = {.found = 0};
    struct orl_density indirect = none, caustic = none;
    struct orl_virtual_sun_blur blur = {.found = 0};
    const enum orl_map_kind kind_of_indirect = gather->indirect->map;
    struct orl_tally tally = {.record_error = 0};
    if (!place->in_free_space)
        caustic = orl_gather_caustic_with_bias(gather, surface_point, search);
    if (!place->in_free_space && !place->outside)
        indirect = orl_gather_indirect(gather, surface_point, search);
    struct orl_estimate lights = sample_lights(gather, place, index, &search->health);
    struct orl_estimate sum =
        estimate_by_map(&indirect, &tally.parts[kind_of_indirect], &search->health);
    if (indirect.found == 0 || indirect.unreliable) {
        const struct orl_estimate seen =
            gather_samples(gather, place, samples, index, search, &tally);
        sum = estimate_by_map(&none, &tally.parts[kind_of_indirect], &search->health);
        sum = orl_estimate_add(sum, seen);
    } else {
        check_density(gather, place, samples, index, search, &sum);
    }
    const struct orl_estimate all = orl_estimate_add(sum, lights);
    if (!place->outside && caustic.found > 0 &&
        orl_luma(caustic.irradiance) > beside_light * orl_luma(all.value))
        blur = orl_gather_virtual_sun_blur(gather, surface_point, caustic.radius,
                                           sequence_of(gather, OF_BLUR, index));
    if (is_too_blurred(gather, place, &caustic, &blur, &all)) {
        place->in_free_space = true;
        caustic = none;
        blur = (struct orl_virtual_sun_blur){.found = 0};
        lights = sample_lights(gather, place, index, &search->health);
    }
    sum = orl_estimate_add(sum, lights);
    const struct orl_estimate by_density =
        estimate_by_map(&caustic, &tally.parts[ORL_MAP_CAUSTIC], &search->health);
    return orl_estimate_add(sum, remove_blur(by_density, &blur));
}
