#include "scene/geometry/triangulation/mesh_quads.h"

#include <stdlib.h>

#include "base/memory/array.h"

/* Returns true if two triangles share an edge that they traverse in opposite directions. *ret_turn,
 * *ret_other: corners from which to list each, so that the first's last corner is the other's
 * first, and vice versa. */
static bool find_rotations(const uint32_t *first, const uint32_t *second, unsigned *ret_turn,
                           unsigned *ret_other)
{
    for (unsigned i = 0; i < 3; i++)
        for (unsigned k = 0; k < 3; k++)
            if (first[(i + 2) % 3] == second[k] && first[i] == second[(k + 2) % 3]) {
                *ret_turn = i;
                *ret_other = k;
                return true;
            }
    return false;
}

/* Returns the position of a triangle's original first corner after it has been rotated by turn. */
static unsigned inverse_rotation(unsigned rotation)
{
    return (3 - rotation) % 3;
}

/* A quad of one triangle, rotated by turn. */
static struct orl_mesh_quad quad_of(const uint32_t *triangle, unsigned rotation, uint32_t facet)
{
    const uint32_t last = triangle[rotation];
    return (struct orl_mesh_quad){
        .corners = {triangle[(rotation + 1) % 3], triangle[(rotation + 2) % 3], last, last},
        .facet = facet & 0x7ffffffU,
        .rotation = inverse_rotation(rotation) & 3U,
    };
}

/* Adds the second triangle, which belongs to the same facet or the next one. */
static void join(struct orl_mesh_quad *quad, const uint32_t *triangle, unsigned rotation,
                 uint32_t facet)
{
    quad->corners[2] = triangle[(rotation + 1) % 3];
    quad->next = facet != quad->facet;
    quad->second_rotation = inverse_rotation(rotation) & 3U;
}

static bool add_quad(struct orl_quad_builder *c, const uint32_t *triangle, unsigned rotation,
                     uint32_t facet)
{
    struct orl_geometry *const g = c->geometry;
    if (!orl_array_reserve(&g->quads, &c->room, g->n_quads, sizeof *g->quads))
        return false;
    g->quads[g->n_quads++] = quad_of(triangle, rotation, facet);
    return true;
}

/* Adds the only triangle of a polygon; pairs it with that of the previous polygon if they share an
 * edge. */
static bool add_one(struct orl_quad_builder *c, uint32_t facet, const uint32_t *triangle)
{
    struct orl_geometry *const g = c->geometry;
    struct orl_facet *const f = &g->facets[facet];
    unsigned rotation, other;
    if (c->open) {
        struct orl_mesh_quad *const last = &g->quads[g->n_quads - 1];
        const size_t number = 2 * g->n_quads - 2;
        const uint32_t before[3] = {orl_triangle_corner(g, number, 0),
                                    orl_triangle_corner(g, number, 1),
                                    orl_triangle_corner(g, number, 2)};
        if (find_rotations(before, triangle, &rotation, &other)) {
            *last = quad_of(before, rotation, last->facet);
            join(last, triangle, other, facet);
            f->first_triangle = (uint32_t)number + 1;
            c->open = false;
            return true;
        }
    }
    f->first_triangle = (uint32_t)(2 * g->n_quads);
    c->open = true;
    return add_quad(c, triangle, 0, facet);
}

bool orl_quad_builder_add(struct orl_quad_builder *quads, uint32_t facet, uint32_t (*triangles)[3],
                          uint32_t n)
{
    struct orl_geometry *const g = quads->geometry;
    struct orl_facet *const f = &g->facets[facet];
    unsigned rotation = 0, other = 0;
    f->n_triangles = n & 0x7fffffU;
    f->step = 1;
    if (n == 1)
        return add_one(quads, facet, triangles[0]);
    const bool whole = n == 2 && find_rotations(triangles[0], triangles[1], &rotation, &other);
    quads->open = false;
    f->first_triangle = (uint32_t)(2 * g->n_quads);
    if (whole) {
        if (!add_quad(quads, triangles[0], rotation, facet))
            return false;
        join(&g->quads[g->n_quads - 1], triangles[1], other, facet);
        return true;
    }
    f->step = 2;
    for (uint32_t i = 0; i < n; i++)
        if (!add_quad(quads, triangles[i], 0, facet))
            return false;
    return true;
}
