#include "bsdf/make/panel/panel_mirrors.h"

#include <math.h>

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
        if (m->roughness[0] != m->roughness[1])
            return false;
        break;
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_MIRROR:
        break;
    default:
        return false;
    }
    return !m->pattern && !m->texture && !m->roughness_pattern;
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
