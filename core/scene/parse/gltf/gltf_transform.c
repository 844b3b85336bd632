#include "scene/parse/gltf/gltf_file.h"

#include <math.h>
#include <stdint.h>

const struct orl_gltf_transform orl_gltf_z_up = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};

struct orl_gltf_transform orl_gltf_transform_compose(const struct orl_gltf_transform *outer,
                                                     const struct orl_gltf_transform *inner)
{
    struct orl_gltf_transform combined;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            combined.row[i][j] = j == 3 ? outer->row[i][3] : 0;
            for (int k = 0; k < 3; k++)
                combined.row[i][j] += outer->row[i][k] * inner->row[k][j];
        }
    return combined;
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* Column-major; the last row must be 0 0 0 1. */
static struct orl_gltf_transform read_matrix(const struct orl_gltf_item *node, const double m[16])
{
    struct orl_gltf_transform transform;
    if (fabs(m[3]) + fabs(m[7]) + fabs(m[11]) + fabs(m[15] - 1) > 1e-5)
        orl_gltf_fail(node, ORL_ERR_UNSUPPORTED, "the last row of its 'matrix' is not 0 0 0 1");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            transform.row[i][j] = m[4 * j + i];
    return transform;
}

/* Composes scale, rotation (a quaternion x y z w of length 1 except for rounding to bytes) and
 * translation. */
static struct orl_gltf_transform compose(const struct orl_gltf_item *at, const double scale[],
                                         const double rotation[], const double translation[])
{
    struct orl_gltf_transform transform;
    double length = 0;
    for (int k = 0; k < 4; k++)
        length += rotation[k] * rotation[k];
    length = sqrt(length);
    if (!(fabs(length - 1) < 0.05))
        orl_gltf_fail(at, ORL_ERR_RANGE, "its rotation quaternion has length %.3g instead of 1",
                      length);
    const double x = rotation[0] / length, y = rotation[1] / length, z = rotation[2] / length,
                 w = rotation[3] / length;
    const double turned[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            transform.row[i][j] = turned[i][j] * scale[j];
        transform.row[i][3] = translation[i];
    }
    return transform;
}

struct orl_gltf_transform orl_gltf_transform_read(const struct orl_gltf_item *node)
{
    double m[16] = {0}, scale[3] = {1, 1, 1}, rotation[4] = {0, 0, 0, 1}, translation[3] = {0};
    const bool whole = orl_gltf_numbers(node, "matrix", 16, m);
    const bool scaled = orl_gltf_numbers(node, "scale", 3, scale);
    const bool rotated = orl_gltf_numbers(node, "rotation", 4, rotation);
    const bool moved = orl_gltf_numbers(node, "translation", 3, translation);
    if (whole && (scaled || rotated || moved))
        orl_gltf_fail(node, ORL_ERR_SYNTAX,
                      "it has both a 'matrix' and a 'scale', 'rotation' or 'translation'");
    return whole ? read_matrix(node, m) : compose(node, scale, rotation, translation);
}

/* ---- Copies ---------------------------------------------------------------------------------- */

void orl_gltf_instances_open(const struct orl_gltf_item *node,
                             struct orl_gltf_instances *ret_instances)
{
    static const char *const names[] = {"SCALE", "ROTATION", "TRANSLATION"};
    static const char *const types[] = {"VEC3", "VEC4", "VEC3"};
    struct orl_gltf_instances *const instances = ret_instances;
    const struct orl_gltf_item extensions = orl_gltf_member(node, "extensions");
    const struct orl_gltf_item own = orl_gltf_member(&extensions, "EXT_mesh_gpu_instancing");
    const struct orl_gltf_item attributes = orl_gltf_member(&own, "attributes");
    *instances = (struct orl_gltf_instances){.count = own.object ? 0 : 1};
    for (int k = 0; k < 3; k++) {
        struct orl_gltf_accessor *const part = &instances->parts[k];
        instances->given[k] = json_object_get(attributes.object, names[k]) != NULL;
        if (!instances->given[k])
            continue;
        *part = orl_gltf_accessor_open(&attributes,
                                       orl_gltf_integer(&attributes, names[k], SIZE_MAX), types[k]);
        if (instances->count > 0 && instances->count != part->count)
            orl_gltf_fail(&attributes, ORL_ERR_SYNTAX, "its accessors have different counts");
        instances->count = part->count;
    }
    if (instances->count == 0)
        orl_gltf_fail(&own, ORL_ERR_SYNTAX, "it does not give the position of any copy");
}

struct orl_gltf_transform orl_gltf_instance_transform(const struct orl_gltf_instances *instances,
                                                      size_t i)
{
    double values[3][4] = {{1, 1, 1}, {0, 0, 0, 1}, {0}};
    for (int k = 0; k < 3; k++)
        if (instances->given[k])
            orl_gltf_accessor_value(&instances->parts[k], i, values[k]);
    return compose(&instances->parts[1].item, values[0], values[1], values[2]);
}

/* ---- Placing --------------------------------------------------------------------------------- */

static struct orl_vec3 row_of(const struct orl_gltf_transform *p, int i)
{
    return orl_v3(p->row[i][0], p->row[i][1], p->row[i][2]);
}

struct orl_vec3 orl_gltf_transform_point(const struct orl_gltf_transform *transform,
                                         struct orl_vec3 at)
{
    return orl_v3(orl_dot(row_of(transform, 0), at) + transform->row[0][3],
                  orl_dot(row_of(transform, 1), at) + transform->row[1][3],
                  orl_dot(row_of(transform, 2), at) + transform->row[2][3]);
}

bool orl_gltf_transform_mirrors(const struct orl_gltf_transform *transform)
{
    return orl_dot(orl_cross(row_of(transform, 0), row_of(transform, 1)), row_of(transform, 2)) < 0;
}

struct orl_vec3 orl_gltf_transform_normal(const struct orl_gltf_transform *transform,
                                          struct orl_vec3 n)
{
    const struct orl_vec3 a = row_of(transform, 0), b = row_of(transform, 1),
                          c = row_of(transform, 2);
    const struct orl_vec3 combined = orl_v3(
        orl_dot(orl_cross(b, c), n), orl_dot(orl_cross(c, a), n), orl_dot(orl_cross(a, b), n));
    return orl_gltf_transform_mirrors(transform) ? orl_neg(combined) : combined;
}
