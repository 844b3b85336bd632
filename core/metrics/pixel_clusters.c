#include "metrics/glare_sources.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

static const uint32_t not_listed = UINT32_MAX;

/* Pixel at the edge of a group, with its cube. */
struct edge {
    int32_t cube[3];
    uint32_t index; /* index in the list of pixels */
};

/* Edge pixels of one cube: count entries from first on. */
struct cube {
    size_t first, count;
};

struct union_find {
    const struct orl_view_field *field;
    const uint32_t *pixels;
    size_t count;
    double chord2;    /* squared chord of the angle */
    uint32_t *parent; /* for each list entry: an earlier entry, or itself */
    uint32_t *listed; /* for each pixel of the picture: its index in the list, or not_listed */
};

static uint32_t root_of(struct union_find *u, uint32_t i)
{
    while (u->parent[i] != i) {
        u->parent[i] = u->parent[u->parent[i]];
        i = u->parent[i];
    }
    return i;
}

/* Joins two groups. The earlier root stays, so that roots are the groups' first pixels. */
static void join_groups(struct union_find *u, uint32_t a, uint32_t b)
{
    a = root_of(u, a);
    b = root_of(u, b);
    if (a < b)
        u->parent[b] = a;
    else
        u->parent[a] = b;
}

static bool are_close(const struct union_find *u, uint32_t a, uint32_t b)
{
    const struct orl_vec3 apart = orl_sub(orl_view_field_direction(u->field, u->pixels[a]),
                                          orl_view_field_direction(u->field, u->pixels[b]));
    return orl_dot(apart, apart) <= u->chord2;
}

/* Returns the list index of the pixel's neighbour; not_listed if it is not listed or outside the
 * picture. */
static uint32_t neighbour_of(const struct union_find *u, uint32_t pixel, int dx, int dy)
{
    const uint32_t width = u->field->width;
    const int64_t x = (int64_t)(pixel % width) + dx, y = (int64_t)(pixel / width) + dy;
    if (x < 0 || y < 0 || x >= width || y >= u->field->height)
        return not_listed;
    return u->listed[(size_t)y * width + (size_t)x];
}

/* Joins a pixel with its close neighbours. Returns true if one of the eight is not close. */
static bool join_neighbours(struct union_find *u, uint32_t index)
{
    bool at_edge = false;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            const uint32_t other = neighbour_of(u, u->pixels[index], dx, dy);
            if (other != not_listed && are_close(u, index, other))
                join_groups(u, index, other);
            else
                at_edge = true;
        }
    return at_edge;
}

static int by_cube(const void *a, const void *b)
{
    const struct edge *p = a, *q = b;
    for (int i = 0; i < 3; i++)
        if (p->cube[i] != q->cube[i])
            return p->cube[i] < q->cube[i] ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

/* Sorts the edge pixels by cubes. Cubes are so small that all pixels within one are close. */
static size_t sort_edges(struct union_find *u, struct edge *edges)
{
    const double side = sqrt(u->chord2 / 3) * (1 - 1e-9);
    size_t n = 0;
    for (uint32_t i = 0; i < u->count; i++) {
        if (!join_neighbours(u, i))
            continue;
        const struct orl_vec3 d = orl_view_field_direction(u->field, u->pixels[i]);
        edges[n++] = (struct edge){
            {(int32_t)floor(d.x / side), (int32_t)floor(d.y / side), (int32_t)floor(d.z / side)},
            i};
    }
    qsort(edges, n, sizeof *edges, by_cube);
    return n;
}

static size_t list_cubes(struct union_find *u, const struct edge *edges, size_t n,
                         struct cube *cubes)
{
    size_t n_cubes = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && memcmp(edges[i].cube, edges[i - 1].cube, sizeof edges->cube) == 0) {
            cubes[n_cubes - 1].count++;
            join_groups(u, edges[i].index, edges[i - 1].index);
        } else {
            cubes[n_cubes++] = (struct cube){i, 1};
        }
    }
    return n_cubes;
}

static void join_cubes(struct union_find *u, const struct edge *edges, const struct cube *a,
                       const struct cube *b)
{
    const struct edge *p = &edges[a->first], *q = &edges[b->first];
    if (root_of(u, p->index) == root_of(u, q->index))
        return;
    for (size_t i = 0; i < a->count; i++)
        for (size_t k = 0; k < b->count; k++)
            if (are_close(u, p[i].index, q[k].index)) {
                join_groups(u, p[i].index, q[k].index);
                return;
            }
}

/* Returns the first cube that is not before that place. */
static size_t find_cube(const struct edge *edges, const struct cube *cubes, size_t n,
                        const int32_t place[3])
{
    struct edge wanted = {{place[0], place[1], place[2]}, 0};
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (by_cube(&edges[cubes[middle].first], &wanted) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Joins a cube with all later cubes in the order that are within reach: up to two apart along an
 * axis. */
static void join_around(struct union_find *u, const struct edge *edges, const struct cube *cubes,
                        size_t n, size_t at)
{
    enum { REACH = 2 };
    const int32_t *here = edges[cubes[at].first].cube;
    for (int32_t dx = 0; dx <= REACH; dx++)
        for (int32_t dy = dx > 0 ? -REACH : 0; dy <= REACH; dy++) {
            const bool same = dx == 0 && dy == 0;
            const int32_t from[3] = {here[0] + dx, here[1] + dy, here[2] + (same ? 1 : -REACH)};
            for (size_t i = find_cube(edges, cubes, n, from); i < n; i++) {
                const int32_t *there = edges[cubes[i].first].cube;
                if (there[0] != from[0] || there[1] != from[1] || there[2] > here[2] + REACH)
                    break;
                join_cubes(u, edges, &cubes[at], &cubes[i]);
            }
        }
}

static void number_groups(struct union_find *u, uint32_t *ret_group, uint32_t *ret_groups)
{
    uint32_t groups = 0;
    for (uint32_t i = 0; i < u->count; i++) {
        const uint32_t root = root_of(u, i);
        ret_group[i] = root == i ? groups++ : ret_group[root];
    }
    *ret_groups = groups;
}

int orl_pixels_cluster(const struct orl_view_field *field, const uint32_t *pixels, size_t count,
                       double angle_rad, uint32_t *ret_group, uint32_t *ret_groups)
{
    const size_t all = (size_t)field->width * field->height;
    const double chord = 2 * sin(fmin(angle_rad, ORL_PI) / 2);
    struct union_find u = {field, pixels, count, chord * chord, NULL, NULL};
    struct orl_arrays arrays = {.failed = false};
    struct edge *edges = orl_arrays_new(&arrays, count, sizeof *edges);
    struct cube *cubes = orl_arrays_new(&arrays, count, sizeof *cubes);
    u.parent = orl_arrays_new(&arrays, count, sizeof *u.parent);
    u.listed = orl_arrays_new(&arrays, all, sizeof *u.listed);
    const int code = arrays.failed ? ORL_ERR_NOMEM : 0;
    if (code == 0) {
        memset(u.listed, 0xff, all * sizeof *u.listed);
        for (uint32_t i = 0; i < count; i++) {
            u.parent[i] = i;
            u.listed[pixels[i]] = i;
        }
        const size_t n = sort_edges(&u, edges), n_cubes = list_cubes(&u, edges, n, cubes);
        for (size_t i = 0; i < n_cubes; i++)
            join_around(&u, edges, cubes, n_cubes, i);
        number_groups(&u, ret_group, ret_groups);
    }
    orl_arrays_free(&arrays);
    return code;
}
