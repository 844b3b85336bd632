#include "scene/geometry/triangulation/triangulate.h"

#include <stdbool.h>
#include <stdlib.h>

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
    for (uint32_t i = 1; i < n; i++) {
        const struct orl_vec3 p = vertices[i];
        low = orl_v3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = orl_v3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    orl_arrangement_begin(a, normal, orl_scale(orl_add(low, high), 0.5),
                          0.5 * orl_length(orl_sub(high, low)));
    int code = orl_arrangement_add(a, vertices, n, 1);
    if (code == 0)
        code = orl_arrangement_split(a);
    if (code == 0)
        code = orl_sweep_triangulate(&t->sweep, a);
    if (code < 0)
        return code;
    if (!orl_sweep_reserve(&t->places, &t->places_room, a->n_nodes, sizeof *t->places))
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
    if (!orl_sweep_reserve(&t->ring, &t->ring_room, n, sizeof(struct corner)) ||
        !orl_sweep_reserve(&t->sweep.triples, &t->sweep.triples_room, n, sizeof *t->sweep.triples))
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
