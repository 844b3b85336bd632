#include "light/direct.h"

#include "light/mist.h"
#include "light/path.h"

enum { MOST_PANES = 64 };
static const uint32_t no_target = UINT32_MAX;

/* A shadow ray. */
struct way {
    struct orl_vec3 origin, direction;
    double max_distance;
    bool through_ports;
    /* its target is neither sun nor lamp: the front of an illum blocks it */
    bool to_surface;
    /* the facet that it is traced to, which does not block it; or no_target */
    uint32_t target;
    int32_t *port; /* in and out as in orl_transmittance_by; or NULL */
};

static struct way way_to(struct orl_vec3 origin, struct orl_vec3 direction, double max_distance,
                         bool through_ports)
{
    return (struct way){.origin = origin,
                        .direction = direction,
                        .max_distance = max_distance,
                        .through_ports = through_ports,
                        .target = no_target};
}

static bool is_hidden(const struct way *way, const struct orl_material *m,
                      const struct orl_hit *hit)
{
    return way->to_surface && m->kind == ORL_MATERIAL_ILLUM && hit->front;
}

static struct orl_rgb panes_transmittance(const struct orl_world *world, const struct way *way)
{
    struct orl_path path = orl_path_from(way->origin, way->direction);
    double max_distance = way->max_distance;
    for (int pane = 0; pane < MOST_PANES; pane++) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(world->geometry, path.origin, way->direction, max_distance,
                                    &hit))
            return path.weight;
        if (hit.facet == way->target)
            return path.weight;
        const struct orl_material *m = orl_world_material(world, &hit);
        if (is_hidden(way, m, &hit) || !orl_path_look_through(&path, m, &hit) ||
            (!way->through_ports && orl_world_crossing(world, &hit) != ORL_CROSSING_NONE))
            return orl_gray(0);
        if (way->port && *way->port == ORL_NO_PORT &&
            orl_world_crossing(world, &hit) == ORL_CROSSING_OUTWARDS)
            *way->port = orl_world_port_of(world, hit.facet);
        if (isinf(max_distance) && orl_world_leaves_clear(world, &hit))
            return path.weight;
        /* The ray starts again a little further on, but its end stays the same. */
        const struct orl_vec3 before = path.origin;
        orl_path_pass(&path, world, &hit);
        max_distance -= orl_dot(orl_sub(path.origin, before), way->direction);
    }
    return orl_gray(0);
}

/* Returns the transmittance of panes on the way to a mirror, and the hit on the mirror. Returns
 * zero if the ray meets anything opaque before it. */
static struct orl_rgb panes_transmittance_to_mirror(const struct orl_world *world,
                                                    struct orl_vec3 origin,
                                                    struct orl_vec3 direction, bool through_ports,
                                                    uint32_t mirror, struct orl_hit *ret_hit)
{
    struct orl_path path = orl_path_from(origin, direction);
    for (int pane = 0; pane < MOST_PANES; pane++) {
        if (!orl_path_meet(world, &path, ret_hit))
            return orl_gray(0);
        if (ret_hit->facet == mirror)
            return path.weight;
        if (!orl_path_look_through(&path, orl_world_material(world, ret_hit), ret_hit) ||
            (!through_ports && orl_world_crossing(world, ret_hit) != ORL_CROSSING_NONE))
            return orl_gray(0);
        orl_path_pass(&path, world, ret_hit);
    }
    return orl_gray(0);
}

static struct orl_rgb transmittance_of(const struct orl_world *world, const struct way *way)
{
    const struct orl_rgb share = panes_transmittance(world, way);
    if (!world->scene->mist || !(orl_rgb_max(share) > 0))
        return share;
    return orl_rgb_mul(share, orl_mist_transmittance(world->scene, way->origin, way->direction,
                                                     way->max_distance));
}

struct orl_rgb orl_transmittance(const struct orl_world *world, struct orl_vec3 origin,
                                 struct orl_vec3 direction, double max_distance, bool through_ports)
{
    const struct way way = way_to(origin, direction, max_distance, through_ports);
    return transmittance_of(world, &way);
}

struct orl_rgb orl_transmittance_to_surface(const struct orl_world *world, struct orl_vec3 origin,
                                            struct orl_vec3 direction, double max_distance,
                                            bool through_ports)
{
    struct way way = way_to(origin, direction, max_distance, through_ports);
    way.to_surface = true;
    return transmittance_of(world, &way);
}

struct orl_rgb orl_transmittance_by(const struct orl_world *world, struct orl_vec3 origin,
                                    struct orl_vec3 direction, int32_t *port)
{
    struct way way = way_to(origin, direction, INFINITY, true);
    way.port = port;
    return transmittance_of(world, &way);
}

/* Returns the cosine for irradiance, or the lobes' value times the cosine for radiance towards
 * the eye. */
static struct orl_rgb response(const struct orl_direct_query *query, struct orl_vec3 light)
{
    if (query->mist)
        return orl_gray(orl_phase(query->forward, -orl_dot(light, query->eye)));
    const double cosine = orl_dot(light, query->normal);
    if (!(cosine > 0))
        return orl_gray(0);
    if (!query->lobes)
        return orl_gray(query->shading ? fmax(orl_dot(light, *query->shading), 0) : cosine);
    return orl_rgb_scale(orl_scatter_eval_lobes(query->lobes, query->hit, light, query->eye),
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
    return orl_scatter_pdf(material, hit, eye, ORL_TRANSPORT_EYE,
                           (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), towards);
}

/* Returns true if rays count the lamp's light: a spotlight's focus is implemented for shadow
 * rays only. */
static bool rays_count_lamp(const struct orl_material *lamp)
{
    return !(lamp->focus > 0);
}

/* Returns the ray's MIS weight for the light of a lamp at that hit. */
static double share_of_lamp(const struct orl_world *world, const struct orl_hit *lamp,
                            const struct orl_chance *chance)
{
    if (chance->mirror > 0 &&
        !orl_lamp_images_cover(&world->lamp_images, lamp->facet, (uint32_t)(chance->mirror - 1)))
        return 1;
    if (!(chance->pdf > 0))
        return 0;
    if (!isfinite(chance->pdf))
        return 1;
    if (!rays_count_lamp(orl_world_material(world, lamp)))
        return 0;
    const double pdf = orl_lamp_aim_pdf_of_hit(world, lamp, chance->from);
    return isfinite(pdf) ? chance->pdf / (chance->pdf + pdf) : 0;
}

struct orl_rgb orl_shining(const struct orl_world *world, const struct orl_hit *hit,
                           struct orl_vec3 eye, const struct orl_chance *chance)
{
    const struct orl_material *m = orl_world_material(world, hit);
    const bool glows = orl_material_glows(m);
    if (!glows && !orl_material_is_lamp(m))
        return orl_gray(0);
    if (glows && !orl_is_lamp(world->geometry, world->most_aimed_glow, m, hit->facet))
        return orl_material_emission(m, hit, eye);
    const double share = share_of_lamp(world, hit, chance);
    return share > 0 ? orl_rgb_scale(orl_material_emission(m, hit, eye), share) : orl_gray(0);
}

/* Returns the MIS state after a reflection by a mirror: unchanged for lamps that have images in
 * it. */
static struct orl_chance chance_after_mirror(const struct orl_world *world, uint32_t facet,
                                             struct orl_chance before)
{
    const struct orl_lamp_image *image =
        before.mirror == ORL_MIRROR_NONE ? orl_lamp_images_in(&world->lamp_images, facet) : NULL;
    if (!image)
        return orl_chance_unsought();
    return (struct orl_chance){before.pdf, orl_lamp_image_of(image, before.from),
                               (int64_t)facet + 1};
}

struct orl_chance orl_chance_after(const struct orl_world *world, const struct orl_hit *hit,
                                   struct orl_vec3 eye, const struct orl_scatter *scatter,
                                   struct orl_chance before)
{
    if (scatter->event == ORL_EVENT_STRAIGHT)
        return before;
    if (scatter->event == ORL_EVENT_DIFFUSE)
        return orl_chance_found();
    if (scatter->event == ORL_EVENT_MIRROR)
        return chance_after_mirror(world, hit->facet, before);
    if (scatter->event != ORL_EVENT_GLOSSY)
        return orl_chance_unsought();
    if (world->n_emitters == 0)
        return orl_chance_found();
    return (struct orl_chance){
        lobe_pdf(orl_world_material(world, hit), hit, eye, scatter->direction),
        orl_hit_leave(world->geometry, hit, scatter->direction), ORL_MIRROR_NONE};
}

/* Returns the radiance towards `from`: at the sampled point for emitters whose radiance varies,
 * the mean for others. */
static struct orl_rgb radiance_of(const struct orl_emitter *emitter,
                                  const struct orl_material *material,
                                  const struct orl_lamp_aim *aim, struct orl_vec3 from)
{
    if (!orl_material_radiance_varies(material))
        return emitter->radiance;
    const struct orl_hit hit = {.point = orl_madd(from, aim->light, aim->distance),
                                .normal = aim->normal,
                                .facet = emitter->facet,
                                .front = true};
    return orl_material_emission(material, &hit, orl_neg(aim->light));
}

static bool is_flat(const struct orl_facet *facet)
{
    return facet->kind == ORL_SURFACE_RING || (facet->kind == ORL_SURFACE_POLYGON && !facet->bent);
}

/* Returns radiance times solid angle for a sampled point of a lamp, without occlusion. */
static struct orl_rgb lamp_shining(const struct orl_world *world, const struct orl_emitter *emitter,
                                   struct orl_vec3 from, const struct orl_lamp_aim *aim)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_own(world->geometry, emitter->facet, &own);
    const struct orl_material *m = &world->materials[facet->material];
    if (!orl_material_beams(m, orl_neg(aim->light)))
        return orl_gray(0);
    const double spread = m->focus > 0 ? orl_spot_spread(m->focus, aim->distance) : 1;
    return orl_rgb_scale(radiance_of(emitter, m, aim, from), aim->measure_sr * spread);
}

/* Returns the transmittance to a point of a lamp at a distance. */
static struct orl_rgb transmittance_to_lamp(const struct orl_world *world, struct orl_vec3 origin,
                                            struct orl_vec3 light, double distance, uint32_t lamp,
                                            bool through_ports)
{
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_own(world->geometry, lamp, &own);
    const double reach = distance - 2 * facet->offset;
    struct way way = way_to(origin, light, reach, through_ports);
    way.target = is_flat(facet) ? lamp : no_target;
    return reach > 0 ? transmittance_of(world, &way) : orl_gray(1);
}

struct orl_rgb orl_lamp_arriving(const struct orl_world *world, const struct orl_emitter *emitter,
                                 struct orl_vec3 from, const struct orl_lamp_aim *aim,
                                 bool through_ports)
{
    const struct orl_rgb shining = lamp_shining(world, emitter, from, aim);
    if (!(orl_rgb_max(shining) > 0))
        return shining;
    return orl_rgb_mul(shining, transmittance_to_lamp(world, from, aim->light, aim->distance,
                                                      emitter->facet, through_ports));
}

/* Returns the shadow ray's MIS weight for a lamp in that direction. The rest is left to rays
 * that are sampled from the query's lobes. */
static double shadow_ray_weight(const struct orl_world *world, const struct orl_direct_query *query,
                                const struct orl_emitter *emitter, const struct orl_lamp_aim *aim,
                                struct orl_vec3 direction)
{
    const uint32_t material = orl_facet_material(world->geometry, emitter->facet);
    if (!query->lobes || !rays_count_lamp(&world->materials[material]))
        return 1;
    return orl_lamp_aim_pdf(aim) /
           (orl_lamp_aim_pdf(aim) + lobe_pdf(query->lobes, query->hit, query->eye, direction));
}

static struct orl_rgb light_from_emitter(const struct orl_world *world,
                                         const struct orl_emitter *emitter,
                                         const struct orl_direct_query *query, const double u[2])
{
    struct orl_lamp_aim aim;
    if (!orl_lamp_aim(world, emitter, query->point, u, &aim))
        return orl_gray(0);
    const struct orl_rgb seen = response(query, aim.light);
    if (!(orl_rgb_max(seen) > 0))
        return orl_gray(0);
    const struct orl_rgb arriving =
        orl_lamp_arriving(world, emitter, query->point, &aim, query->through_ports);
    return orl_rgb_scale(orl_rgb_mul(arriving, seen),
                         shadow_ray_weight(world, query, emitter, &aim, aim.light));
}

/* Returns the transmittance from the query's point in that direction, by the mirror, to the
 * sampled point of the lamp. */
static struct orl_rgb mirrored_transmittance(const struct orl_world *world,
                                             const struct orl_direct_query *query,
                                             const struct orl_lamp_image *image,
                                             const struct orl_lamp_aim *aim,
                                             struct orl_vec3 direction)
{
    struct orl_hit hit;
    const struct orl_rgb before = panes_transmittance_to_mirror(
        world, query->point, direction, query->through_ports, image->mirror, &hit);
    if (!(orl_rgb_max(before) > 0))
        return orl_gray(0);
    const double distance = orl_length(orl_sub(hit.point, query->point));
    struct orl_rgb share = orl_rgb_mul(
        before, orl_material_mirrored(orl_world_material(world, &hit), &hit, orl_neg(direction)));
    if (!(orl_rgb_max(share) > 0) || !(distance < aim->distance))
        return orl_gray(0);
    if (world->scene->mist)
        share = orl_rgb_mul(
            share, orl_mist_transmittance(world->scene, query->point, direction, distance));
    return orl_rgb_mul(
        share,
        transmittance_to_lamp(world, orl_hit_leave(world->geometry, &hit, aim->light), aim->light,
                              aim->distance - distance, image->lamp, query->through_ports));
}

/* Returns the light of a lamp in a mirror, sampled from the mirror image of the query's point
 * (lamp_images.h). */
static struct orl_rgb mirrored_lamp(const struct orl_world *world,
                                    const struct orl_lamp_image *image,
                                    const struct orl_direct_query *query, const double u[2])
{
    const struct orl_emitter *emitter = &world->emitters[image->emitter];
    const struct orl_vec3 from = orl_lamp_image_of(image, query->point);
    const double height = orl_lamp_image_height(image, query->point);
    struct orl_lamp_aim aim;
    if (!orl_lamp_aim(world, emitter, from, u, &aim))
        return orl_gray(0);
    const double along = height / orl_dot(aim.light, image->normal);
    if (!(along > 0) || !(along < aim.distance))
        return orl_gray(0);
    const struct orl_vec3 off = orl_sub(orl_madd(from, aim.light, along), image->center);
    const struct orl_vec3 direction = orl_lamp_image_turned(image, aim.light);
    const struct orl_rgb seen = response(query, direction);
    if (!(orl_rgb_max(seen) > 0) || orl_dot(off, off) > image->radius * image->radius)
        return orl_gray(0);
    const struct orl_rgb shining = lamp_shining(world, emitter, from, &aim);
    if (!(orl_rgb_max(shining) > 0))
        return orl_gray(0);
    const struct orl_rgb share = mirrored_transmittance(world, query, image, &aim, direction);
    return orl_rgb_scale(orl_rgb_mul(orl_rgb_mul(shining, share), seen),
                         shadow_ray_weight(world, query, emitter, &aim, direction));
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
static struct orl_rgb mirrored_sun(const struct orl_world *world, size_t sun,
                                   const struct orl_direct_query *query, const double u[2])
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->images.n_nodes; i++) {
        const struct orl_image *image = &world->images.nodes[i];
        if (!image->shown || image->sun != sun ||
            !orl_images_may_show(&world->images, i, query->point))
            continue;
        const struct orl_vec3 light = orl_image_sample(world, image, u);
        const struct orl_rgb seen = response(query, light);
        if (!(orl_rgb_max(seen) > 0))
            continue;
        const struct orl_rgb share =
            orl_image_transmittance(world, query->point, light, image, query->through_ports);
        sum = orl_rgb_add(sum, orl_rgb_mul(orl_rgb_mul(world->suns[sun].irradiance, seen), share));
    }
    return sum;
}

struct orl_rgb orl_direct_light(const struct orl_world *world, const struct orl_direct_query *query,
                                struct orl_random *random)
{
    struct orl_rgb sum = orl_gray(0);
    double u[2];
    for (size_t i = 0; i < world->n_suns; i++) {
        const struct orl_sun *sun = &world->suns[i];
        light_numbers(query, i, random, u);
        const struct orl_vec3 light = orl_sun_sample(sun, u);
        const struct orl_rgb seen = response(query, light);
        if (query->mirrored)
            sum = orl_rgb_add(sum, mirrored_sun(world, i, query, u));
        if (!(orl_rgb_max(seen) > 0))
            continue;
        const struct orl_rgb share =
            orl_transmittance(world, query->point, light, INFINITY, query->through_ports);
        sum = orl_rgb_add(sum, orl_rgb_mul(orl_rgb_mul(sun->irradiance, seen), share));
    }
    for (size_t i = 0; i < world->n_emitters; i++) {
        if (!world->emitters[i].direct)
            continue;
        light_numbers(query, world->n_suns + i, random, u);
        sum = orl_rgb_add(sum, light_from_emitter(world, &world->emitters[i], query, u));
    }
    const size_t n_images =
        query->mirrored && world->n_emitters > 0 ? world->lamp_images.n_images : 0;
    for (size_t i = 0; i < n_images; i++) {
        const struct orl_lamp_image *image = &world->lamp_images.images[i];
        light_numbers(query, world->n_suns + world->n_emitters + i, random, u);
        sum = orl_rgb_add(sum, mirrored_lamp(world, image, query, u));
    }
    return sum;
}

struct orl_rgb orl_direct_by_images(const struct orl_world *world,
                                    const struct orl_direct_query *query, struct orl_random *random)
{
    struct orl_rgb sum = orl_gray(0);
    double u[2];
    for (size_t i = 0; i < world->n_suns; i++) {
        light_numbers(query, i, random, u);
        sum = orl_rgb_add(sum, mirrored_sun(world, i, query, u));
    }
    return sum;
}

struct orl_rgb orl_direct_by_lobes(const struct orl_world *world, const struct orl_hit *hit,
                                   const struct orl_material *material, struct orl_vec3 eye,
                                   struct orl_random *random)
{
    const struct orl_vec3 seen = orl_hit_facing(hit);
    struct orl_rgb sum = orl_gray(0);
    for (int side = 0; side < (orl_material_transmits_lobes(material) ? 2 : 1); side++) {
        const struct orl_vec3 normal = side == 0 ? seen : orl_neg(seen);
        const struct orl_direct_query query = {.point = orl_hit_leave(world->geometry, hit, normal),
                                               .normal = normal,
                                               .through_ports = true,
                                               .lobes = material,
                                               .hit = hit,
                                               .eye = eye,
                                               .mirrored = true};
        sum = orl_rgb_add(sum, orl_direct_light(world, &query, random));
    }
    return sum;
}

struct orl_rgb orl_direct_in_mist(const struct orl_world *world, struct orl_vec3 point,
                                  struct orl_vec3 along, double forward, struct orl_random *random)
{
    const struct orl_direct_query query = {.point = point,
                                           .normal = along,
                                           .through_ports = true,
                                           .eye = orl_neg(along),
                                           .mist = true,
                                           .forward = forward,
                                           .mirrored = true};
    return orl_direct_light(world, &query, random);
}
