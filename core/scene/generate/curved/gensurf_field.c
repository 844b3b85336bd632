#include <stdio.h>
#include <string.h>

#include "scene/generate/curved/gensurf.h"

/* A normal over a cell: a linear function of u v, u, v and 1, where u and v are the coordinates
 * other than the axis. */
struct turning {
    bool given;
    int axis;
    struct orl_vec3 terms[4];
};

static double coordinate(struct orl_vec3 v, int axis)
{
    return axis % 3 == 0 ? v.x : axis % 3 == 1 ? v.y : v.z;
}

/* Inverts a by elimination with column pivots, which are swapped onto its diagonal; false if
 * singular. */
static bool invert(double a[4][4], double inverse[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            inverse[i][k] = i == k;
    for (int i = 0; i < 4; i++) {
        double most = 1e-6;
        int pivot = -1;
        for (int k = i; k < 4; k++)
            if (fabs(a[k][i]) > most) {
                most = fabs(a[k][i]);
                pivot = k;
            }
        if (pivot < 0)
            return false;
        for (int k = 0; k < 4; k++) {
            const double x = a[i][k], y = inverse[i][k];
            a[i][k] = a[pivot][k], inverse[i][k] = inverse[pivot][k];
            a[pivot][k] = x, inverse[pivot][k] = y;
        }
        const double by = a[i][i];
        for (int k = 0; k < 4; k++)
            a[i][k] /= by, inverse[i][k] /= by;
        for (int j = 0; j < 4; j++) {
            const double factor = a[j][i];
            for (int k = 0; k < 4 && j != i; k++)
                a[j][k] -= a[i][k] * factor, inverse[j][k] -= inverse[i][k] * factor;
        }
    }
    return true;
}

static struct turning find_turning(const struct orl_gensurf *surface,
                                   const struct orl_gensurf_vertex *const corners[4])
{
    struct turning turning = {.given = false};
    struct orl_vec3 sum = corners[0]->normal;
    double equations[4][4], inverse[4][4];
    if (!surface->smooth)
        return turning;
    for (int k = 1; k < 4; k++)
        sum = orl_add(sum, corners[k]->normal);
    turning.axis = fabs(sum.x) > fabs(sum.y) ? 0 : 1;
    turning.axis = fabs(coordinate(sum, turning.axis)) > fabs(sum.z) ? turning.axis : 2;
    for (int k = 0; k < 4; k++) {
        const double u = coordinate(corners[k]->place, turning.axis + 1);
        const double v = coordinate(corners[k]->place, turning.axis + 2);
        const double row[4] = {u * v, u, v, 1};
        memcpy(equations[k], row, sizeof row);
    }
    turning.given = invert(equations, inverse);
    for (int k = 0; k < 4 && turning.given; k++)
        for (int i = 0; i < 4; i++)
            turning.terms[k] = orl_madd(turning.terms[k], corners[i]->normal, inverse[k][i]);
    return turning;
}

/* flat: the polygon's normal, to which the texture's value is added. */
static void add_texture(const struct orl_gensurf *surface, const struct turning *turning,
                        struct orl_vec3 flat, struct orl_text *text)
{
    orl_text_add(text, "'%s' texfunc Phong\n4 surf_dx surf_dy surf_dz surf.cal\n0\n13 %d",
                 surface->material, turning->axis);
    for (int k = 0; k < 3; k++)
        orl_text_add_point(text, turning->terms[k]);
    orl_text_add_point(text, orl_sub(turning->terms[3], flat));
    orl_text_add(text, "\n");
}

static void add_polygon(struct orl_gensurf *surface, const struct turning *turning,
                        struct orl_vec3 flat, const struct orl_gensurf_vertex *const *corners,
                        size_t n, struct orl_text *text)
{
    char part[24];
    if (turning->given)
        add_texture(surface, turning, flat, text);
    snprintf(part, sizeof part, "%d", ++surface->n_faces);
    orl_text_add_head(text, turning->given ? "Phong" : surface->material, "polygon", surface->name,
                      part, 3 * n);
    for (size_t k = 0; k < n; k++)
        orl_text_add_point(text, corners[k]->place);
    orl_text_add(text, "\n");
}

static void add_face(const struct orl_gensurf *surface,
                     const struct orl_gensurf_vertex *const *corners, size_t n,
                     struct orl_text *text)
{
    orl_text_add(text, "f");
    for (size_t k = 0; k < n; k++) {
        const int place = corners[k]->number - surface->n_vertices - 1;
        const int normal = corners[k]->normal_number;
        orl_text_add(text, " %d/%d/%d", place, place,
                     normal > 0 ? normal - surface->n_normals - 1 : 0);
    }
    orl_text_add(text, "\n");
}

static void write_piece(struct orl_gensurf *surface, const struct turning *turning,
                        struct orl_vec3 flat, const struct orl_gensurf_vertex *const *corners,
                        size_t n, struct orl_text *text)
{
    if (surface->object)
        add_face(surface, corners, n, text);
    else
        add_polygon(surface, turning, flat, corners, n, text);
}

/* Returns the unit normal; false unless all three vertices exist and are not collinear. */
static bool is_triangle(const struct orl_gensurf_vertex *a, const struct orl_gensurf_vertex *b,
                        const struct orl_gensurf_vertex *c, struct orl_vec3 *ret_normal)
{
    const struct orl_vec3 normal =
        orl_cross(orl_sub(b->place, a->place), orl_sub(c->place, a->place));
    const double length = orl_length(normal);
    *ret_normal = length > 0 ? orl_scale(normal, 1 / length) : normal;
    return a->valid && b->valid && c->valid && length > 0;
}

void orl_gensurf_add_field(struct orl_gensurf *surface,
                           const struct orl_gensurf_vertex *const corners[4], struct orl_text *text)
{
    const bool turned = surface->inverted;
    const struct orl_gensurf_vertex *const c[4] = {corners[0], corners[turned ? 2 : 1],
                                                   corners[turned ? 1 : 2], corners[3]};
    struct orl_vec3 first, second;
    const bool has_first = is_triangle(c[0], c[1], c[2], &first);
    const bool has_second = is_triangle(c[3], c[2], c[1], &second);
    const struct orl_gensurf_vertex *const around[4] = {c[0], c[1], c[3], c[2]};
    const struct orl_gensurf_vertex *const triangles[2][3] = {{c[0], c[1], c[2]},
                                                              {c[2], c[1], c[3]}};
    if (!has_first && !has_second)
        return;
    const struct turning turning = find_turning(surface, c);
    if (has_first && has_second && orl_dot(first, second) >= 1 - 1e-12) {
        write_piece(surface, &turning, orl_scale(orl_add(first, second), .5), around, 4, text);
        return;
    }
    if (has_first)
        write_piece(surface, &turning, first, triangles[0], 3, text);
    if (has_second)
        write_piece(surface, &turning, second, triangles[1], 3, text);
}
