#include "light/lights.h"

#include <stdlib.h>

#include <oriel/base/sha256.h>

#include "base/multiversion.h"
#include "base/sampling/sampling.h"
#include "light/daylight/daylight.h"
#include "scene/material/kinds.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"

/* Distant lights up to this full angle are sampled as discs; wider ones are domes. */
static const double widest_sun_deg = 10.0;

enum { OF_A_SKY = 2 }; /* number of domes: the sky and the ground */

struct orl_rgb orl_dome_radiance(const struct orl_dome *dome, struct orl_vec3 direction)
{
    if (dome->pattern)
        return orl_rgb_mul(dome->radiance, orl_pattern_of_sky(dome->pattern, direction));
    const double pattern = dome->sky ? orl_sky_brightness(dome->sky, direction) : 1.0;
    return orl_rgb_scale(dome->radiance, pattern);
}

/* Adds a distant light of that full angle: a dome, or a sun if it is a small light. */
static void add_distant(struct orl_lights *lights, struct orl_dome distant, double angle_deg)
{
    const double half = 0.5 * angle_deg * ORL_DEG_TO_RAD;
    distant.cos_half_angle = cos(half);
    if (!distant.light || angle_deg > widest_sun_deg) {
        lights->domes[lights->n_domes++] = distant;
        return;
    }
    /* 1 - cos without cancellation: the sun's disc is only half a degree wide. */
    const double solid = 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
    struct orl_sun sun = {.frame = orl_frame_about(distant.direction),
                          .cos_half_angle = distant.cos_half_angle,
                          .solid_angle_sr = solid,
                          .radiance = orl_dome_radiance(&distant, distant.direction)};
    sun.irradiance = orl_rgb_scale(sun.radiance, solid);
    if (orl_luma(sun.radiance) > 0)
        lights->suns[lights->n_suns++] = sun;
}

static void add_scene_lights(struct orl_lights *lights)
{
    const struct orl_parsed_scene *d = &lights->scene->parsed_scene;
    for (size_t i = 0; i < d->n_distant_sources; i++) {
        const struct orl_material *m = &d->materials[d->distant_sources[i].material];
        const struct orl_dome distant = {.direction = d->distant_sources[i].direction,
                                         .radiance = m->color,
                                         .sky = m->sky >= 0 ? &d->skies[m->sky] : NULL,
                                         .pattern = m->pattern,
                                         .light = m->kind == ORL_MATERIAL_LIGHT,
                                         .views_only = m->kind == ORL_MATERIAL_GLOW &&
                                                       !orl_material_glows(m)};
        add_distant(lights, distant, d->distant_sources[i].angle_deg);
    }
}

static void add_sky_lights(struct orl_lights *lights, const struct orl_daylight *sky)
{
    const struct orl_dome sun = {.direction = orl_normalize(sky->sun),
                                 .radiance = orl_gray(sky->sun_radiance),
                                 .light = true};
    struct orl_dome half = {
        .direction = {0, 0, 1}, .radiance = orl_gray(1), .sky = &lights->pattern};
    if (sky->black)
        return;
    lights->pattern = sky->pattern;
    if (sky->sun_radiance > 0)
        add_distant(lights, sun, sky->sun_angle_deg);
    add_distant(lights, half, 180);
    half.direction = orl_neg(half.direction);
    add_distant(lights, half, 180);
}

/* Limits for sampling glows as lamps: their number, and the area of each as a share of that of a
 * sphere around the scene. */
enum { MOST_AIMED_GLOWS = 64 };
static const double most_of_sphere = 0.02;

static double largest_sampled_glow(const struct orl_scene *scene)
{
    const double radius = scene->geometry->radius;
    size_t glows = 0;
    for (size_t i = 0; i < scene->n_emissive; i++)
        glows += orl_material_glows(orl_scene_material(scene, scene->emissive[i]));
    return glows <= MOST_AIMED_GLOWS ? most_of_sphere * 4 * ORL_PI * radius * radius : 0;
}

bool orl_is_lamp(const struct orl_geometry *geometry, double largest_sampled_glow,
                 const struct orl_material *material, uint32_t facet)
{
    return orl_material_is_lamp(material) ||
           (material->kind == ORL_MATERIAL_GLOW && orl_material_glows(material) &&
            !orl_facet_is_instanced(geometry, facet) &&
            orl_facet_area(geometry, facet) <= largest_sampled_glow);
}

static void add_emitters(struct orl_lights *lights)
{
    const struct orl_scene *scene = lights->scene;
    lights->largest_sampled_glow = largest_sampled_glow(scene);
    for (size_t i = 0; i < scene->n_emissive; i++) {
        const struct orl_material *m = orl_scene_material(scene, scene->emissive[i]);
        const bool direct =
            orl_is_lamp(scene->geometry, lights->largest_sampled_glow, m, scene->emissive[i]);
        lights->emitters[lights->n_emitters++] =
            (struct orl_emitter){scene->emissive[i], orl_material_mean_radiance(m),
                                 orl_material_max_radiance(m), direct};
    }
}

int orl_lights_check_sky(const struct orl_parsed_scene *parsed_scene, struct orl_error *err)
{
    if (parsed_scene->n_distant_sources == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID,
                  "the job has a sky, but the scene already has the distant source '%.100s'",
                  parsed_scene->distant_sources[0].name);
    orl_error_at(err, NULL, 0, "sky");
    orl_error_hint(err, "leave the sky out of the job, or out of the scene");
    return ORL_ERR_INVALID;
}

int orl_lights_new(struct orl_scene *scene, const struct orl_daylight *sky,
                   struct orl_lights **ret_lights, struct orl_error *err)
{
    const size_t distant_sources = scene->parsed_scene.n_distant_sources;
    const int code = sky ? orl_lights_check_sky(&scene->parsed_scene, err) : 0;
    struct orl_lights *lights = code == 0 ? calloc(1, sizeof *lights) : NULL;
    if (code < 0)
        return code;
    if (!lights)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for lights");
    atomic_init(&lights->holders, 1);
    lights->scene = orl_scene_hold(scene);
    struct orl_arrays *arrays = &lights->arrays;
    lights->suns = orl_arrays_new(arrays, distant_sources + 1, sizeof *lights->suns);
    lights->domes = orl_arrays_new(arrays, distant_sources + OF_A_SKY, sizeof *lights->domes);
    lights->emitters = orl_arrays_new(arrays, scene->n_emissive, sizeof *lights->emitters);
    if (arrays->failed) {
        orl_lights_release(lights);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for lights");
    }
    if (sky)
        add_sky_lights(lights, sky);
    else
        add_scene_lights(lights);
    add_emitters(lights);
    *ret_lights = lights;
    return 0;
}

struct orl_lights *orl_lights_hold(struct orl_lights *lights)
{
    atomic_fetch_add_explicit(&lights->holders, 1, memory_order_relaxed);
    return lights;
}

void orl_lights_release(struct orl_lights *lights)
{
    if (!lights || atomic_fetch_sub_explicit(&lights->holders, 1, memory_order_acq_rel) > 1)
        return;
    orl_scene_release(lights->scene);
    orl_arrays_free(&lights->arrays);
    free(lights);
}

static inline struct orl_vec3 disc_point(const struct orl_sun *sun, const double u[2])
{
    const double down = u[0] * (1 - sun->cos_half_angle), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down));
    const struct orl_sincos circle = orl_sincos_turn(u[1]);
    return orl_to_world(&sun->frame, orl_v3(sine * circle.cosine, sine * circle.sine, cosine));
}

struct orl_vec3 orl_sun_sample(const struct orl_sun *sun, const double u[2])
{
    return disc_point(sun, u);
}

ORL_FOR_WIDE_VECTORS
void orl_sun_sample_many(const struct orl_sun *sun, const double (*u)[2], size_t n,
                         struct orl_vec3 *ret_directions)
{
    for (size_t i = 0; i < n; i++)
        ret_directions[i] = disc_point(sun, u[i]);
}

static void hash_sky(struct orl_sha256 *hash, const struct orl_sky *sky)
{
    const uint64_t head[2] = {sky ? (uint64_t)sky->kind + 1 : 0, sky ? (uint64_t)sky->n_args : 0};
    orl_sha256_add(hash, head, sizeof head);
    if (sky)
        orl_sha256_add(hash, sky->a, head[1] * sizeof *sky->a);
}

void orl_lights_digest(const struct orl_lights *lights, unsigned char ret_digest[32])
{
    const uint64_t counts[2] = {lights->n_suns, lights->n_domes};
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, counts, sizeof counts);
    for (size_t i = 0; i < lights->n_suns; i++) {
        const struct orl_sun *sun = &lights->suns[i];
        const struct orl_vec3 n = sun->frame.n;
        const double numbers[] = {
            n.x, n.y, n.z, sun->cos_half_angle, sun->radiance.r, sun->radiance.g, sun->radiance.b};
        orl_sha256_add(&hash, numbers, sizeof numbers);
    }
    for (size_t i = 0; i < lights->n_domes; i++) {
        const struct orl_dome *dome = &lights->domes[i];
        const struct orl_vec3 d = dome->direction;
        const double numbers[] = {d.x,
                                  d.y,
                                  d.z,
                                  dome->cos_half_angle,
                                  dome->radiance.r,
                                  dome->radiance.g,
                                  dome->radiance.b,
                                  dome->light + 2 * dome->views_only};
        orl_sha256_add(&hash, numbers, sizeof numbers);
        hash_sky(&hash, dome->sky);
        if (dome->pattern)
            orl_sha256_add(&hash, dome->pattern->key, dome->pattern->key_size);
    }
    orl_sha256_finish(&hash, ret_digest);
}
