#include "scene/geometry/triangulation/triangulate.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/* A linked ring of the corners not yet cut off, projected into the polygon's plane. */
struct corner {
    double x, y;
    uint32_t previous, next;
};

/* Twice the signed area of (a, b, c). */
static double area2(const struct corner *a, const struct corner *b, const struct corner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* Projects the corners; returns twice the area below which a triangle counts as degenerate. */
static double project(struct corner *ring, const struct orl_vec3 *vertices, uint32_t n,
                      struct orl_vec3 normal)
{
    const struct orl_frame frame = orl_frame_about(normal);
    double extent = 0;
    for (uint32_t i = 0; i < n; i++) {
        const struct orl_vec3 d = orl_sub(vertices[i], vertices[0]);
        ring[i] = (struct corner){.x = orl_dot(d, frame.u),
                                  .y = orl_dot(d, frame.v),
                                  .previous = i ? i - 1 : n - 1,
                                  .next = i + 1 < n ? i + 1 : 0};
        extent = fmax(extent, fmax(fabs(ring[i].x), fabs(ring[i].y)));
    }
    return extent * extent * 1e-14;
}

/* Returns true if the outline turns left or goes straight at every corner, and winds once. */
static bool is_convex(const struct corner *ring, uint32_t n, double tolerance)
{
    uint32_t lowest = 0;
    bool sure = true;
    for (uint32_t i = 0; i < n && sure; i++) {
        const struct corner *a = &ring[ring[i].previous], *b = &ring[i], *c = &ring[b->next];
        const double turn = area2(a, b, c);
        const double on = (b->x - a->x) * (c->x - b->x) + (b->y - a->y) * (c->y - b->y);
        sure = turn > tolerance || (turn >= -tolerance && on > 0);
        lowest += b->y - a->y < 0 && c->y - b->y >= 0;
    }
    return sure && lowest == 1;
}

/* Cuts off one corner after the other; collinear ones give no triangle. */
static size_t cut_corners(struct corner *ring, uint32_t n, double tolerance,
                          uint32_t (*ret_triples)[3])
{
    size_t count = 0;
    uint32_t at = 0;
    for (uint32_t left = n; left > 2; left--) {
        const uint32_t a = ring[at].previous, c = ring[at].next;
        if (area2(&ring[a], &ring[at], &ring[c]) > tolerance) {
            ret_triples[count][0] = a;
            ret_triples[count][1] = at;
            ret_triples[count][2] = c;
            count++;
        }
        ring[a].next = c;
        ring[c].previous = a;
        at = ring[c].next; /* skipping one avoids a fan of slivers */
    }
    return count;
}

static int sweep(struct orl_triangulation *t, const struct orl_vec3 *vertices, uint32_t n,
                 struct orl_vec3 normal)
{
    struct orl_arrangement *a = &t->arrangement;
    struct orl_vec3 low = vertices[0], high = vertices[0];
    for (uint32_t i = 1; i < n; i++)
        orl_box_include(vertices[i], &low, &high);
    orl_arrangement_begin(a, normal, orl_scale(orl_add(low, high), 0.5),
                          0.5 * orl_length(orl_sub(high, low)));
    int code = orl_arrangement_add(a, vertices, n, 1);
    if (code == 0)
        code = orl_arrangement_split(a);
    if (code == 0)
        code = orl_sweep_triangulate(&t->sweep, a);
    if (code < 0)
        return code;
    if (!orl_array_reserve_more(&t->places, &t->places_room, 0, a->n_nodes, sizeof *t->places))
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < a->n_nodes; i++)
        t->places[i] = a->nodes[i].place;
    t->corners = t->places;
    t->triples = t->sweep.triples;
    t->n_triples = t->sweep.n_triples;
    return 0;
}

int orl_triangulate(struct orl_triangulation *t, const struct orl_vec3 *vertices, uint32_t n,
                    struct orl_vec3 normal)
{
    if (!orl_array_reserve_more(&t->ring, &t->ring_room, 0, n, sizeof(struct corner)) ||
        !orl_array_reserve_more(&t->sweep.triples, &t->sweep.triples_room, 0, n,
                                sizeof *t->sweep.triples))
        return ORL_ERR_NOMEM;
    const double tolerance = project(t->ring, vertices, n, normal);
    if (!is_convex(t->ring, n, tolerance))
        return sweep(t, vertices, n, normal);
    t->corners = vertices;
    t->triples = t->sweep.triples;
    t->n_triples = cut_corners(t->ring, n, tolerance, t->sweep.triples);
    return 0;
}

void orl_triangulation_done(struct orl_triangulation *t)
{
    orl_arrangement_done(&t->arrangement);
    orl_sweep_done(&t->sweep);
    free(t->ring);
    free(t->places);
}

enum { LATEST_BITS = 16 };

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry)
{
    *corners = (struct orl_corners){
        .geometry = geometry,
        .latest = calloc((size_t)1 << LATEST_BITS, sizeof *corners->latest),
    };
    return corners->latest &&
           orl_array_reserve(&geometry->corners, &corners->room, 0, sizeof *geometry->corners);
}

void orl_corners_done(struct orl_corners *corners)
{
    free(corners->latest);
}

/* Returns true if two places have the same bits: 0 and -0 differ. */
static bool are_same(struct orl_vec3 a, struct orl_vec3 b)
{
    uint64_t bits_a[3], bits_b[3];
    memcpy(bits_a, &a, sizeof bits_a);
    memcpy(bits_b, &b, sizeof bits_b);
    return memcmp(bits_a, bits_b, sizeof bits_a) == 0;
}

static size_t slot_of(struct orl_vec3 place)
{
    static const uint64_t odd = 0x9e3779b97f4a7c15U;
    uint64_t mixed = 0, bits[3];
    memcpy(bits, &place, sizeof bits);
    for (int k = 0; k < 3; k++) {
        mixed = (mixed ^ bits[k]) * odd;
        mixed ^= mixed >> 32;
    }
    return (mixed * odd) >> (64 - LATEST_BITS);
}

bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index)
{
    struct orl_geometry *const g = corners->geometry;
    uint32_t *const latest = &corners->latest[slot_of(place)];
    if (*latest == 0 || !are_same(g->corners[*latest - 1], place)) {
        if (!orl_array_reserve(&g->corners, &corners->room, g->n_corners, sizeof *g->corners))
            return false;
        g->corners[g->n_corners++] = place;
        *latest = (uint32_t)g->n_corners;
    }
    *ret_index = *latest - 1;
    return true;
}

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
