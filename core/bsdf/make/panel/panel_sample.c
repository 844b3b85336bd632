/* The measured sample, and its mirror symmetries. */
#include "bsdf/make/panel/panel.h"

#include <math.h>
#include <string.h>

#include "scene/parse/parse.h"
#include "scene/surfaces.h"

/* Refuses light sources, which a BSDF cannot represent. */
static int refuse_lights(const struct orl_scene *scene, struct orl_error *err)
{
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    if (d->n_distant_sources > 0)
        orl_error_set(err, ORL_ERR_INVALID, "source %s: a panel cannot contain a sun or sky",
                      d->distant_sources[0].name);
    else if (scene->n_emissive > 0)
        orl_error_set(err, ORL_ERR_INVALID, "%s emits light: a panel cannot contain lamps",
                      orl_scene_name_of(scene, scene->emissive[0]));
    else
        return 0;
    orl_error_hint(err, "Remove light sources from the panel's files");
    return ORL_ERR_INVALID;
}

/* Refuses a cell that contains no surface: the result would be empty space instead of a panel. */
static int refuse_empty(const struct orl_geometry *g, const double moved[4], struct orl_error *err)
{
    if (moved[0] < g->high.x && moved[1] > g->low.x && moved[2] < g->high.y && moved[3] > g->low.y)
        return 0;
    orl_error_set(
        err, ORL_ERR_INVALID,
        "the cell contains no surface: the panel extends from x %.6g to %.6g, y %.6g to %.6g",
        g->low.x + g->center.x, g->high.x + g->center.x, g->low.y + g->center.y,
        g->high.y + g->center.y);
    orl_error_at(err, NULL, 0, "cell");
    orl_error_hint(err,
                   "Move the cell onto the panel, or omit it to use the box around all surfaces");
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
        code = orl_error_set(err, ORL_ERR_INVALID, "the panel has no surfaces");
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

enum { RAYS = 1 << 15 };
/* Tolerance for rounding: distances relative to the cell's size, and normals. */
static const double same = 1e-5;
/* Least cosine to the normal: distances at more grazing rays are too inaccurate. */
static const double least_cosine = 0.02;

/* Returns true if scattering depends on the normal only. */
static bool scatters_by_normal(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        if (orl_reflector_of(m)->roughness[0] != orl_reflector_of(m)->roughness[1])
            return false;
        break;
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_MIRROR:
        break;
    default:
        return false;
    }
    return !m->pattern && !m->texture && !orl_material_roughness_pattern(m);
}

static struct orl_vec3 image_of(struct orl_vec3 v, unsigned axis)
{
    return axis == 0 ? orl_v3(-v.x, v.y, v.z) : orl_v3(v.x, -v.y, v.z);
}

/* Returns a ray from a random place in the cell, in a random direction. */
static struct orl_path random_ray(const struct orl_gonio_unit_cell *cell, struct orl_random *random)
{
    double u[5];
    for (int i = 0; i < 5; i++)
        u[i] = orl_random_uniform(random);
    const struct orl_vec3 size = orl_sub(cell->high, cell->low);
    const double z = 2 * u[3] - 1, r = sqrt(1 - z * z), phi = 2 * ORL_PI * u[4];
    return orl_path_from(orl_add(cell->low, orl_v3(u[0] * size.x, u[1] * size.y, u[2] * size.z)),
                         orl_v3(r * cos(phi), r * sin(phi), z));
}

static struct orl_path mirrored(const struct orl_gonio_unit_cell *cell, const struct orl_path *path,
                                unsigned axis)
{
    const struct orl_vec3 middle = orl_scale(orl_add(cell->low, cell->high), 0.5);
    return orl_path_from(orl_add(middle, image_of(orl_sub(path->origin, middle), axis)),
                         image_of(path->direction, axis));
}

static bool has_mirrored_hit(const struct orl_gonio_sample *s, struct orl_path path, unsigned axis)
{
    struct orl_path image = mirrored(&s->cell, &path, axis);
    struct orl_hit hits[2];
    const enum orl_gonio_crossing met =
        orl_gonio_unit_cell_intersect(&s->cell, s->lit_scene, &path, &hits[0]);
    if (orl_gonio_unit_cell_intersect(&s->cell, s->lit_scene, &image, &hits[1]) != met)
        return false;
    if (met != ORL_GONIO_HIT_SURFACE)
        return true;
    const struct orl_material *m = orl_lit_scene_material(s->lit_scene, &hits[0]);
    const struct orl_vec3 off = orl_sub(image_of(hits[0].normal, axis), hits[1].normal);
    if (orl_lit_scene_material(s->lit_scene, &hits[1]) != m || !scatters_by_normal(m) ||
        hits[0].front != hits[1].front || orl_length(off) > same)
        return false;
    const double size = orl_length(orl_sub(s->cell.high, s->cell.low));
    const double most = same * (size + hits[0].distance);
    return fabs(orl_dot(path.direction, hits[0].normal)) < least_cosine ||
           fabs(hits[0].distance - hits[1].distance) <= most;
}

static bool has_mirror(const struct orl_gonio_sample *sample, unsigned axis)
{
    struct orl_random random =
        orl_random_stream(axis, ORL_PURPOSE_GONIOMETER, UINT64_MAX); /* independent of the seed */
    for (int i = 0; i < RAYS; i++)
        if (!has_mirrored_hit(sample, random_ray(&sample->cell, &random), axis))
            return false;
    return true;
}

enum orl_bsdf_symmetry orl_gonio_mirrors_of(const struct orl_bsdf_make_request *request,
                                            const struct orl_gonio_sample *sample)
{
    unsigned mirrors = ORL_BSDF_ASYMMETRIC;
    if (request->symmetry != ORL_BSDF_SYMMETRY_AUTO)
        return request->symmetry;
    if (request->basis != ORL_BSDF_TENSOR_TREE_4 || sample->file)
        return ORL_BSDF_ASYMMETRIC;
    for (unsigned axis = 0; axis < 2; axis++)
        if (has_mirror(sample, axis))
            mirrors |= 1U << axis;
    return (enum orl_bsdf_symmetry)mirrors;
}
