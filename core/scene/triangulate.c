#include "scene/triangulate.h"

#include <stdbool.h>
#include <stdlib.h>

/* A ring of the corners not yet cut off, projected into the polygon's plane. */
struct corner {
    double x, y;
    uint32_t index, previous, next;
    bool reflex;
};

/* Twice the signed area of (a, b, c). */
static double area2(const struct corner *a, const struct corner *b, const struct corner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static bool same_point(const struct corner *a, const struct corner *b)
{
    return a->x == b->x && a->y == b->y;
}

/* Inside or on the border of the counter-clockwise triangle (a, b, c). */
static bool covers(const struct corner *a, const struct corner *b, const struct corner *c,
                   const struct corner *p)
{
    return area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0;
}

/*
 * A corner that coincides with one of the triangle's stands on a seam: it only matters when the
 * outline enters the triangle there, that is when a neighbour of it lies strictly inside the angle.
 */
static bool seam_enters(const struct corner *ring, const struct corner *a, const struct corner *b,
                        const struct corner *c, const struct corner *p)
{
    const struct corner *next = &ring[p->next], *previous = &ring[p->previous];
    const bool next_inside =
        area2(a, b, next) > 0 && area2(b, c, next) > 0 && area2(c, a, next) > 0;
    const bool previous_inside =
        area2(a, b, previous) > 0 && area2(b, c, previous) > 0 && area2(c, a, previous) > 0;
    return next_inside || previous_inside;
}

static bool is_ear(const struct corner *ring, uint32_t at, double tolerance)
{
    const struct corner *b = &ring[at], *a = &ring[b->previous], *c = &ring[b->next];
    if (area2(a, b, c) <= tolerance)
        return false;
    for (uint32_t i = c->next; i != b->previous; i = ring[i].next) {
        const struct corner *p = &ring[i];
        if (!p->reflex)
            continue;
        if (same_point(p, a) || same_point(p, b) || same_point(p, c)) {
            if (seam_enters(ring, a, b, c, p))
                return false;
        } else if (covers(a, b, c, p)) {
            return false;
        }
    }
    return true;
}

static void mark(struct corner *ring, uint32_t at)
{
    ring[at].reflex = area2(&ring[ring[at].previous], &ring[at], &ring[ring[at].next]) <= 0;
}

static void cut(struct corner *ring, uint32_t at)
{
    const uint32_t a = ring[at].previous, c = ring[at].next;
    ring[a].next = c;
    ring[c].previous = a;
    mark(ring, a);
    mark(ring, c);
}

static double project(struct corner *ring, const struct orl_vec3 *vertices, uint32_t n,
                      struct orl_vec3 normal)
{
    const struct orl_frame frame = orl_frame_about(normal);
    double extent = 0;
    for (uint32_t i = 0; i < n; i++) {
        const struct orl_vec3 d = orl_sub(vertices[i], vertices[0]);
        ring[i] = (struct corner){.x = orl_dot(d, frame.u),
                                  .y = orl_dot(d, frame.v),
                                  .index = i,
                                  .previous = i ? i - 1 : n - 1,
                                  .next = i + 1 < n ? i + 1 : 0};
        extent = fmax(extent, fmax(fabs(ring[i].x), fabs(ring[i].y)));
    }
    for (uint32_t i = 0; i < n; i++)
        mark(ring, i);
    return extent * extent * 1e-14;
}

int orl_triangulate(const struct orl_vec3 *vertices, uint32_t n, struct orl_vec3 normal,
                    uint32_t (*ret_triangles)[3])
{
    struct corner *ring = malloc(n * sizeof *ring);
    uint32_t left = n, at = 0, tried = 0;
    int count = 0;
    if (!ring)
        return ORL_ERR_NOMEM;
    const double tolerance = project(ring, vertices, n, normal);
    while (left > 2) {
        const uint32_t a = ring[at].previous, c = ring[at].next;
        const bool flat = fabs(area2(&ring[a], &ring[at], &ring[c])) <= tolerance;
        /* After a full turn without an ear the outline crosses itself: any corner must go. */
        const bool stuck = tried > left;
        if (flat || is_ear(ring, at, tolerance) || stuck) {
            if (!flat && area2(&ring[a], &ring[at], &ring[c]) > tolerance) {
                ret_triangles[count][0] = ring[a].index;
                ret_triangles[count][1] = ring[at].index;
                ret_triangles[count][2] = ring[c].index;
                count++;
            }
            cut(ring, at);
            left--;
            tried = 0;
            at = ring[c].next; /* skipping one keeps the triangles from fanning into slivers */
        } else {
            at = c;
            tried++;
        }
    }
    free(ring);
    return count;
}
