#include "scene/parse/gltf_place.h"

#include <math.h>
#include <stdint.h>

const struct orl_gltf_place orl_gltf_upright = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};

struct orl_gltf_place orl_gltf_place_within(const struct orl_gltf_place *outer,
                                            const struct orl_gltf_place *inner)
{
    struct orl_gltf_place placed;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            placed.row[i][j] = j == 3 ? outer->row[i][3] : 0;
            for (int k = 0; k < 3; k++)
                placed.row[i][j] += outer->row[i][k] * inner->row[k][j];
        }
    return placed;
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* Column-major; the last row must be 0 0 0 1. */
static int read_matrix(const struct orl_gltf_item *node, const double m[16],
                       struct orl_gltf_place *ret_place, struct orl_error *err)
{
    if (fabs(m[3]) + fabs(m[7]) + fabs(m[11]) + fabs(m[15] - 1) > 1e-5)
        return orl_gltf_fail(node, ORL_ERR_UNSUPPORTED, err,
                             "its 'matrix' has another last row than 0 0 0 1");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            ret_place->row[i][j] = m[4 * j + i];
    return 0;
}

/* Composes scale, rotation (a quaternion x y z w of length 1 except for rounding to bytes) and
 * translation. */
static int compose(const struct orl_gltf_item *at, const double scale[3], const double rotation[4],
                   const double translation[3], struct orl_gltf_place *ret_place,
                   struct orl_error *err)
{
    double length = 0;
    for (int k = 0; k < 4; k++)
        length += rotation[k] * rotation[k];
    length = sqrt(length);
    if (!(fabs(length - 1) < 0.05))
        return orl_gltf_fail(at, ORL_ERR_RANGE, err, "its rotation is a quaternion of length %.3g",
                             length);
    const double x = rotation[0] / length, y = rotation[1] / length, z = rotation[2] / length,
                 w = rotation[3] / length;
    const double turned[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            ret_place->row[i][j] = turned[i][j] * scale[j];
        ret_place->row[i][3] = translation[i];
    }
    return 0;
}

int orl_gltf_place_read(const struct orl_gltf_item *node, struct orl_gltf_place *ret_place,
                        struct orl_error *err)
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
                             "it has a 'matrix', and a 'scale', 'rotation' or 'translation'");
    return whole ? read_matrix(node, matrix, ret_place, err)
                 : compose(node, scale, rotation, translation, ret_place, err);
}

/* ---- Copies ---------------------------------------------------------------------------------- */

/* Opens an attribute of the extension, whose count must equal that of the others. */
static int open_attribute(struct orl_gltf_file *file, const struct orl_gltf_item *attributes,
                          const char *name, const char *type, struct orl_gltf_accessor *ret,
                          size_t *count, bool *ret_given, struct orl_error *err)
{
    size_t index = SIZE_MAX;
    *ret_given = json_object_get(attributes->object, name) != NULL;
    int code = *ret_given ? orl_gltf_whole(attributes, name, &index, err) : 0;
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

int orl_gltf_copies_open(struct orl_gltf_file *file, const struct orl_gltf_item *node,
                         struct orl_gltf_copies *ret_copies, struct orl_error *err)
{
    struct orl_gltf_copies *const copies = ret_copies;
    struct orl_gltf_item extensions, own, attributes;
    *copies = (struct orl_gltf_copies){.count = 0};
    int code = orl_gltf_inner(node, "extensions", &extensions, err);
    if (code == 0)
        code = orl_gltf_inner(&extensions, "EXT_mesh_gpu_instancing", &own, err);
    if (code == 0 && !own.object)
        copies->count = 1;
    if (code || !own.object)
        return code;
    code = orl_gltf_inner(&own, "attributes", &attributes, err);
    if (code == 0)
        code = open_attribute(file, &attributes, "SCALE", "VEC3", &copies->scale, &copies->count,
                              &copies->given[0], err);
    if (code == 0)
        code = open_attribute(file, &attributes, "ROTATION", "VEC4", &copies->rotation,
                              &copies->count, &copies->given[1], err);
    if (code == 0)
        code = open_attribute(file, &attributes, "TRANSLATION", "VEC3", &copies->translation,
                              &copies->count, &copies->given[2], err);
    return code == 0 && copies->count == 0
               ? orl_gltf_fail(&own, ORL_ERR_SYNTAX, err, "it says of no copy where it is")
               : code;
}

int orl_gltf_copies_place(const struct orl_gltf_copies *copies, size_t i,
                          struct orl_gltf_place *ret_place, struct orl_error *err)
{
    double scale[4] = {1, 1, 1}, rotation[4] = {0, 0, 0, 1}, translation[4] = {0, 0, 0};
    int code = 0;
    if (copies->given[0])
        code = orl_gltf_accessor_value(&copies->scale, i, scale, err);
    if (code == 0 && copies->given[1])
        code = orl_gltf_accessor_value(&copies->rotation, i, rotation, err);
    if (code == 0 && copies->given[2])
        code = orl_gltf_accessor_value(&copies->translation, i, translation, err);
    return code ? code
                : compose(&copies->rotation.item, scale, rotation, translation, ret_place, err);
}

/* ---- Placing --------------------------------------------------------------------------------- */

static struct orl_vec3 row_of(const struct orl_gltf_place *p, int i)
{
    return orl_v3(p->row[i][0], p->row[i][1], p->row[i][2]);
}

struct orl_vec3 orl_gltf_place_point(const struct orl_gltf_place *place, struct orl_vec3 at)
{
    return orl_v3(orl_dot(row_of(place, 0), at) + place->row[0][3],
                  orl_dot(row_of(place, 1), at) + place->row[1][3],
                  orl_dot(row_of(place, 2), at) + place->row[2][3]);
}

bool orl_gltf_place_mirrors(const struct orl_gltf_place *place)
{
    return orl_dot(orl_cross(row_of(place, 0), row_of(place, 1)), row_of(place, 2)) < 0;
}

struct orl_vec3 orl_gltf_place_normal(const struct orl_gltf_place *place, struct orl_vec3 n)
{
    const struct orl_vec3 a = row_of(place, 0), b = row_of(place, 1), c = row_of(place, 2);
    const struct orl_vec3 placed = orl_v3(orl_dot(orl_cross(b, c), n), orl_dot(orl_cross(c, a), n),
                                          orl_dot(orl_cross(a, b), n));
    return orl_gltf_place_mirrors(place) ? orl_neg(placed) : placed;
}
