#include "scene/parse/instance/binary_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"

/* Flags of the vertex data in a patch. */
enum { HAS_POINTS = 1, HAS_NORMALS = 2, HAS_PLACES = 4, ALL_FLAGS = 7 };
enum { VERTICES_MAX = 256, LOCAL_MAX = 512, JOINERS_MAX = 256, PATCH_BYTES_MIN = 14 };

/* Returns the centre of one of 2^32 cells from low on. */
static double cell_center(int64_t number, double low, double size)
{
    return low + ((uint32_t)number + 0.5) * (1.0 / 4294967296.0) * size;
}

static struct orl_vec3 read_vertex(struct orl_binary_reader *reader,
                                   const struct orl_patch_frame *frame)
{
    struct orl_vec3 v;
    v.x = cell_center(orl_binary_int(reader, 4), frame->corner.x, frame->size);
    v.y = cell_center(orl_binary_int(reader, 4), frame->corner.y, frame->size);
    v.z = cell_center(orl_binary_int(reader, 4), frame->corner.z, frame->size);
    return v;
}

static int add_vertex(struct orl_patches *patches, struct orl_vec3 v, struct orl_error *err)
{
    if (!orl_array_reserve(&patches->vertices, &patches->vertices_room, patches->n_vertices,
                           sizeof *patches->vertices) ||
        !orl_array_reserve(&patches->uv, &patches->uv_room, patches->n_vertices,
                           sizeof *patches->uv) ||
        !orl_array_reserve(&patches->normals, &patches->normals_room, patches->n_vertices,
                           sizeof *patches->normals))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    patches->uv[patches->n_vertices][0] = patches->uv[patches->n_vertices][1] = NAN;
    patches->normals[patches->n_vertices] = orl_v3(0, 0, 0);
    patches->vertices[patches->n_vertices++] = v;
    return 0;
}

/*
 * Decodes a direction in 32 bits: three signs, a flag for the smaller of x and y, a flag for
 * whether z is smaller than the other; then both smaller components. The third follows from the
 * length. 0: no normal.
 */
static struct orl_vec3 read_normal(struct orl_binary_reader *reader)
{
    const uint32_t code = (uint32_t)orl_binary_int(reader, 4);
    const double unit = 1 / 11584.5, first = (code >> 5 & 0x1fff) * unit;
    const double second = (code >> 18 & 0x1fff) * unit;
    const double third = sqrt(fmax(0, 1 - first * first - second * second));
    const double other = code & 16 ? third : second, z = code & 16 ? second : third;
    const double x = code & 8 ? first : other, y = code & 8 ? other : first;
    if (code == 0)
        return orl_v3(0, 0, 0);
    return orl_normalize(orl_v3(code & 1 ? -x : x, code & 2 ? -y : y, code & 4 ? -z : z));
}

/* A first number of 0 means no (u, v). */
static void read_uv(struct orl_binary_reader *reader, const struct orl_patch_frame *frame,
                    double ret_place[2])
{
    const int64_t number[2] = {orl_binary_int(reader, 4), orl_binary_int(reader, 4)};
    for (int k = 0; k < 2 && number[0] != 0; k++)
        ret_place[k] = cell_center(number[k], frame->low[k], frame->high[k] - frame->low[k]);
}

static int read_vertices(struct orl_binary_reader *reader, const struct orl_patch_frame *frame,
                         struct orl_patches *patches, struct orl_error *err)
{
    const int64_t flags = orl_binary_int(reader, 1), count = orl_binary_int(reader, 2);
    const size_t first = patches->n_vertices;
    int code = 0;
    if (!(flags & HAS_POINTS) || (flags & ~(int64_t)ALL_FLAGS) || count < 1 || count > VERTICES_MAX)
        return orl_binary_fail(reader, "one of its patches is damaged", err);
    for (int64_t i = 0; i < count && code == 0; i++)
        code = add_vertex(patches, read_vertex(reader, frame), err);
    if (code < 0)
        return code;
    for (size_t i = first; i < patches->n_vertices && (flags & HAS_NORMALS); i++)
        patches->normals[i] = read_normal(reader);
    for (size_t i = first; i < patches->n_vertices && (flags & HAS_PLACES); i++)
        read_uv(reader, frame, patches->uv[i]);
    return 0;
}

static int add_triangle(struct orl_patches *patches, const struct orl_patch_triangle *triangle,
                        struct orl_error *err)
{
    if (patches->n_triangles >= ORL_LIMIT_SURFACES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the mesh has more than %lu triangles",
                             ORL_LIMIT_SURFACES);
    if (!orl_array_reserve(&patches->triangles, &patches->triangles_room, patches->n_triangles,
                           sizeof *patches->triangles))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    patches->triangles[patches->n_triangles++] = *triangle;
    return 0;
}

static uint32_t read_local(struct orl_binary_reader *reader, uint32_t patch)
{
    return patch << 8 | ((uint32_t)orl_binary_int(reader, 1) & 0xff);
}

/* Reads triangles with all corners in the patch, then their materials: one for all, or one each. */
static int read_local_triangles(struct orl_binary_reader *reader, uint32_t patch,
                                struct orl_patches *patches, struct orl_error *err)
{
    const int64_t count = orl_binary_int(reader, 2);
    const size_t first = patches->n_triangles;
    int code = 0;
    if (count < 0 || count > LOCAL_MAX)
        return orl_binary_fail(reader, "one of its patches is damaged", err);
    for (int64_t i = 0; i < count && code == 0; i++) {
        struct orl_patch_triangle triangle = {.material = -1};
        for (int k = 0; k < 3; k++)
            triangle.corner[k] = read_local(reader, patch);
        code = add_triangle(patches, &triangle, err);
    }
    if (code < 0)
        return code;
    const bool own = orl_binary_int(reader, 2) > 1;
    int32_t material = own ? -1 : (int32_t)orl_binary_int(reader, 2);
    for (int64_t i = 0; i < count; i++) {
        material = own ? (int32_t)orl_binary_int(reader, 2) : material;
        patches->triangles[first + (size_t)i].material = material;
    }
    return 0;
}

/* Reads triangles whose first `others` corners are in other patches. */
static int read_joiners(struct orl_binary_reader *reader, uint32_t patch, int others,
                        struct orl_patches *patches, struct orl_error *err)
{
    const int64_t count = orl_binary_int(reader, 2);
    int code = 0;
    if (count < 0 || count > JOINERS_MAX)
        return orl_binary_fail(reader, "one of its patches is damaged", err);
    for (int64_t i = 0; i < count && code == 0; i++) {
        struct orl_patch_triangle triangle;
        for (int k = 0; k < 3; k++)
            triangle.corner[k] =
                k < others ? (uint32_t)orl_binary_int(reader, 4) : read_local(reader, patch);
        triangle.material = (int32_t)orl_binary_int(reader, 2);
        code = add_triangle(patches, &triangle, err);
    }
    return code;
}

int orl_patches_read(struct orl_binary_reader *reader, const struct orl_patch_frame *frame,
                     struct orl_patches *ret, struct orl_error *err)
{
    const int64_t count = orl_binary_int(reader, 4);
    int code = 0;
    memset(ret, 0, sizeof *ret);
    if (reader->ended || count < 0 ||
        (uint64_t)count > (reader->size - reader->at) / PATCH_BYTES_MIN)
        return orl_binary_fail(reader, "the number of its patches is damaged", err);
    ret->first = calloc((size_t)count + 1, sizeof *ret->first);
    if (!ret->first)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (int64_t i = 0; i < count && code == 0; i++) {
        code = read_vertices(reader, frame, ret, err);
        ret->first[++ret->n_patches] = ret->n_vertices;
        if (code == 0)
            code = read_local_triangles(reader, (uint32_t)i, ret, err);
        for (int others = 1; others <= 2 && code == 0; others++)
            code = read_joiners(reader, (uint32_t)i, others, ret, err);
        if (code == 0 && reader->ended)
            code = orl_binary_fail(reader, "", err);
    }
    return code;
}

bool orl_patches_corners(const struct orl_patches *patches, const struct orl_patch_triangle *t,
                         struct orl_vec3 ret_corners[3], double ret_uv[6], bool *ret_has_uv,
                         struct orl_vec3 ret_normals[3], bool *ret_has_normals)
{
    *ret_has_uv = *ret_has_normals = true;
    for (int k = 0; k < 3; k++) {
        const size_t patch = t->corner[k] >> 8, at = t->corner[k] & 0xff;
        if (patch >= patches->n_patches || at >= patches->first[patch + 1] - patches->first[patch])
            return false;
        const double *const place = patches->uv[patches->first[patch] + at];
        ret_corners[k] = patches->vertices[patches->first[patch] + at];
        memcpy(ret_uv + 2 * (size_t)k, place, 2 * sizeof *place);
        *ret_has_uv = *ret_has_uv && isfinite(place[0]) && isfinite(place[1]);
        ret_normals[k] = patches->normals[patches->first[patch] + at];
        *ret_has_normals = *ret_has_normals && orl_length(ret_normals[k]) > 0;
    }
    return true;
}

void orl_patches_done(struct orl_patches *patches)
{
    free(patches->vertices);
    free(patches->uv);
    free(patches->normals);
    free(patches->first);
    free(patches->triangles);
    memset(patches, 0, sizeof *patches);
}
