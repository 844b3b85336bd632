#include "scene/geometry/couples.h"

#include <stdlib.h>

#include "base/grow.h"

/* Returns true if two triangles share an edge that they traverse in opposite directions. *ret_turn,
 * *ret_other: corners from which to list each, so that the first's last corner is the other's
 * first, and vice versa. */
static bool find_turns(const uint32_t *first, const uint32_t *second, unsigned *ret_turn,
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
static unsigned turned_back(unsigned turn)
{
    return (3 - turn) % 3;
}

/* A couple of one triangle, rotated by turn. */
static struct orl_couple couple_of(const uint32_t *triangle, unsigned turn, uint32_t facet)
{
    const uint32_t last = triangle[turn];
    return (struct orl_couple){
        .corners = {triangle[(turn + 1) % 3], triangle[(turn + 2) % 3], last, last},
        .facet = facet & 0x7ffffffU,
        .turn = turned_back(turn) & 3U,
    };
}

/* Adds the second triangle, which belongs to the same facet or the next one. */
static void join(struct orl_couple *couple, const uint32_t *triangle, unsigned turn, uint32_t facet)
{
    couple->corners[2] = triangle[(turn + 1) % 3];
    couple->next = facet != couple->facet;
    couple->turn_of_second = turned_back(turn) & 3U;
}

static bool add_couple(struct orl_couples *c, const uint32_t *triangle, unsigned turn,
                       uint32_t facet)
{
    struct orl_geometry *const g = c->geometry;
    if (!orl_grow(&g->couples, &c->room, g->n_couples, sizeof *g->couples))
        return false;
    g->couples[g->n_couples++] = couple_of(triangle, turn, facet);
    return true;
}

/* Adds the only triangle of a polygon; pairs it with that of the previous polygon if they share an
 * edge. */
static bool add_one(struct orl_couples *c, uint32_t facet, const uint32_t *triangle)
{
    struct orl_geometry *const g = c->geometry;
    struct orl_facet *const f = &g->facets[facet];
    unsigned turn, other;
    if (c->open) {
        struct orl_couple *const last = &g->couples[g->n_couples - 1];
        const size_t number = 2 * g->n_couples - 2;
        const uint32_t before[3] = {orl_triangle_corner(g, number, 0),
                                    orl_triangle_corner(g, number, 1),
                                    orl_triangle_corner(g, number, 2)};
        if (find_turns(before, triangle, &turn, &other)) {
            *last = couple_of(before, turn, last->facet);
            join(last, triangle, other, facet);
            f->first_triangle = (uint32_t)number + 1;
            c->open = false;
            return true;
        }
    }
    f->first_triangle = (uint32_t)(2 * g->n_couples);
    c->open = true;
    return add_couple(c, triangle, 0, facet);
}

bool orl_couples_add(struct orl_couples *couples, uint32_t facet, uint32_t (*triangles)[3],
                     uint32_t n)
{
    struct orl_geometry *const g = couples->geometry;
    struct orl_facet *const f = &g->facets[facet];
    unsigned turn = 0, other = 0;
    f->n_triangles = n & 0x7fffffU;
    f->step = 1;
    if (n == 1)
        return add_one(couples, facet, triangles[0]);
    const bool whole = n == 2 && find_turns(triangles[0], triangles[1], &turn, &other);
    couples->open = false;
    f->first_triangle = (uint32_t)(2 * g->n_couples);
    if (whole) {
        if (!add_couple(couples, triangles[0], turn, facet))
            return false;
        join(&g->couples[g->n_couples - 1], triangles[1], other, facet);
        return true;
    }
    f->step = 2;
    for (uint32_t i = 0; i < n; i++)
        if (!add_couple(couples, triangles[i], 0, facet))
            return false;
    return true;
}
