#include "run/diagnostics/cross_check_path.h"

#include "light/exterior.h"
#include "light/eye_path.h"
#include "scene/material/hemisphere.h"

enum { SURE_BOUNCES = 2 };

struct plain_path {
    struct orl_eye_path eye; /* must be first: sinks receive a pointer to it */
    struct orl_health *health;
    uint32_t reflections, most_reflections; /* number of diffuse reflections, and its limit */
    /* Radiance before the first diffuse reflection: suns and lamps that surfaces on the path
     * reflect diffusely (lit), and the rest, which is set at that reflection. */
    struct orl_rgb lit, unreflected;
};

static struct plain_path *plain_path_of(struct orl_eye_path *p)
{
    return (struct plain_path *)p;
}

static struct orl_rgb subtract(struct orl_rgb a, struct orl_rgb b)
{
    return orl_rgb_add(a, orl_rgb_scale(b, -1));
}

static bool continue_outdoors(struct orl_eye_path *p)
{
    return orl_exterior_continue(p, plain_path_of(p)->health);
}

/* Returns the radiance that a diffuse surface reflects of suns and lamps. */
static struct orl_rgb lit_by_lights(struct orl_eye_path *p, struct orl_rgb albedo)
{
    const struct orl_vec3 normal = orl_hit_facing(&p->hit);
    const struct orl_direct_query query = {
        .point = orl_hit_ray_origin(p->lit_scene->geometry, &p->hit, normal),
        .normal = normal,
        .through_ports = true,
        .mirrored = true};
    return orl_rgb_scale(orl_rgb_mul(albedo, orl_direct_light(p->lit_scene, &query, p->random)),
                         1 / ORL_PI);
}

/* Adds the light that the surface emits, and that it reflects of suns and lamps. */
static enum orl_lobes shade_hit(struct orl_eye_path *p, const struct orl_material *m)
{
    struct plain_path *t = plain_path_of(p);
    const struct orl_vec3 eye = orl_path_back(&p->path);
    const struct orl_rgb albedo = orl_material_diffuse(m, &p->hit);
    const bool reflects = t->reflections < t->most_reflections;
    orl_eye_path_add_radiance(p, orl_emitted_radiance(p->lit_scene, &p->hit, eye, &p->chance));
    if (orl_rgb_max(albedo) > 0 && reflects) {
        const struct orl_rgb before = p->seen;
        orl_eye_path_add_radiance(p, lit_by_lights(p, albedo));
        if (t->reflections == 0)
            t->lit = orl_rgb_add(t->lit, subtract(p->seen, before));
    }
    if (orl_material_has_lobes(m))
        orl_eye_path_add_radiance(p, orl_direct_by_lobes(p->lit_scene, &p->hit, m, eye, p->random));
    return reflects ? ORL_LOBE_ALL : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
}

static bool continue_path(struct orl_eye_path *p, const struct orl_surface_sample *s)
{
    struct plain_path *t = plain_path_of(p);
    if (p->bounce >= SURE_BOUNCES &&
        !orl_path_roulette(&p->path, orl_smaller(orl_rgb_max(p->path.weight), 1), p->random))
        return false;
    p->chance = orl_mis_pdf_update(p->lit_scene, &p->hit, orl_path_back(&p->path), s, p->chance);
    if (s->event == ORL_EVENT_DIFFUSE && t->reflections++ == 0)
        t->unreflected = subtract(p->seen, t->lit);
    orl_eye_path_cross_port(p, s);
    return true;
}

static const struct orl_path_visitor visitor = {
    .on_outdoors = continue_outdoors, .met = shade_hit, .on_sampled = continue_path};

static double lux_of(struct orl_rgb irradiance)
{
    return ORL_EFFICACY_LM_PER_W * orl_luma(irradiance);
}

/* Adds the light of suns and lamps by shadow rays from the place. The same points of the lights are
 * sampled with mirrors and without, and the difference is the mirrored light. */
static void add_lights(const struct orl_lit_scene *lit_scene, const struct orl_shading_point *place,
                       struct orl_random *random, struct orl_plain_light *light)
{
    const double u0 = orl_random_uniform(random), u[2] = {u0, orl_random_uniform(random)};
    struct orl_direct_query query = {
        .point = place->point, .normal = place->normal, .through_ports = true, .u = u};
    light->lx[ORL_LIGHT_STRAIGHT] = lux_of(orl_direct_light(lit_scene, &query, random));
    if (lit_scene->images.n_mirrors == 0 && lit_scene->virtual_lamps.n_images == 0)
        return;
    query.mirrored = true;
    light->lx[ORL_LIGHT_MIRRORED] =
        lux_of(orl_direct_light(lit_scene, &query, random)) - light->lx[ORL_LIGHT_STRAIGHT];
}

struct orl_plain_light orl_plain_path(const struct orl_lit_scene *lit_scene,
                                      const struct orl_shading_point *place,
                                      uint32_t most_reflections, struct orl_random *random,
                                      struct orl_health *health)
{
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    struct orl_plain_light light = {{0}};
    struct plain_path plain_path = {
        .eye = {.lit_scene = lit_scene,
                .random = random,
                .path = orl_path_from(place->point, orl_hemisphere_about(place->normal, u0, u1)),
                .chance = orl_mis_pdf_zero(),
                .outside = place->outside},
        .health = health,
        .most_reflections = most_reflections};
    add_lights(lit_scene, place, random, &light);
    orl_eye_path_trace(&plain_path.eye, &visitor, health);
    const struct orl_rgb unreflected = plain_path.reflections > 0
                                           ? plain_path.unreflected
                                           : subtract(plain_path.eye.seen, plain_path.lit);
    light.lx[ORL_LIGHT_OUTDOORS] = ORL_PI * lux_of(unreflected);
    light.lx[ORL_LIGHT_REFLECTED] = ORL_PI * lux_of(subtract(plain_path.eye.seen, unreflected));
    return light;
}
