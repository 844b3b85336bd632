#include "light/lit_scene.h"

#include <stdlib.h>
#include <string.h>

#include "light/daylight/daylight.h"

static void *copy_of(struct orl_lit_scene *lit_scene, const void *from, size_t count, size_t size)
{
    void *copy = orl_arrays_new(&lit_scene->arrays, count, size);
    if (copy && count > 0)
        memcpy(copy, from, count * size);
    return copy;
}

/* Returns false if out of memory. */
static bool copy_parts(struct orl_lit_scene *lit_scene)
{
    const struct orl_scene *scene = lit_scene->scene;
    const struct orl_lights *lights = lit_scene->lights;
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    lit_scene->materials =
        copy_of(lit_scene, d->materials, d->n_materials, sizeof *lit_scene->materials);
    lit_scene->suns = copy_of(lit_scene, lights->suns, lights->n_suns, sizeof *lit_scene->suns);
    lit_scene->domes = copy_of(lit_scene, lights->domes, lights->n_domes, sizeof *lit_scene->domes);
    lit_scene->emitters =
        copy_of(lit_scene, lights->emitters, lights->n_emitters, sizeof *lit_scene->emitters);
    lit_scene->ports = copy_of(lit_scene, scene->ports, scene->n_ports, sizeof *lit_scene->ports);
    lit_scene->n_materials = d->n_materials;
    lit_scene->n_suns = lights->n_suns;
    lit_scene->n_domes = lights->n_domes;
    lit_scene->n_emitters = lights->n_emitters;
    lit_scene->largest_sampled_glow = lights->largest_sampled_glow;
    lit_scene->n_ports = scene->n_ports;
    if (scene->seen)
        lit_scene->seen = orl_arrays_new(&lit_scene->arrays, 1, sizeof *lit_scene->seen);
    return !lit_scene->arrays.failed;
}

int orl_lit_scene_new(struct orl_lights *lights, const struct orl_thread_pool *pool,
                      struct orl_lit_scene **ret_lit_scene, struct orl_error *err)
{
    struct orl_lit_scene *lit_scene = calloc(1, sizeof *lit_scene);
    int code = ORL_ERR_NOMEM;
    if (!lit_scene)
        goto done;
    lit_scene->lights = orl_lights_hold(lights);
    lit_scene->scene = orl_scene_hold(lights->scene);
    lit_scene->geometry = lit_scene->scene->geometry;
    lit_scene->proxies = lit_scene->scene->proxies;
    lit_scene->hidden = lit_scene->scene->hidden;
    lit_scene->port_of_facet = lit_scene->scene->port_of_facet;
    lit_scene->open = lit_scene->scene->open;
    lit_scene->omit =
        (struct orl_omissions){.most_reflections = ORL_ALL_REFLECTIONS, .channels = 3};
    if (!copy_parts(lit_scene))
        goto done;
    code =
        lit_scene->port_of_facet ? orl_virtual_suns_build(&lit_scene->images, lit_scene, pool) : 0;
    if (code == 0 && lit_scene->port_of_facet)
        code = orl_virtual_lamps_build(&lit_scene->virtual_lamps, lit_scene, pool);
    orl_lit_scene_update_seen(lit_scene);
done:
    if (code < 0) {
        orl_lit_scene_free(lit_scene);
        return orl_error_set(err, code, "%s",
                             code == ORL_ERR_CANCELLED ? "cancelled while preparing the lights"
                                                       : "out of memory for the scene");
    }
    *ret_lit_scene = lit_scene;
    return 0;
}

void orl_lit_scene_free(struct orl_lit_scene *lit_scene)
{
    if (!lit_scene)
        return;
    orl_virtual_suns_done(&lit_scene->images);
    orl_virtual_lamps_done(&lit_scene->virtual_lamps);
    orl_lights_release(lit_scene->lights);
    orl_scene_release(lit_scene->scene);
    orl_arrays_free(&lit_scene->arrays);
    free(lit_scene);
}

void orl_lit_scene_update_seen(struct orl_lit_scene *lit_scene)
{
    struct orl_lit_scene *const seen = lit_scene->seen;
    if (!seen)
        return;
    *seen = *lit_scene;
    seen->geometry = lit_scene->scene->seen;
    seen->seen = NULL;
}

void orl_lit_scene_select_suns(struct orl_lit_scene *lit_scene, const bool *keep)
{
    size_t kept = 0;
    orl_virtual_suns_keep(&lit_scene->images, keep);
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        if (keep && keep[i])
            lit_scene->suns[kept++] = lit_scene->suns[i];
    lit_scene->n_suns = kept;
}

static struct orl_rgb radiance_of_domes(const struct orl_lit_scene *lit_scene,
                                        struct orl_vec3 direction, bool seen)
{
    struct orl_rgb sum = orl_gray(0);
    const struct orl_dome *glow = NULL;
    bool lit = false;
    for (size_t i = 0; i < lit_scene->n_domes; i++) {
        const struct orl_dome *dome = &lit_scene->domes[i];
        if (orl_dot(direction, dome->direction) < dome->cos_half_angle)
            continue;
        if (dome->light) {
            sum = orl_rgb_add(sum, orl_dome_radiance(dome, direction));
            lit = true;
        } else if (!glow) {
            glow = dome;
        }
    }
    if (!glow || lit || (glow->views_only && !seen))
        return sum;
    return orl_dome_radiance(glow, direction);
}

struct orl_rgb orl_lit_scene_dome_radiance(const struct orl_lit_scene *lit_scene,
                                           struct orl_vec3 direction)
{
    return radiance_of_domes(lit_scene, direction, false);
}

struct orl_rgb orl_lit_scene_dome_seen(const struct orl_lit_scene *lit_scene,
                                       struct orl_vec3 direction)
{
    return radiance_of_domes(lit_scene, direction, true);
}

struct orl_rgb orl_lit_scene_sun_radiance(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 direction)
{
    struct orl_rgb sum = orl_gray(0);
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        if (orl_dot(direction, lit_scene->suns[i].frame.n) >= lit_scene->suns[i].cos_half_angle)
            sum = orl_rgb_add(sum, lit_scene->suns[i].radiance);
    return sum;
}
