#include "light/world.h"

#include <stdlib.h>
#include <string.h>

#include "light/sky.h"

static void *copy_of(const void *from, size_t count, size_t size)
{
    void *copy = malloc((count + 1) * size);
    if (copy && count > 0)
        memcpy(copy, from, count * size);
    return copy;
}

/* Returns false if out of memory. */
static bool copy_parts(struct orl_world *world)
{
    const struct orl_scene *scene = world->scene;
    const struct orl_lights *lights = world->lights;
    const struct orl_description *d = &scene->description;
    world->materials = copy_of(d->materials, d->n_materials, sizeof *world->materials);
    world->suns = copy_of(lights->suns, lights->n_suns, sizeof *world->suns);
    world->domes = copy_of(lights->domes, lights->n_domes, sizeof *world->domes);
    world->emitters = copy_of(lights->emitters, lights->n_emitters, sizeof *world->emitters);
    world->ports = copy_of(scene->ports, scene->n_ports, sizeof *world->ports);
    world->n_materials = d->n_materials;
    world->n_suns = lights->n_suns;
    world->n_domes = lights->n_domes;
    world->n_emitters = lights->n_emitters;
    world->most_aimed_glow = lights->most_aimed_glow;
    world->n_ports = scene->n_ports;
    if (scene->seen)
        world->seen = calloc(1, sizeof *world->seen);
    return world->materials && world->suns && world->domes && world->emitters && world->ports &&
           (world->seen || !scene->seen);
}

int orl_world_new(struct orl_lights *lights, const struct orl_crew *crew,
                  struct orl_world **ret_world, struct orl_error *err)
{
    struct orl_world *world = calloc(1, sizeof *world);
    int code = ORL_ERR_NOMEM;
    if (!world)
        goto done;
    world->lights = orl_lights_hold(lights);
    world->scene = orl_scene_hold(lights->scene);
    world->geometry = world->scene->geometry;
    world->proxies = world->scene->proxies;
    world->hidden = world->scene->hidden;
    world->port_of_facet = world->scene->port_of_facet;
    world->open = world->scene->open;
    world->omit = (struct orl_omissions){.most_reflections = ORL_ALL_REFLECTIONS, .channels = 3};
    if (!copy_parts(world))
        goto done;
    code = world->port_of_facet ? orl_images_build(&world->images, world, crew) : 0;
    if (code == 0 && world->port_of_facet)
        code = orl_lamp_images_build(&world->lamp_images, world, crew);
    orl_world_settle(world);
done:
    if (code < 0) {
        orl_world_free(world);
        return orl_error_set(err, code, "%s",
                             code == ORL_ERR_CANCELLED ? "cancelled while preparing the lights"
                                                       : "out of memory for the scene");
    }
    *ret_world = world;
    return 0;
}

void orl_world_free(struct orl_world *world)
{
    if (!world)
        return;
    orl_images_done(&world->images);
    orl_lamp_images_done(&world->lamp_images);
    orl_lights_release(world->lights);
    orl_scene_release(world->scene);
    free(world->materials);
    free(world->suns);
    free(world->domes);
    free(world->emitters);
    free(world->ports);
    free(world->seen);
    free(world);
}

void orl_world_settle(struct orl_world *world)
{
    struct orl_world *const seen = world->seen;
    if (!seen)
        return;
    *seen = *world;
    seen->geometry = world->scene->seen;
    seen->seen = NULL;
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

static struct orl_rgb radiance_of_domes(const struct orl_world *world, struct orl_vec3 direction,
                                        bool seen)
{
    struct orl_rgb sum = orl_gray(0);
    const struct orl_dome *glow = NULL;
    bool lit = false;
    for (size_t i = 0; i < world->n_domes; i++) {
        const struct orl_dome *dome = &world->domes[i];
        if (orl_dot(direction, dome->direction) < dome->cos_half_angle)
            continue;
        if (dome->light) {
            sum = orl_rgb_add(sum, orl_dome_radiance(dome, direction));
            lit = true;
        } else if (!glow) {
            glow = dome;
        }
    }
    if (!glow || lit || (glow->seen_alone && !seen))
        return sum;
    return orl_dome_radiance(glow, direction);
}

struct orl_rgb orl_world_dome_radiance(const struct orl_world *world, struct orl_vec3 direction)
{
    return radiance_of_domes(world, direction, false);
}

struct orl_rgb orl_world_dome_seen(const struct orl_world *world, struct orl_vec3 direction)
{
    return radiance_of_domes(world, direction, true);
}

struct orl_rgb orl_world_sun_radiance(const struct orl_world *world, struct orl_vec3 direction)
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < world->n_suns; i++)
        if (orl_dot(direction, world->suns[i].frame.n) >= world->suns[i].cos_half_angle)
            sum = orl_rgb_add(sum, world->suns[i].radiance);
    return sum;
}
