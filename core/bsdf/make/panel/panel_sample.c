#include "bsdf/make/panel/panel_sample.h"

#include <string.h>

#include "scene/parse/parse.h"
#include "scene/placements.h"

/* Refuses light sources, which a BSDF cannot represent. */
static int refuse_lights(const struct orl_scene *scene, struct orl_error *err)
{
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    if (d->n_distant_sources > 0)
        orl_error_set(err, ORL_ERR_INVALID, "source %s: a sun or sky is no part of a panel",
                      d->distant_sources[0].name);
    else if (scene->n_emissive > 0)
        orl_error_set(err, ORL_ERR_INVALID, "%s shines: a BSDF has no light of its own",
                      orl_scene_name_of(scene, scene->emissive[0]));
    else
        return 0;
    orl_error_hint(err, "Leave lights out of the panel's files");
    return ORL_ERR_INVALID;
}

/* Refuses a cell that contains no surface: the result would be empty space instead of a panel. */
static int refuse_empty(const struct orl_geometry *g, const double moved[4], struct orl_error *err)
{
    if (moved[0] < g->high.x && moved[1] > g->low.x && moved[2] < g->high.y && moved[3] > g->low.y)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID,
                  "the cell has no surface in it: the panel is from x %.6g to %.6g, y %.6g to %.6g",
                  g->low.x + g->center.x, g->high.x + g->center.x, g->low.y + g->center.y,
                  g->high.y + g->center.y);
    orl_error_at(err, NULL, 0, "cell");
    orl_error_hint(err, "Move the cell onto the panel, or leave it out for the box around all "
                        "surfaces");
    return ORL_ERR_INVALID;
}

static int find_cell(const struct orl_bsdf_make_request *request, struct orl_gonio_sample *sample,
                     struct orl_error *err)
{
    const struct orl_geometry *g = sample->lit_scene->geometry;
    const double box[4] = {g->low.x, g->high.x, g->low.y, g->high.y};
    const double center[4] = {g->center.x, g->center.x, g->center.y, g->center.y};
    double moved[4];
    for (int i = 0; i < 4; i++) {
        moved[i] = request->has_cell ? request->cell[i] - center[i] : box[i];
        sample->sides[i] = request->has_cell ? request->cell[i] : box[i] + center[i];
    }
    sample->depth[0] = g->low.z + g->center.z;
    sample->depth[1] = g->high.z + g->center.z;
    sample->cell = orl_gonio_unit_cell_around(g, moved);
    for (size_t axis = 0; axis < 2; axis++)
        if (!(moved[2 * axis + 1] - moved[2 * axis] > 64 * sample->cell.margin)) {
            orl_error_set(err, ORL_ERR_INVALID, "the panel's cell has no extent in %c", "xy"[axis]);
            orl_error_hint(err, "A panel lies in the xy plane, y up, z towards the inside");
            return ORL_ERR_INVALID;
        }
    return refuse_empty(g, moved, err);
}

int orl_gonio_sample_load(const struct orl_bsdf_make_request *request,
                          const struct orl_bsdf_make_env *env, struct orl_gonio_sample *ret_sample,
                          struct orl_error *err)
{
    struct orl_gonio_sample sample = {0};
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_scene *scene = NULL;
    struct orl_lights *lights = NULL;
    int code = orl_scene_parse((const char *const *)request->files, request->n_files, env->files,
                               &parsed_scene, err);
    if (code < 0)
        return code;
    parsed_scene.cancel = env->cancel;
    code = orl_scene_new(&parsed_scene, &scene, err);
    if (code == 0 && orl_parsed_scene_count_surfaces(&scene->parsed_scene) == 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "there is no surface: no panel");
    if (code == 0)
        code = refuse_lights(scene, err);
    if (code == 0)
        code = orl_lights_new(scene, NULL, &lights, err);
    if (code == 0)
        code = orl_lit_scene_new(lights, env->pool, &sample.lit_scene, err);
    if (code == 0)
        code = find_cell(request, &sample, err);
    orl_lights_release(lights);
    orl_scene_release(scene);
    if (code < 0)
        orl_gonio_sample_done(&sample);
    else
        *ret_sample = sample;
    return code;
}

void orl_gonio_sample_done(struct orl_gonio_sample *sample)
{
    orl_lit_scene_free(sample->lit_scene);
    memset(sample, 0, sizeof *sample);
}
