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
static int read_matrix(const struct orl_gltf_item *node, const double m[16],
                       struct orl_gltf_transform *ret_transform, struct orl_error *err)
{
    if (fabs(m[3]) + fabs(m[7]) + fabs(m[11]) + fabs(m[15] - 1) > 1e-5)
        return orl_gltf_fail(node, ORL_ERR_UNSUPPORTED, err,
                             "the last row of its 'matrix' is not 0 0 0 1");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            ret_transform->row[i][j] = m[4 * j + i];
    return 0;
}

/* Composes scale, rotation (a quaternion x y z w of length 1 except for rounding to bytes) and
 * translation. */
static int compose(const struct orl_gltf_item *at, const double scale[3], const double rotation[4],
                   const double translation[3], struct orl_gltf_transform *ret_transform,
                   struct orl_error *err)
{
    double length = 0;
    for (int k = 0; k < 4; k++)
        length += rotation[k] * rotation[k];
    length = sqrt(length);
    if (!(fabs(length - 1) < 0.05))
        return orl_gltf_fail(at, ORL_ERR_RANGE, err,
                             "its rotation quaternion has length %.3g instead of 1", length);
    const double x = rotation[0] / length, y = rotation[1] / length, z = rotation[2] / length,
                 w = rotation[3] / length;
    const double turned[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            ret_transform->row[i][j] = turned[i][j] * scale[j];
        ret_transform->row[i][3] = translation[i];
    }
    return 0;
}

int orl_gltf_transform_read(const struct orl_gltf_item *node,
                            struct orl_gltf_transform *ret_transform, struct orl_error *err)
{
    double matrix[16], scale[3] = {1, 1, 1}, rotation[4] = {0, 0, 0, 1}, translation[3] = {0, 0, 0};
    bool whole, scaled, rotated, moved;
    int code = orl_gltf_numbers(node, "matrix", 16, matrix, &whole, err);
    if (code == 0)
        code = orl_gltf_numbers(node, "scale", 3, scale, &scaled, err);
    if (code == 0)
        code = orl_gltf_numbers(node, "rotation", 4, rotation, &rotated, err);
    if (code == 0)
        code = orl_gltf_numbers(node, "translation", 3, translation, &moved, err);
    if (code)
        return code;
    if (whole && (scaled || rotated || moved))
        return orl_gltf_fail(node, ORL_ERR_SYNTAX, err,
                             "it has both a 'matrix' and a 'scale', 'rotation' or 'translation'");
    return whole ? read_matrix(node, matrix, ret_transform, err)
                 : compose(node, scale, rotation, translation, ret_transform, err);
}

/* ---- Copies ---------------------------------------------------------------------------------- */

/* Opens an attribute of the extension, whose count must equal that of the others. */
static int open_attribute(struct orl_gltf_file *file, const struct orl_gltf_item *attributes,
                          const char *name, const char *type, struct orl_gltf_accessor *ret,
                          size_t *count, bool *ret_given, struct orl_error *err)
{
    size_t index = SIZE_MAX;
    *ret_given = json_object_get(attributes->object, name) != NULL;
    int code = *ret_given ? orl_gltf_integer(attributes, name, &index, err) : 0;
    if (code == 0 && *ret_given)
        code = orl_gltf_accessor_open(file, attributes, index, type, ret, err);
    if (code || !*ret_given)
        return code;
    if (*count > 0 && *count != ret->count)
        return orl_gltf_fail(attributes, ORL_ERR_SYNTAX, err,
                             "its accessors have different counts");
    *count = ret->count;
    return 0;
}

int orl_gltf_instances_open(struct orl_gltf_file *file, const struct orl_gltf_item *node,
                            struct orl_gltf_instances *ret_instances, struct orl_error *err)
{
    struct orl_gltf_instances *const instances = ret_instances;
    struct orl_gltf_item extensions, own, attributes;
    *instances = (struct orl_gltf_instances){.count = 0};
    int code = orl_gltf_member(node, "extensions", &extensions, err);
    if (code == 0)
        code = orl_gltf_member(&extensions, "EXT_mesh_gpu_instancing", &own, err);
    if (code == 0 && !own.object)
        instances->count = 1;
    if (code || !own.object)
        return code;
    code = orl_gltf_member(&own, "attributes", &attributes, err);
    if (code == 0)
        code = open_attribute(file, &attributes, "SCALE", "VEC3", &instances->scale,
                              &instances->count, &instances->given[0], err);
    if (code == 0)
        code = open_attribute(file, &attributes, "ROTATION", "VEC4", &instances->rotation,
                              &instances->count, &instances->given[1], err);
    if (code == 0)
        code = open_attribute(file, &attributes, "TRANSLATION", "VEC3", &instances->translation,
                              &instances->count, &instances->given[2], err);
    return code == 0 && instances->count == 0
               ? orl_gltf_fail(&own, ORL_ERR_SYNTAX, err,
                               "it does not give the position of any copy")
               : code;
}

int orl_gltf_instance_transform(const struct orl_gltf_instances *instances, size_t i,
                                struct orl_gltf_transform *ret_transform, struct orl_error *err)
{
    double scale[4] = {1, 1, 1}, rotation[4] = {0, 0, 0, 1}, translation[4] = {0, 0, 0};
    int code = 0;
    if (instances->given[0])
        code = orl_gltf_accessor_value(&instances->scale, i, scale, err);
    if (code == 0 && instances->given[1])
        code = orl_gltf_accessor_value(&instances->rotation, i, rotation, err);
    if (code == 0 && instances->given[2])
        code = orl_gltf_accessor_value(&instances->translation, i, translation, err);
    return code ? code
                : compose(&instances->rotation.item, scale, rotation, translation, ret_transform,
                          err);
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
