#include "bsdf/shirley.h"
#include "render/gather/aim.h"
#include "render/gather/air.h"
#include "render/gather/gather.h"
#include "render/gather/panes.h"
#include "scene/geometry/placed.h"
#include "scene/geometry/stand.h"
#include "scene/material/hemisphere.h"

/* Number of groups of rays. Each group has its own sequences; their spread gives the error. */
enum { GROUPS = 16, SUN_RAYS = 16, GRAZING_SUN_RAYS = 128 }; /* in each group */
/* Divisors of the rays: SHARE_AIMED of those guided by photons, SHARE_PORTS of those aimed at ports
 * and at targets. */
enum { HEMISPHERES = 4, SHARE_AIMED = 16, SHARE_PORTS = 8 };
/* A caustic bias is small below this share of the rest's error, or of all light. The share of light
 * is less than for scatter, because the bias is known only to a half of itself. */
static const double beside_rest = 0.5, beside_light = 0.002;
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

static struct orl_rgb caustics_in_air(const struct orl_gather *gather,
                                      const struct orl_place *place, uint64_t name)
{
    const struct orl_pane_query query = {
        .world = gather->world,
        .aim = gather->aim,
        .sobol = &gather->sobol,
        .place = place,
        .sequences = {sequence_of(gather, OF_PANES, name), sequence_of(gather, OF_BEAMS, name)}};
    return orl_light_by_panes(&query);
}

/* Returns the size of the facet's surface: a leaf is no surface for a sensor a metre above it. */
static double size_of(const struct orl_geometry *geometry, uint32_t facet)
{
    struct orl_curved room;
    return sqrt(orl_facet_at(geometry, facet, &room).area);
}

/* Finds the surface that a sensor lies on: close behind it, facing the same way, and diffuse.
 * Returns false if there is none. */
static bool lies_on_surface(const struct orl_gather *gather, const struct orl_place *place,
                            struct orl_footing *ret_footing)
{
    struct orl_hit hit;
    if (!orl_geometry_intersect(gather->world->geometry, place->point, orl_neg(place->normal),
                                gather->reach, &hit) ||
        hit.distance > size_of(gather->world->geometry, hit.facet))
        return false;
    if (fabs(orl_dot(hit.normal, place->normal)) < 0.9 ||
        !(orl_rgb_max(orl_material_diffuse(orl_world_material(gather->world, &hit), &hit)) > 0))
        return false;
    *ret_footing = (struct orl_footing){.world = gather->world,
                                        .point = hit.point,
                                        .normal = orl_hit_facing(&hit),
                                        .facet = hit.facet};
    return true;
}

/*
 * Strategies for the rays of a group: by the cosine; towards bright patches of photons; at points
 * of the ports, so that a deep room does not depend on one ray of a thousand that meets its window;
 * at small mirrors and lenses. The last two count only if they meet their goal first (aim.h). A
 * direction is weighed by the sum of the densities of all four, each times its number of rays: the
 * multi-sample balance heuristic of Veach and Guibas 1995.
 */
enum ray_way { WAY_EVEN, WAY_BRIGHT, WAY_PORT, WAY_TARGET, RAY_WAYS };

struct volley {
    const struct orl_bright_view *bright;
    uint32_t rays[RAY_WAYS];
    bool aimed; /* true if some rays are aimed at ports or targets */
};

/* A ray, and its direction on the square of scene/material/hemisphere.h. */
struct shot {
    struct orl_aimed ray; /* without a weight; its hit is set only if the volley is aimed */
    double u[2];
};

/* Sets a ray's direction by the cosine from u, which may be guided by bright patches. */
static bool draw_cosine(const struct orl_gather *gather, const struct orl_place *place,
                        const struct volley *volley, struct shot *ret)
{
    ret->ray.direction = orl_hemisphere_about(place->normal, ret->u[0], ret->u[1]);
    if (!(orl_dot(ret->ray.direction, place->normal) > 0))
        return false;
    ret->ray.met =
        volley->aimed && orl_geometry_intersect(gather->world->geometry, place->point,
                                                ret->ray.direction, INFINITY, &ret->ray.hit);
    return true;
}

/* Draws a ray; returns false if it counts for nothing. */
static bool draw_shot(const struct orl_gather *gather, const struct orl_place *place,
                      const struct volley *volley, enum ray_way way, const struct orl_even *even,
                      struct shot *ret)
{
    double u[3];
    orl_sobol_point(&gather->sobol, even->index, even->sequence, even->skip, u);
    if (way == WAY_BRIGHT)
        orl_bright_draw(volley->bright, u);
    ret->u[0] = u[0];
    ret->u[1] = u[1];
    if (way == WAY_EVEN || way == WAY_BRIGHT)
        return draw_cosine(gather, place, volley, ret);
    if (!orl_aim_draw(gather->aim, way == WAY_PORT ? ORL_WAY_PORT : ORL_WAY_TARGET, place->point,
                      place->normal, u, &ret->ray))
        return false;
    const struct orl_frame frame = orl_frame_about(place->normal);
    const struct orl_vec3 local = orl_to_local(&frame, ret->ray.direction);
    const struct orl_square at = orl_disk_to_square(local.x, local.y);
    ret->u[0] = 0.5 * (at.x + 1);
    ret->u[1] = 0.5 * (at.y + 1);
    return true;
}

/* Returns the expected number of rays of the volley in that direction, per projected solid angle
 * over pi. */
static double drawn_at(const struct orl_gather *gather, const struct orl_place *place,
                       const struct volley *volley, const struct shot *shot)
{
    double drawn = volley->rays[WAY_EVEN];
    if (volley->rays[WAY_BRIGHT] > 0)
        drawn += volley->rays[WAY_BRIGHT] * orl_bright_density(volley->bright, shot->u);
    if (!volley->aimed || !shot->ray.met)
        return drawn;
    const struct orl_effort effort = {
        {[ORL_WAY_PORT] = volley->rays[WAY_PORT], [ORL_WAY_TARGET] = volley->rays[WAY_TARGET]}};
    return drawn +
           ORL_PI * orl_aim_density(gather->aim, &effort, place->point, place->normal, &shot->ray) /
               fmax(orl_dot(shot->ray.direction, place->normal), 1e-9);
}

/*
 * Returns a group's estimate of the hemisphere by scrambled Sobol points, up to the event at each
 * ray's first surface. A sensor needs no gradients. The tally receives the rays' photon parts, and
 * seen each ray's contribution to the sensor.
 */
static struct orl_rgb gather_group(const struct orl_gather *gather, const struct orl_place *place,
                                   const struct volley *volley, uint64_t name,
                                   struct orl_search *search, struct orl_tally *tally,
                                   struct orl_rays *seen)
{
    const uint32_t sequences[RAY_WAYS] = {
        sequence_of(gather, OF_HEMISPHERE, name), sequence_of(gather, OF_AIMED, name),
        sequence_of(gather, OF_PORTS, name), sequence_of(gather, OF_TARGETS, name)};
    struct orl_rgb sum = orl_gray(0);
    uint32_t number = 0;
    for (int way = 0; way < RAY_WAYS; way++)
        for (uint32_t i = 0; i < volley->rays[way] && !orl_is_cancelled(gather->cancel); i++) {
            struct orl_random random =
                orl_random_stream(gather->seed, ORL_PURPOSE_SENSOR, (name << 24) + ++number);
            const struct orl_even first = {.index = i,
                                           .sequence = sequences[way],
                                           .skip = way == WAY_EVEN || way == WAY_BRIGHT ? 2 : 3};
            struct shot shot;
            if (!draw_shot(gather, place, volley, (enum ray_way)way, &first, &shot))
                continue;
            const struct orl_gather_ray ray = {
                .origin = place->point,
                .direction = shot.ray.direction,
                .outside = place->outside,
                .first = &first,
                .ahead = shot.ray.met ? &shot.ray.hit : NULL,
                .nothing_ahead = volley->aimed && !shot.ray.met,
                .aims = volley->aimed,
                .tally = tally,
                .share = ORL_PI / drawn_at(gather, place, volley, &shot) / HEMISPHERES};
            const struct orl_rgb radiance = orl_gather_radiance(gather, &ray, &random, search);
            orl_rays_add(seen, ray.share * orl_luma(radiance));
            sum = orl_rgb_add(sum, orl_rgb_scale(radiance, ray.share * HEMISPHERES));
        }
    return sum;
}

/*
 * Estimates the hemisphere by few groups. A Sobol sequence of n rays has an error of about
 * n^(-3/4). G groups of n / G rays have G^(1/4) times that: 16 groups would double it. Four groups
 * give their own error with three degrees of freedom, to which the photons add theirs.
 */
static struct orl_estimate gather_evenly(const struct orl_gather *gather,
                                         const struct orl_place *place, uint32_t samples,
                                         uint64_t index, struct orl_search *search,
                                         struct orl_tally *tally)
{
    const uint32_t each = samples / HEMISPHERES > 0 ? samples / HEMISPHERES : 1;
    struct orl_bright_view bright;
    struct orl_rgb means[HEMISPHERES];
    struct orl_rays seen = {0, 0};
    orl_bright_look(&gather->bright, place->point, place->normal, samples, &bright);
    const bool aimed = gather->aim && !place->outside;
    const bool ports = aimed && gather->world->n_ports > 0;
    const bool targets = aimed && gather->aim->targets.n > 0;
    const uint32_t share = (each + SHARE_PORTS - 1) / SHARE_PORTS;
    const struct volley volley = {
        &bright,
        {[WAY_EVEN] = each,
         [WAY_BRIGHT] = bright.worth ? (each + SHARE_AIMED - 1) / SHARE_AIMED : 0,
         [WAY_PORT] = ports ? share : 0,
         [WAY_TARGET] = targets ? share : 0},
        ports || targets};
    for (uint32_t group = 0; group < HEMISPHERES; group++)
        means[group] =
            gather_group(gather, place, &volley, index * HEMISPHERES + group, search, tally, &seen);
    struct orl_estimate estimate = orl_estimate_of_mean(means, HEMISPHERES);
    estimate.rays = seen;
    return estimate;
}

/* Returns the rays per sun. A sun that the sensor's plane cuts, or nearly, gets more, because most
 * of its rays miss. */
static uint32_t sun_rays(const struct orl_gather *gather, struct orl_vec3 normal)
{
    for (size_t i = 0; i < gather->world->n_suns; i++) {
        const struct orl_sun *sun = &gather->world->suns[i];
        const double half = sqrt(fmax(0, 1 - sun->cos_half_angle * sun->cos_half_angle));
        if (fabs(orl_dot(sun->frame.n, normal)) < grazing_discs * half)
            return GRAZING_SUN_RAYS;
    }
    return SUN_RAYS;
}

/* Returns the light of suns and lamps, directly and, in mid-air, through panes: the mean of the
 * groups. */
static struct orl_estimate sample_lights(const struct orl_gather *gather,
                                         const struct orl_place *place, uint64_t index,
                                         struct orl_health *health)
{
    const bool by_panes = orl_gather_catches(gather, place) && !gather->world->omit.lobe_caustics;
    const uint32_t rays = sun_rays(gather, place->normal);
    struct orl_rgb means[GROUPS];
    for (uint32_t group = 0; group < GROUPS; group++) {
        const uint64_t name = index * GROUPS + group;
        const uint32_t sequence = sequence_of(gather, OF_DIRECT, name);
        means[group] =
            orl_health_keep(health, orl_gather_direct(gather, place, sequence, 0, rays, NULL));
        if (by_panes)
            means[group] = orl_rgb_add(
                means[group], orl_health_keep(health, caustics_in_air(gather, place, name)));
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
    return (struct orl_estimate){.value = orl_health_keep(health, density->irradiance),
                                 .standard_error = sqrt(orl_batches_variance(&parts)),
                                 .degrees = ORL_MAP_BATCHES - 1,
                                 .bias = density->bias,
                                 .third = orl_batches_third(&parts)};
}

struct orl_place orl_gather_place(const struct orl_gather *gather, struct orl_vec3 position,
                                  struct orl_vec3 direction, struct orl_footing *ret_footing)
{
    struct orl_place place = {.point = orl_stand(gather->world->geometry, position, direction),
                              .normal = direction};
    place.outside = orl_world_is_outside(gather->world, place.point);
    place.in_air = !lies_on_surface(gather, &place, ret_footing);
    return place;
}

/*
 * Returns true if the density has too few photons or shows bias, and suns' images in flat mirrors
 * give all caustics instead. In a whole building photons lie far apart, and none may lie where a
 * pane mirrors the sun. Outside, rays find them.
 */
static bool is_poor(const struct orl_gather *gather, const struct orl_place *place,
                    const struct orl_density *caustic, const struct orl_image_blur *blur,
                    const struct orl_estimate *rest)
{
    const double light = orl_luma(rest->value) + orl_luma(caustic->irradiance);
    const double bias = fmax(fabs(caustic->bias), fabs(orl_luma(blur->excess.value)));
    return gather->by_images && !place->in_air && !place->outside &&
           (caustic->found < gather->k[ORL_MAP_CAUSTIC] ||
            bias > fmax(beside_rest * rest->standard_error, beside_light * light));
}

/* Returns a density less the blur of suns in flat mirrors; its bias is reduced to that of its other
 * light. */
static struct orl_estimate remove_blur(struct orl_estimate caustic,
                                       const struct orl_image_blur *blur)
{
    const double luma = orl_luma(caustic.value);
    if (blur->found == 0 || !(blur->mean > 0))
        return caustic;
    caustic.bias *= luma > 0 ? fmax(1 - blur->mean / luma, 0) : 0;
    struct orl_estimate excess = blur->excess;
    excess.value = orl_rgb_scale(excess.value, -1);
    excess.third = -excess.third;
    return orl_estimate_add(caustic, excess);
}

/*
 * Compares a density with a few rays of a hemisphere, which read the map elsewhere. A disc that
 * includes a bright place beyond a wall, or misses photons that are few and heavy, has a small
 * scatter and a wrong value. If the two differ by more than both scatter, the difference is taken
 * as its bias.
 */
static void check_density(const struct orl_gather *gather, const struct orl_place *place,
                          uint32_t samples, uint64_t index, struct orl_search *search,
                          struct orl_estimate *density)
{
    struct orl_tally tally = {.known = 0};
    const uint32_t rays = samples / SHARE_CHECKED;
    const struct orl_estimate seen = gather_evenly(
        gather, place, rays > LEAST_CHECKED ? rays : LEAST_CHECKED, index, search, &tally);
    const double luma = orl_luma(density->value), off = luma - orl_luma(seen.value);
    const double scatter = hypot(density->standard_error,
                                 hypot(seen.standard_error, sqrt(orl_tally_variance(&tally))));
    if (fabs(off) > fmax(differs_in_errors * scatter, differs_by * luma))
        density->bias = copysign(fmax(fabs(off), fabs(density->bias)), off);
}

struct orl_estimate orl_gather_sensor(const struct orl_gather *gather, struct orl_place *place,
                                      const struct orl_footing *footing, uint32_t samples,
                                      uint64_t index, struct orl_search *search)
{
    static const struct orl_density none = {.found = 0};
    struct orl_density rest = none, caustic = none;
    struct orl_image_blur blur = {.found = 0};
    const int kind_of_rest =
        gather->rest == ORL_REST_RECORDS ? ORL_MAP_PRECOMPUTED : ORL_MAP_GLOBAL;
    struct orl_tally tally = {.known = 0};
    if (!place->in_air)
        caustic = orl_gather_caustic_with_bias(gather, footing, search);
    if (!place->in_air && !place->outside)
        rest = orl_gather_rest(gather, footing, search);
    struct orl_estimate lights = sample_lights(gather, place, index, &search->health);
    struct orl_estimate sum = estimate_by_map(&rest, &tally.parts[kind_of_rest], &search->health);
    if (rest.found == 0 || rest.crowded) {
        const struct orl_estimate seen =
            gather_evenly(gather, place, samples, index, search, &tally);
        sum = estimate_by_map(&none, &tally.parts[kind_of_rest], &search->health);
        sum = orl_estimate_add(sum, seen);
    } else {
        check_density(gather, place, samples, index, search, &sum);
    }
    const struct orl_estimate all = orl_estimate_add(sum, lights);
    if (!place->outside && caustic.found > 0 &&
        orl_luma(caustic.irradiance) > beside_light * orl_luma(all.value))
        blur = orl_gather_image_blur(gather, footing, caustic.radius,
                                     sequence_of(gather, OF_BLUR, index));
    if (is_poor(gather, place, &caustic, &blur, &all)) {
        place->in_air = true;
        caustic = none;
        blur = (struct orl_image_blur){.found = 0};
        lights = sample_lights(gather, place, index, &search->health);
    }
    sum = orl_estimate_add(sum, lights);
    const struct orl_estimate by_density =
        estimate_by_map(&caustic, &tally.parts[ORL_MAP_CAUSTIC], &search->health);
    return orl_estimate_add(sum, remove_blur(by_density, &blur));
}
