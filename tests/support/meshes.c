#include "support/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static size_t write_face(char *text, const struct orl_vec3 v[3], int depth, int *number)
{
    if (depth == 0)
        return (size_t)sprintf(text,
                               "m polygon f%d 0 0 9 %.12g %.12g %.12g %.12g %.12g %.12g %.12g "
                               "%.12g %.12g\n",
                               (*number)++, v[0].x, v[0].y, v[0].z, v[1].x, v[1].y, v[1].z, v[2].x,
                               v[2].y, v[2].z);
    struct orl_vec3 middle[3];
    size_t size = 0;
    for (int i = 0; i < 3; i++)
        middle[i] = orl_normalize(orl_add(v[i], v[(i + 1) % 3]));
    for (int i = 0; i < 3; i++)
        size += write_face(text + size,
                           (const struct orl_vec3[3]){v[i], middle[i], middle[(i + 2) % 3]},
                           depth - 1, number);
    return size + write_face(text + size, middle, depth - 1, number);
}

char *mesh_icosphere(void)
{
    static const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const double t = (1 + sqrt(5.0)) / 2;
    const struct orl_vec3 v[12] = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                   {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                   {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
    char *text = malloc(20 * 16 * 256);
    int number = 0;
    assert_non_null(text);
    size_t size = (size_t)sprintf(text, MESH_GREY);
    for (int f = 0; f < 20; f++) {
        struct orl_vec3 corners[3];
        for (int i = 0; i < 3; i++)
            corners[i] = orl_normalize(v[faces[f][i]]);
        size += write_face(text + size, corners, 2, &number);
    }
    return text;
}

struct orl_vec3 mesh_direction(struct orl_random *random)
{
    const double z = 2 * orl_random_uniform(random) - 1, s = sqrt(1 - z * z);
    const double phi = 2 * ORL_PI * orl_random_uniform(random);
    return orl_v3(s * cos(phi), s * sin(phi), z);
}

/* Returns a random point of a random edge of the mesh. */
static struct orl_vec3 edge_point(const struct orl_geometry *g, struct orl_random *random)
{
    const size_t i = (size_t)(orl_random_uniform(random) * (double)orl_geometry_triangles_end(g));
    const struct orl_triangle triangle = orl_triangle_get(g, i);
    const struct orl_vec3 c[3] = {triangle.a, triangle.b, triangle.c};
    const int k = (int)(3 * orl_random_uniform(random));
    const double t = orl_random_uniform(random);
    /* Every eighth point is the corner itself. */
    return orl_madd(c[k], orl_sub(c[(k + 1) % 3], c[k]), t < 0.125 ? 0 : t);
}

uint64_t mesh_leaks(const struct orl_geometry *geometry, uint64_t rays, uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0);
    uint64_t leaks = 0;
    for (uint64_t i = 0; i < rays; i++) {
        const struct orl_vec3 from =
            orl_scale(mesh_direction(&random), 0.4 * orl_random_uniform(&random));
        const struct orl_vec3 d = i % 4 == 3
                                      ? mesh_direction(&random)
                                      : orl_normalize(orl_sub(edge_point(geometry, &random), from));
        struct orl_hit hit;
        leaks += !orl_geometry_intersect(geometry, from, d, INFINITY, &hit) || hit.front;
    }
    return leaks;
}

uint64_t mesh_leaks_on_bounce(const struct orl_geometry *geometry, uint64_t bounces, uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 1);
    const struct orl_vec3 middle = {0, 0, 0};
    struct orl_vec3 from = middle, d = mesh_direction(&random);
    uint64_t leaks = 0;
    for (uint64_t i = 0; i < bounces; i++) {
        struct orl_hit hit;
        const bool caught = orl_geometry_intersect(geometry, from, d, INFINITY, &hit);
        d = mesh_direction(&random);
        if (!caught) {
            leaks++;
            from = middle;
            continue;
        }
        const struct orl_vec3 in = hit.front ? hit.normal : orl_neg(hit.normal);
        if (orl_dot(d, in) < 0)
            d = orl_neg(d);
        from = orl_hit_ray_origin(geometry, &hit, d);
    }
    return leaks;
}
