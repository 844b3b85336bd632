#include "light/direct.h"

#include "light/path.h"
#include "scene/built/scene.h"

static const uint32_t no_target = UINT32_MAX;

/* A shadow ray. */
struct segment {
    struct orl_vec3 origin, direction;
    double max_distance;
    bool through_ports;
    /* its target is neither sun nor lamp: the front of an illum blocks it */
    bool to_surface;
    /* the facet that it is traced to, which does not block it; or no_target */
    uint32_t target;
    int32_t *port; /* in and out as in orl_transmittance_to_infinity; or NULL */
};

static struct segment segment_to(struct orl_vec3 origin, struct orl_vec3 direction,
                                 double max_distance, bool through_ports)
{
    return (struct segment){.origin = origin,
                            .direction = direction,
                            .max_distance = max_distance,
                            .through_ports = through_ports,
                            .target = no_target};
}

static struct orl_rgb panes_transmittance(const struct orl_lit_scene *lit_scene,
                                          const struct segment *segment)
{
    struct orl_path path = orl_path_from(segment->origin, segment->direction);
    double max_distance = segment->max_distance;
    for (int pane = 0; pane < ORL_MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(lit_scene->geometry, path.origin, segment->direction,
                                    max_distance, &hit))
            return path.weight;
        if (hit.facet == segment->target)
            return path.weight;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const bool hidden = segment->to_surface && m->kind == ORL_MATERIAL_ILLUM && hit.front;
        if (hidden || !orl_path_transmit_straight(&path, m, &hit) ||
            (!segment->through_ports &&
             orl_lit_scene_crossing(lit_scene, &hit) != ORL_CROSSING_NONE))
            return orl_gray(0);
        if (segment->port && *segment->port == ORL_NO_PORT &&
            orl_lit_scene_crossing(lit_scene, &hit) == ORL_CROSSING_OUTWARDS)
            *segment->port = orl_lit_scene_port_of(lit_scene, hit.facet);
        if (isinf(max_distance) && orl_lit_scene_leaves_clear(lit_scene, &hit))
            return path.weight;
        /* The ray starts again a little further on, but its end stays the same. */
        const struct orl_vec3 before = path.origin;
        orl_path_skip_surface(&path, lit_scene, &hit);
        max_distance -= orl_dot(orl_sub(path.origin, before), segment->direction);
    }
    return orl_gray(0);
}

struct orl_rgb orl_transmittance_to_facet(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 origin, struct orl_vec3 direction,
                                          bool through_ports, uint32_t facet,
                                          struct orl_hit *ret_hit)
{
    struct orl_path path = orl_path_from(origin, direction);
    for (int pane = 0; pane < ORL_MOST_PANES; pane++) {
        if (!orl_path_intersect(lit_scene, &path, ret_hit))
            return orl_gray(0);
        if (ret_hit->facet == facet)
            return path.weight;
        if (!orl_path_transmit_straight(&path, orl_lit_scene_material(lit_scene, ret_hit),
                                        ret_hit) ||
            (!through_ports && orl_lit_scene_crossing(lit_scene, ret_hit) != ORL_CROSSING_NONE))
            return orl_gray(0);
        orl_path_skip_surface(&path, lit_scene, ret_hit);
    }
    return orl_gray(0);
}

static struct orl_rgb transmittance_of(const struct orl_lit_scene *lit_scene,
                                       const struct segment *segment)
{
    const struct orl_rgb share = panes_transmittance(lit_scene, segment);
    if (!lit_scene->scene->mist || !(orl_rgb_max(share) > 0))
        return share;
    return orl_rgb_mul(share, orl_volume_transmittance(lit_scene->scene, segment->origin,
                                                       segment->direction, segment->max_distance));
}

struct orl_rgb orl_transmittance(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                                 struct orl_vec3 direction, double max_distance, bool through_ports)
{
    const struct segment segment = segment_to(origin, direction, max_distance, through_ports);
    return transmittance_of(lit_scene, &segment);
}

struct orl_rgb orl_transmittance_to_surface(const struct orl_lit_scene *lit_scene,
                                            struct orl_vec3 origin, struct orl_vec3 direction,
                                            double max_distance, bool through_ports)
{
    struct segment segment = segment_to(origin, direction, max_distance, through_ports);
    segment.to_surface = true;
    return transmittance_of(lit_scene, &segment);
}

struct orl_rgb orl_transmittance_to_infinity(const struct orl_lit_scene *lit_scene,
                                             struct orl_vec3 origin, struct orl_vec3 direction,
                                             int32_t *port)
{
    struct segment segment = segment_to(origin, direction, INFINITY, true);
    segment.port = port;
    return transmittance_of(lit_scene, &segment);
}

/* Returns the cosine for irradiance, or the lobes' value times the cosine for radiance towards
 * the eye. */
static struct orl_rgb response(const struct orl_direct_query *query, struct orl_vec3 light)
{
    if (query->mist)
        return orl_gray(orl_phase_function(query->asymmetry, -orl_dot(light, query->eye)));
    const double cosine = orl_dot(light, query->normal);
    if (!(cosine > 0))
        return orl_gray(0);
    if (!query->lobes)
        return orl_gray(query->shading ? fmax(orl_dot(light, *query->shading), 0) : cosine);
    return orl_rgb_scale(orl_material_eval_lobes(query->lobes, query->hit, light, query->eye),
                         cosine);
}

/*
 * Returns the pdf with which rays are sampled from a material's lobes, where shadow rays also
 * sample suns and lamps. Both MIS weights use this pdf, whatever lobes a path then allows: they
 * must add up to one.
 */
static double lobe_pdf(const struct orl_material *material, const struct orl_hit *hit,
                       struct orl_vec3 eye, struct orl_vec3 towards)
{
    return orl_material_pdf(material, hit, eye, ORL_TRANSPORT_EYE,
                            (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), towards);
}

/* Returns true if rays count the lamp's light: a spotlight's focus is implemented for shadow
 * rays only. */
static bool rays_count_lamp(const struct orl_material *lamp)
{
    return !(orl_material_focus(lamp) > 0);
}

/* Returns the ray's MIS weight for the light of a lamp at that hit. */
static double share_of_lamp(const struct orl_lit_scene *lit_scene, const struct orl_hit *lamp,
                            const struct orl_mis_pdf *mis_pdf)
{
    if (mis_pdf->mirror > 0 && !orl_virtual_lamps_contain(&lit_scene->virtual_lamps, lamp->facet,
                                                          (uint32_t)(mis_pdf->mirror - 1)))
        return 1;
    if (!(mis_pdf->pdf > 0))
        return 0;
    if (!isfinite(mis_pdf->pdf))
        return 1;
    if (!rays_count_lamp(orl_lit_scene_material(lit_scene, lamp)))
        return 0;
    const double pdf = orl_light_pdf_of_hit(lit_scene, lamp, mis_pdf->from);
    return isfinite(pdf) ? mis_pdf->pdf / (mis_pdf->pdf + pdf) : 0;
}

struct orl_rgb orl_emitted_radiance(const struct orl_lit_scene *lit_scene,
                                    const struct orl_hit *hit, struct orl_vec3 eye,
                                    const struct orl_mis_pdf *mis_pdf)
{
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    const bool glows = orl_material_glows(m);
    if (!glows && !orl_material_is_lamp(m))
        return orl_gray(0);
    if (glows && !orl_is_lamp(lit_scene->geometry, lit_scene->largest_sampled_glow, m, hit->facet))
        return orl_material_emission(m, hit, eye);
    const double share = share_of_lamp(lit_scene, hit, mis_pdf);
    return share > 0 ? orl_rgb_scale(orl_material_emission(m, hit, eye), share) : orl_gray(0);
}

/* Returns the MIS state after a reflection by a mirror: unchanged for lamps that have images in
 * it. */
static struct orl_mis_pdf mis_pdf_after_mirror(const struct orl_lit_scene *lit_scene,
                                               uint32_t facet, struct orl_mis_pdf before)
{
    const struct orl_virtual_lamp *image =
        before.mirror == ORL_MIRROR_NONE
            ? orl_virtual_lamps_in_mirror(&lit_scene->virtual_lamps, facet)
            : NULL;
    if (!image)
        return orl_mis_pdf_infinite();
    return (struct orl_mis_pdf){before.pdf, orl_virtual_lamp_mirror_point(image, before.from),
                                (int64_t)facet + 1};
}

struct orl_mis_pdf orl_mis_pdf_update(const struct orl_lit_scene *lit_scene,
                                      const struct orl_hit *hit, struct orl_vec3 eye,
                                      const struct orl_surface_sample *sample,
                                      struct orl_mis_pdf before)
{
    if (sample->event == ORL_EVENT_STRAIGHT)
        return before;
    if (sample->event == ORL_EVENT_DIFFUSE)
        return orl_mis_pdf_zero();
    if (sample->event == ORL_EVENT_MIRROR)
        return mis_pdf_after_mirror(lit_scene, hit->facet, before);
    if (sample->event != ORL_EVENT_GLOSSY)
        return orl_mis_pdf_infinite();
    if (lit_scene->n_emitters == 0)
        return orl_mis_pdf_zero();
    return (struct orl_mis_pdf){
        lobe_pdf(orl_lit_scene_material(lit_scene, hit), hit, eye, sample->direction),
        orl_hit_ray_origin(lit_scene->geometry, hit, sample->direction), ORL_MIRROR_NONE};
}

/* Returns the radiance towards `from`: at the sampled point for emitters whose radiance varies,
 * the mean for others. */
static struct orl_rgb radiance_of(const struct orl_emitter *emitter,
                                  const struct orl_material *material,
                                  const struct orl_light_sample *sample, struct orl_vec3 from)
{
    if (!orl_material_radiance_varies(material))
        return emitter->radiance;
    const struct orl_hit hit = {.point = orl_madd(from, sample->light, sample->distance),
                                .normal = sample->normal,
                                .facet = emitter->facet,
                                .front = true};
    return orl_material_emission(material, &hit, orl_neg(sample->light));
}

/* Returns radiance times solid angle for a sampled point of a lamp, without occlusion. */
static struct orl_rgb lamp_radiance(const struct orl_lit_scene *lit_scene,
                                    const struct orl_emitter *emitter, struct orl_vec3 from,
                                    const struct orl_light_sample *sample)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    const struct orl_material *m = &lit_scene->materials[facet->material];
    if (!orl_spotlight_covers(m, orl_neg(sample->light)))
        return orl_gray(0);
    const double focus = orl_material_focus(m);
    const double spread = focus > 0 ? orl_spotlight_falloff(focus, sample->distance) : 1;
    return orl_rgb_scale(radiance_of(emitter, m, sample, from), sample->measure_sr * spread);
}

/* Returns the transmittance to a point of a lamp at a distance. */
static struct orl_rgb transmittance_to_lamp(const struct orl_lit_scene *lit_scene,
                                            struct orl_vec3 origin, struct orl_vec3 light,
                                            double distance, uint32_t lamp, bool through_ports)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, lamp, &own);
    const double reach = distance - 2 * facet->offset;
    struct segment segment = segment_to(origin, light, reach, through_ports);
    segment.target = orl_facet_is_plane(facet) ? lamp : no_target;
    return reach > 0 ? transmittance_of(lit_scene, &segment) : orl_gray(1);
}

struct orl_rgb orl_light_sample_radiance(const struct orl_lit_scene *lit_scene,
                                         const struct orl_emitter *emitter, struct orl_vec3 from,
                                         const struct orl_light_sample *sample, bool through_ports)
{
    const struct orl_rgb shining = lamp_radiance(lit_scene, emitter, from, sample);
    if (!(orl_rgb_max(shining) > 0))
        return shining;
    return orl_rgb_mul(shining,
                       transmittance_to_lamp(lit_scene, from, sample->light, sample->distance,
                                             emitter->facet, through_ports));
}

/* Returns the shadow ray's MIS weight for a lamp in that direction. The rest is left to rays
 * that are sampled from the query's lobes. */
static double shadow_ray_weight(const struct orl_lit_scene *lit_scene,
                                const struct orl_direct_query *query,
                                const struct orl_emitter *emitter,
                                const struct orl_light_sample *sample, struct orl_vec3 direction)
{
    if (!query->lobes || !rays_count_lamp(orl_lit_scene_material_of(lit_scene, emitter->facet)))
        return 1;
    return orl_light_sample_pdf(sample) /
           (orl_light_sample_pdf(sample) +
            lobe_pdf(query->lobes, query->hit, query->eye, direction));
}

static struct orl_rgb light_from_emitter(const struct orl_lit_scene *lit_scene,
                                         const struct orl_emitter *emitter,
                                         const struct orl_direct_query *query, const double u[2])
{
    struct orl_light_sample sample;
    if (!orl_light_sample(lit_scene, emitter, query->point, u, &sample))
        return orl_gray(0);
    const struct orl_rgb seen = response(query, sample.light);
    if (!(orl_rgb_max(seen) > 0))
        return orl_gray(0);
    const struct orl_rgb arriving =
        orl_light_sample_radiance(lit_scene, emitter, query->point, &sample, query->through_ports);
    return orl_rgb_scale(orl_rgb_mul(arriving, seen),
                         shadow_ray_weight(lit_scene, query, emitter, &sample, sample.light));
}

/* Returns the transmittance from the query's point in that direction, by the mirror, to the
 * sampled point of the lamp. */
static struct orl_rgb mirrored_transmittance(const struct orl_lit_scene *lit_scene,
                                             const struct orl_direct_query *query,
                                             const struct orl_virtual_lamp *image,
                                             const struct orl_light_sample *sample,
                                             struct orl_vec3 direction)
{
    struct orl_hit hit;
    const struct orl_rgb before = orl_transmittance_to_facet(
        lit_scene, query->point, direction, query->through_ports, image->mirror, &hit);
    if (!(orl_rgb_max(before) > 0))
        return orl_gray(0);
    const double distance = orl_length(orl_sub(hit.point, query->point));
    struct orl_rgb share =
        orl_rgb_mul(before, orl_material_mirrored(orl_lit_scene_material(lit_scene, &hit), &hit,
                                                  orl_neg(direction)));
    if (!(orl_rgb_max(share) > 0) || !(distance < sample->distance))
        return orl_gray(0);
    if (lit_scene->scene->mist)
        share = orl_rgb_mul(
            share, orl_volume_transmittance(lit_scene->scene, query->point, direction, distance));
    return orl_rgb_mul(
        share, transmittance_to_lamp(
                   lit_scene, orl_hit_ray_origin(lit_scene->geometry, &hit, sample->light),
                   sample->light, sample->distance - distance, image->lamp, query->through_ports));
}

/* Returns the light of a lamp in a mirror, sampled from the mirror image of the query's point
 * (virtual_lamps.h). */
static struct orl_rgb light_of_virtual_lamp(const struct orl_lit_scene *lit_scene,
                                            const struct orl_virtual_lamp *image,
                                            const struct orl_direct_query *query, const double u[2])
{
    const struct orl_emitter *emitter = &lit_scene->emitters[image->emitter];
    const struct orl_vec3 from = orl_virtual_lamp_mirror_point(image, query->point);
    const double height = orl_virtual_lamp_height(image, query->point);
    struct orl_light_sample sample;
    if (!orl_light_sample(lit_scene, emitter, from, u, &sample))
        return orl_gray(0);
    const double along = height / orl_dot(sample.light, image->normal);
    if (!(along > 0) || !(along < sample.distance))
        return orl_gray(0);
    const struct orl_vec3 off = orl_sub(orl_madd(from, sample.light, along), image->center);
    const struct orl_vec3 direction = orl_virtual_lamp_reflect(image, sample.light);
    const struct orl_rgb seen = response(query, direction);
    if (!(orl_rgb_max(seen) > 0) || orl_dot(off, off) > image->radius * image->radius)
        return orl_gray(0);
    const struct orl_rgb shining = lamp_radiance(lit_scene, emitter, from, &sample);
    if (!(orl_rgb_max(shining) > 0))
        return orl_gray(0);
    const struct orl_rgb share =
        mirrored_transmittance(lit_scene, query, image, &sample, direction);
    return orl_rgb_scale(orl_rgb_mul(orl_rgb_mul(shining, share), seen),
                         shadow_ray_weight(lit_scene, query, emitter, &sample, direction));
}

/* Computes the random numbers for the n-th light. Those of the caller are shifted by n times the
 * inverse golden ratio and n times the inverse plastic number, modulo 1. */
static void light_numbers(const struct orl_direct_query *query, size_t n, struct orl_random *random,
                          double ret_u[2])
{
    for (int i = 0; i < 2; i++) {
        const double turn = (double)n * (i == 0 ? 0.6180339887498949 : 0.7548776662466927);
        ret_u[i] = query->u ? query->u[i] + turn : orl_random_uniform(random);
        ret_u[i] -= floor(ret_u[i]);
    }
}

/* Returns the light of a sun's images in the scene's mirrors. u: numbers for the point of the
 * disc. */
static struct orl_rgb light_of_virtual_sun(const struct orl_lit_scene *lit_scene, size_t sun,
                                           const struct orl_direct_query *query, const double u[2])
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < lit_scene->images.n_nodes; i++) {
        const struct orl_virtual_sun *image = &lit_scene->images.nodes[i];
        if (!image->shown || image->sun != sun ||
            !orl_virtual_suns_may_show(&lit_scene->images, i, query->point))
            continue;
        const struct orl_vec3 light = orl_virtual_sun_sample(lit_scene, image, u);
        const struct orl_rgb seen = response(query, light);
        if (!(orl_rgb_max(seen) > 0))
            continue;
        const struct orl_rgb share = orl_virtual_sun_transmittance(lit_scene, query->point, light,
                                                                   image, query->through_ports);
        sum = orl_rgb_add(sum,
                          orl_rgb_mul(orl_rgb_mul(lit_scene->suns[sun].irradiance, seen), share));
    }
    return sum;
}

struct orl_rgb orl_direct_light(const struct orl_lit_scene *lit_scene,
                                const struct orl_direct_query *query, struct orl_random *random)
{
    struct orl_rgb sum = orl_gray(0);
    double u[2];
    for (size_t i = 0; i < lit_scene->n_suns; i++) {
        const struct orl_sun *sun = &lit_scene->suns[i];
        light_numbers(query, i, random, u);
        const struct orl_vec3 light = orl_sun_sample(sun, u);
        const struct orl_rgb seen = response(query, light);
        if (query->mirrored)
            sum = orl_rgb_add(sum, light_of_virtual_sun(lit_scene, i, query, u));
        if (!(orl_rgb_max(seen) > 0))
            continue;
        const struct orl_rgb share =
            orl_transmittance(lit_scene, query->point, light, INFINITY, query->through_ports);
        sum = orl_rgb_add(sum, orl_rgb_mul(orl_rgb_mul(sun->irradiance, seen), share));
    }
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        if (!lit_scene->emitters[i].direct)
            continue;
        light_numbers(query, lit_scene->n_suns + i, random, u);
        sum = orl_rgb_add(sum, light_from_emitter(lit_scene, &lit_scene->emitters[i], query, u));
    }
    const size_t n_images =
        query->mirrored && lit_scene->n_emitters > 0 ? lit_scene->virtual_lamps.n_images : 0;
    for (size_t i = 0; i < n_images; i++) {
        const struct orl_virtual_lamp *image = &lit_scene->virtual_lamps.images[i];
        light_numbers(query, lit_scene->n_suns + lit_scene->n_emitters + i, random, u);
        sum = orl_rgb_add(sum, light_of_virtual_lamp(lit_scene, image, query, u));
    }
    return sum;
}

struct orl_rgb orl_direct_by_virtual_suns(const struct orl_lit_scene *lit_scene,
                                          const struct orl_direct_query *query,
                                          struct orl_random *random)
{
    struct orl_rgb sum = orl_gray(0);
    double u[2];
    for (size_t i = 0; i < lit_scene->n_suns; i++) {
        light_numbers(query, i, random, u);
        sum = orl_rgb_add(sum, light_of_virtual_sun(lit_scene, i, query, u));
    }
    return sum;
}

struct orl_rgb orl_direct_by_lobes(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                                   const struct orl_material *material, struct orl_vec3 eye,
                                   struct orl_random *random)
{
    const struct orl_vec3 seen = orl_hit_facing(hit);
    struct orl_rgb sum = orl_gray(0);
    for (int side = 0; side < (orl_material_transmits_lobes(material) ? 2 : 1); side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_direct_query query = {
            .point = orl_hit_ray_origin(lit_scene->geometry, hit, normal),
            .normal = normal,
            .through_ports = true,
            .lobes = material,
            .hit = hit,
            .eye = eye,
            .mirrored = true};
        sum = orl_rgb_add(sum, orl_direct_light(lit_scene, &query, random));
    }
    return sum;
}

struct orl_rgb orl_direct_in_volume(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                                    struct orl_vec3 along, double asymmetry,
                                    struct orl_random *random)
{
    const struct orl_direct_query query = {.point = point,
                                           .normal = along,
                                           .through_ports = true,
                                           .eye = orl_neg(along),
                                           .mist = true,
                                           .asymmetry = asymmetry,
                                           .mirrored = true};
    return orl_direct_light(lit_scene, &query, random);
}
