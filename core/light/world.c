#include "light/world.h"

#include <stdlib.h>
#include <string.h>

#include "base/circle.h"
#include "light/proxies.h"
#include "light/sky.h"
#include "scene/coincident.h"

/* Distant lights up to this full angle are sampled as discs; wider ones are domes. */
static const double widest_sun_deg = 10.0;

static void add_distant(struct orl_world *world, const struct orl_distant *distant)
{
    const struct orl_material *material = &world->description.materials[distant->material];
    const double half = 0.5 * distant->angle_deg * ORL_DEG_TO_RAD;
    const struct orl_sky *sky =
        material->sky >= 0 ? &world->description.skies[material->sky] : NULL;
    if (material->kind == ORL_MATERIAL_LIGHT && distant->angle_deg <= widest_sun_deg) {
        struct orl_sun *sun = &world->suns[world->n_suns++];
        /* 1 - cos without cancellation: the disc is half a degree across. */
        const double solid = 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
        const double pattern = sky ? orl_sky_brightness(sky, distant->direction) : 1.0;
        *sun = (struct orl_sun){.frame = orl_frame_about(distant->direction),
                                .cos_half_angle = cos(half),
                                .solid_angle_sr = solid,
                                .radiance = orl_rgb_scale(material->color, pattern)};
        sun->irradiance = orl_rgb_scale(sun->radiance, solid);
        if (!(orl_luma(sun->radiance) > 0))
            world->n_suns--;
        return;
    }
    world->domes[world->n_domes++] =
        (struct orl_dome){distant->direction, cos(half), material->color, sky};
}

static void add_emitters(struct orl_world *world)
{
    const struct orl_geometry *g = world->geometry;
    for (size_t i = 0; i < g->n_facets; i++) {
        const struct orl_material *m = &world->description.materials[g->facets[i].material];
        const bool shines = orl_material_is_lamp(m) || orl_material_glows(m);
        if (shines && g->facets[i].area > 0 && orl_luma(m->color) > 0)
            world->emitters[world->n_emitters++] =
                (struct orl_emitter){(uint32_t)i, m->color, orl_material_is_lamp(m)};
    }
}

static size_t count_emitters(const struct orl_world *world)
{
    size_t n = 0;
    for (size_t i = 0; i < world->geometry->n_facets; i++) {
        const uint32_t material = world->geometry->facets[i].material;
        n += orl_material_shines(&world->description.materials[material]);
    }
    return n;
}

int orl_world_new(struct orl_description *description, struct orl_world **ret_world,
                  struct orl_error *err)
{
    struct orl_world *world = calloc(1, sizeof *world);
    int code = ORL_ERR_NOMEM;
    if (!world) {
        orl_description_done(description);
        goto done;
    }
    world->omit = (struct orl_omissions){.most_reflections = ORL_ALL_REFLECTIONS, .channels = 3};
    world->description = *description;
    memset(description, 0, sizeof *description);
    code = orl_coincident_settle(&world->description, err);
    if (code == 0)
        code = orl_geometry_new(&world->description, &world->geometry, err);
    if (code == 0)
        code = orl_proxies_part(world, err);
    if (code < 0)
        goto done;
    const size_t distants = world->description.n_distants + 1;
    world->suns = calloc(distants, sizeof *world->suns);
    world->domes = calloc(distants, sizeof *world->domes);
    world->emitters = calloc(count_emitters(world) + 1, sizeof *world->emitters);
    if (!world->suns || !world->domes || !world->emitters) {
        code = ORL_ERR_NOMEM;
        goto done;
    }
    for (size_t i = 0; i < world->description.n_distants; i++)
        add_distant(world, &world->description.distants[i]);
    add_emitters(world);
done:
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    if (code == 0)
        *ret_world = world;
    else
        orl_world_free(world);
    return code;
}

void orl_world_free(struct orl_world *world)
{
    if (!world)
        return;
    orl_proxies_done(world);
    orl_geometry_free(world->geometry);
    orl_description_done(&world->description);
    free(world->suns);
    free(world->domes);
    free(world->emitters);
    orl_images_done(&world->images);
    free(world->ports);
    free(world->port_of_facet);
    free(world);
}

void orl_world_keep_suns(struct orl_world *world, const bool *keep)
{
    size_t kept = 0;
    orl_images_keep_suns(&world->images, keep);
    for (size_t i = 0; i < world->n_suns; i++)
        if (keep && keep[i])
            world->suns[kept++] = world->suns[i];
    world->n_suns = kept;
}

struct orl_rgb orl_world_dome_radiance(const struct orl_world *world, struct orl_vec3 direction)
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->n_domes; i++) {
        const struct orl_dome *dome = &world->domes[i];
        if (orl_dot(direction, dome->direction) < dome->cos_half_angle)
            continue;
        const double pattern = dome->sky ? orl_sky_brightness(dome->sky, direction) : 1.0;
        sum = orl_rgb_add(sum, orl_rgb_scale(dome->radiance, pattern));
    }
    return sum;
}

struct orl_rgb orl_world_sun_radiance(const struct orl_world *world, struct orl_vec3 direction)
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->n_suns; i++)
        if (orl_dot(direction, world->suns[i].frame.n) >= world->suns[i].cos_half_angle)
            sum = orl_rgb_add(sum, world->suns[i].radiance);
    return sum;
}

struct orl_vec3 orl_sun_sample(const struct orl_sun *sun, const double u[2])
{
    const double down = u[0] * (1 - sun->cos_half_angle), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down));
    const struct orl_circle circle = orl_circle_turn(u[1]);
    return orl_to_world(&sun->frame, orl_v3(sine * circle.cosine, sine * circle.sine, cosine));
}

enum orl_crossing orl_world_crossing(const struct orl_world *world, const struct orl_hit *hit)
{
    const int32_t port = world->port_of_facet ? world->port_of_facet[hit->facet] : ORL_NO_PORT;
    if (port == ORL_NO_PORT)
        return ORL_CROSSING_NONE;
    return hit->front == world->ports[port].outside_is_front ? ORL_CROSSING_INWARDS
                                                             : ORL_CROSSING_OUTWARDS;
}

bool orl_world_leaves_clear(const struct orl_world *world, const struct orl_hit *hit)
{
    const int32_t port = world->port_of_facet ? world->port_of_facet[hit->facet] : ORL_NO_PORT;
    return port != ORL_NO_PORT && world->ports[port].clear &&
           hit->front != world->ports[port].outside_is_front;
}
