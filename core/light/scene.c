#include "light/scene.h"

#include <stdlib.h>
#include <string.h>

#include "light/proxies.h"
#include "scene/coincident.h"

/* Of a triangle and a facet, with their share of the hierarchy: as measured on large scenes. */
enum { BYTES_A_TRIANGLE = 240, BYTES_A_FACET = 320 };

static int list_shining(struct orl_scene *scene)
{
    const struct orl_geometry *g = scene->geometry;
    scene->shining = malloc((g->n_facets + 1) * sizeof *scene->shining);
    if (!scene->shining)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->n_facets; i++) {
        const struct orl_material *m = orl_scene_material(scene, i);
        const bool shines = orl_material_is_lamp(m) || orl_material_glows(m);
        if (shines && g->facets[i].area > 0 && orl_luma(m->color) > 0)
            scene->shining[scene->n_shining++] = (uint32_t)i;
    }
    return 0;
}

int orl_scene_new(struct orl_description *description, struct orl_scene **ret_scene,
                  struct orl_error *err)
{
    struct orl_scene *scene = calloc(1, sizeof *scene);
    int code = ORL_ERR_NOMEM;
    if (!scene) {
        orl_description_done(description);
        goto done;
    }
    atomic_init(&scene->holders, 1);
    scene->description = *description;
    memset(description, 0, sizeof *description);
    scene->n_read = scene->description.n_surfaces + scene->description.n_degenerate;
    code = orl_coincident_settle(&scene->description, err);
    if (code == 0)
        code = orl_geometry_new(&scene->description, &scene->geometry, err);
    if (code == 0)
        code = orl_proxies_part(scene, err);
    if (code == 0)
        code = list_shining(scene);
    scene->description.cancel = NULL;
done:
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    if (code == 0)
        *ret_scene = scene;
    else
        orl_scene_release(scene);
    return code;
}

struct orl_scene *orl_scene_hold(struct orl_scene *scene)
{
    atomic_fetch_add_explicit(&scene->holders, 1, memory_order_relaxed);
    return scene;
}

void orl_scene_release(struct orl_scene *scene)
{
    if (!scene || atomic_fetch_sub_explicit(&scene->holders, 1, memory_order_acq_rel) > 1)
        return;
    orl_geometry_free(scene->geometry);
    orl_geometry_free(scene->seen);
    orl_geometry_free(scene->proxies);
    orl_description_done(&scene->description);
    free(scene->hidden);
    free(scene->shining);
    free(scene->ports);
    free(scene->port_of_facet);
    free(scene);
}

uint64_t orl_scene_bytes(const struct orl_scene *scene)
{
    const struct orl_geometry *const parts[] = {scene->geometry, scene->seen, scene->proxies};
    uint64_t bytes = sizeof *scene + scene->description.n_materials * sizeof(struct orl_material);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (parts[i])
            bytes += parts[i]->n_triangles * (uint64_t)BYTES_A_TRIANGLE +
                     parts[i]->n_facets * (uint64_t)BYTES_A_FACET;
    return bytes + scene->description.n_surfaces * sizeof(struct orl_surface);
}

const char *orl_scene_name_of(const struct orl_scene *scene, uint32_t facet)
{
    return scene->description.surfaces[scene->geometry->facets[facet].surface].name;
}
