#include <oriel/run.h>

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "light/scene.h"
#include "light/weather.h"
#include "scene/parse/parse.h"

static int copy_references(const struct orl_scene *scene, struct orl_scene_summary *summary)
{
    const struct orl_description *d = &scene->description;
    const size_t n = d->n_files - d->n_main;
    summary->referenced = calloc(n + 1, sizeof *summary->referenced);
    if (!summary->referenced)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++) {
        summary->referenced[i] = strdup(d->files[d->n_main + i]);
        if (!summary->referenced[i])
            return ORL_ERR_NOMEM;
        summary->n_referenced++;
    }
    return 0;
}

static void summarise(const struct orl_scene *scene, struct orl_scene_summary *summary)
{
    const struct orl_description *d = &scene->description;
    const struct orl_geometry *g = scene->geometry;
    const struct orl_vec3 low = orl_add(g->low, g->center), high = orl_add(g->high, g->center);
    summary->surfaces = d->n_surfaces;
    summary->materials = d->n_materials;
    summary->sources = d->n_distants;
    summary->triangles = g->n_triangles;
    for (size_t i = 0; i < d->n_materials; i++)
        summary->bsdfs += d->materials[i].kind == ORL_MATERIAL_BSDF;
    summary->bounds_min[0] = low.x;
    summary->bounds_min[1] = low.y;
    summary->bounds_min[2] = low.z;
    summary->bounds_max[0] = high.x;
    summary->bounds_max[1] = high.y;
    summary->bounds_max[2] = high.z;
    sodium_bin2hex(summary->digest, sizeof summary->digest, d->digest, sizeof d->digest);
}

static int load_bsdf(void *ctx, const struct orl_bsdf_xml *xml,
                     const unsigned char content[ORL_SHA256_BYTES], struct orl_bsdf **ret_bsdf,
                     struct orl_error *err)
{
    struct orl_bsdf_xml heeding = *xml;
    const struct orl_bsdf_loader *loader = ctx;
    (void)content;
    heeding.cancel = loader->cancel;
    return orl_bsdf_load(&heeding, ret_bsdf, err);
}

int orl_prepare_thread(struct orl_error *err)
{
    return orl_geometry_prepare_thread(err);
}

int orl_scene_check(const char *const *main_files, size_t n_files, const struct orl_files *files,
                    const atomic_bool *cancel, struct orl_scene_summary *ret_summary,
                    struct orl_error *err)
{
    struct orl_bsdf_loader loader = {.load = load_bsdf, .cancel = cancel};
    loader.ctx = &loader;
    struct orl_description description = {0};
    struct orl_scene_summary summary = {0};
    struct orl_scene *scene = NULL;
    int code = orl_scene_parse_with(main_files, n_files, files, &loader, &description, err);
    description.cancel = cancel;
    if (code == 0)
        code = orl_scene_new(&description, &scene, err);
    if (code == 0) {
        summarise(scene, &summary);
        code = copy_references(scene, &summary);
        if (code < 0)
            orl_error_set(err, code, "out of memory");
    }
    orl_scene_release(scene);
    if (code < 0)
        orl_scene_summary_done(&summary);
    else
        *ret_summary = summary;
    return code;
}

int orl_weather_check(const char *name, const char *text, size_t size, struct orl_error *err)
{
    struct orl_weather weather = {0};
    const int code = orl_weather_parse(name, text, size, &weather, err);
    if (code == 0)
        orl_weather_done(&weather);
    return code;
}

void orl_scene_summary_done(struct orl_scene_summary *summary)
{
    if (!summary)
        return;
    for (size_t i = 0; i < summary->n_referenced; i++)
        free(summary->referenced[i]);
    free(summary->referenced);
    memset(summary, 0, sizeof *summary);
}
