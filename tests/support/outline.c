#include "support/outline.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "scene/geometry/triangulation/triangulate.h"
#include "support/scene_text.h"

enum { MOST = OUTLINE_MOST };

void outline_add(struct outline *o, double x, double y)
{
    assert_true(o->n < MOST);
    o->xy[o->n][0] = x;
    o->xy[o->n][1] = y;
    o->n++;
}

struct outline outline_of(const double (*xy)[2], uint32_t n)
{
    struct outline o = {.n = 0};
    for (uint32_t i = 0; i < n; i++)
        outline_add(&o, xy[i][0], xy[i][1]);
    return o;
}

double outline_area(const struct outline *o)
{
    double twice = 0;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * twice;
}

/* Even-odd rule; seams are traversed twice and cancel. */
static bool inside(const struct outline *o, double x, double y)
{
    bool in = false;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            in = !in;
    }
    return in;
}

/* Returns the distance from a point to the outline. */
static double clearance(const struct outline *o, double x, double y)
{
    double best = INFINITY;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        const double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
        double t = l2 > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / l2 : 0;
        t = fmin(fmax(t, 0), 1);
        best = fmin(best, hypot(x - a[0] - t * dx, y - a[1] - t * dy));
    }
    return best;
}

static struct orl_frame tilted(void)
{
    return orl_frame_about(orl_normalize(orl_v3(0.3, -0.5, 0.8)));
}

static struct orl_vec3 lift(const struct orl_frame *frame, double x, double y)
{
    return orl_to_world(frame, orl_v3(x, y, 0));
}

double outline_area_error(const struct outline *o)
{
    const struct orl_frame frame = tilted();
    struct orl_triangulation cut = {0};
    struct orl_vec3 vertices[MOST];
    double sum = 0;
    for (uint32_t i = 0; i < o->n; i++)
        vertices[i] = lift(&frame, o->xy[i][0], o->xy[i][1]);
    assert_int_equal(orl_triangulate(&cut, vertices, o->n, frame.n), 0);
    for (size_t i = 0; i < cut.n_triples; i++) {
        const struct orl_vec3 a = cut.corners[cut.triples[i][0]];
        const double twice = orl_dot(orl_cross(orl_sub(cut.corners[cut.triples[i][1]], a),
                                               orl_sub(cut.corners[cut.triples[i][2]], a)),
                                     frame.n);
        assert_true(twice > 0);
        sum += 0.5 * twice;
    }
    orl_triangulation_done(&cut);
    return fabs(sum - outline_area(o)) / fabs(outline_area(o));
}

/* Returns the polygon as scene text; free() it. */
static char *write_scene(const struct outline *o, const struct orl_frame *frame)
{
    char *text = malloc(64 + MOST * 100);
    assert_non_null(text);
    size_t at =
        (size_t)sprintf(text, "void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon p 0 0 %u", 3 * o->n);
    for (uint32_t i = 0; i < o->n; i++) {
        const struct orl_vec3 v = lift(frame, o->xy[i][0], o->xy[i][1]);
        at += (size_t)sprintf(text + at, "\n%.17g %.17g %.17g", v.x, v.y, v.z);
    }
    return text;
}

uint32_t outline_misses(const struct outline *o, uint32_t side)
{
    const struct orl_frame frame = tilted();
    char *text = write_scene(o, &frame);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    uint32_t misses = 0;
    for (uint32_t i = 0; i < o->n; i++) {
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], o->xy[i][k]);
            high[k] = fmax(high[k], o->xy[i][k]);
        }
    }
    struct orl_geometry *g = scene_geometry(text);
    const double area = fabs(outline_area(o));
    assert_true(fabs(g->facets[0].area - area) < 1e-9 * area);
    for (uint32_t i = 0; i < side * side; i++) {
        const double x = low[0] + (high[0] - low[0]) * ((i % side + 0.5) / side * 1.1 - 0.05);
        const double y = low[1] + (high[1] - low[1]) * ((i / side + 0.5) / side * 1.1 - 0.05);
        const struct orl_vec3 from = orl_sub(orl_madd(lift(&frame, x, y), frame.n, 2), g->center);
        struct orl_hit hit;
        if (clearance(o, x, y) < 1e-5 * (high[0] - low[0]))
            continue;
        const bool met = orl_geometry_intersect(g, from, orl_neg(frame.n), 10, &hit);
        misses += met != inside(o, x, y) || (met && !(fabs(hit.distance - 2) < 1e-6));
    }
    orl_geometry_free(g);
    free(text);
    return misses;
}
