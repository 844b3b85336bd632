/*
 * Arbitrary outlines against the even-odd rule: ten thousand random ones, self-intersecting,
 * touching, keyholed in either orientation, with spikes, collinear and repeated corners; compared
 * point by point, by area, and by shared sides of triangles. And large ones: their cost and
 * limits.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include <oriel/base/limits.h>

#include "base/sampling/sampling.h"
#include "scene/geometry/triangulation/triangulate.h"
#include "support/outline.h"
#include "support/scene_text.h"

enum { OUTLINES = 10000, POINTS = 40 };

static struct orl_frame tilt(void)
{
    return orl_frame_about(orl_normalize(orl_v3(-0.2, 0.6, 0.7)));
}

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

/* ---- Random outlines ------------------------------------------------------------------------- */

/* Adds random corners, anywhere or on a coarse grid where they coincide and are collinear. */
static void add_scribble(struct outline *o, struct orl_random *random, bool grid)
{
    const int n = 3 + (int)(uniform(random) * (grid ? 14 : 22));
    for (int i = 0; i < n; i++) {
        const double x = uniform(random), y = uniform(random);
        outline_add(o, grid ? floor(6 * x) : x, grid ? floor(6 * y) : y);
    }
}

static void add_star(struct outline *o, struct orl_random *random, double x, double y, double size)
{
    const int n = 3 + (int)(uniform(random) * 8), way = uniform(random) < 0.5 ? -1 : 1;
    const double start_x = x + size, start_y = y;
    outline_add(o, start_x, start_y);
    for (int i = 1; i < n; i++) {
        const double r = size * (0.5 + 0.5 * uniform(random)), phi = way * 2 * ORL_PI * i / n;
        outline_add(o, x + r * cos(phi), y + r * sin(phi));
    }
    outline_add(o, start_x, start_y);
}

/* Adds nested and adjacent stars, each joined to the first corner by a seam. */
static void add_keyholes(struct outline *o, struct orl_random *random)
{
    add_star(o, random, 0, 0, 4);
    const double x = o->xy[0][0], y = o->xy[0][1];
    const int holes = 1 + (int)(uniform(random) * 4);
    for (int i = 0; i < holes; i++) {
        add_star(o, random, -1.2 + 0.8 * i, 0.5 * uniform(random), 0.2 + 0.9 * uniform(random));
        outline_add(o, x, y);
    }
}

/* Adds spikes, out and back again, at random corners; and repeated corners. */
static void add_spikes(struct outline *o, struct orl_random *random)
{
    struct outline plain = {.n = 0};
    add_scribble(&plain, random, uniform(random) < 0.5);
    for (uint32_t i = 0; i < plain.n; i++) {
        const double x = plain.xy[i][0], y = plain.xy[i][1], which = uniform(random);
        outline_add(o, x, y);
        if (which < 0.2)
            outline_add(o, x, y);
        if (which > 0.7) {
            outline_add(o, x + uniform(random) - 0.5, y + uniform(random) - 0.5);
            outline_add(o, x, y);
        }
    }
}

static struct outline random_outline(uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 2);
    struct outline o = {.n = 0};
    switch (seed % 4) {
    case 0:
        add_scribble(&o, &random, false);
        break;
    case 1:
        add_scribble(&o, &random, true);
        break;
    case 2:
        add_keyholes(&o, &random);
        break;
    default:
        add_spikes(&o, &random);
    }
    return o;
}

/* ---- Reference results ----------------------------------------------------------------------- */

static int compare_doubles(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

/* Returns the intersections of the outline with a height, from left to right. */
static uint32_t cuts_at(const struct outline *o, double y, double *ret_x)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < o->n; i++) {
        const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
        if ((a[1] > y) != (b[1] > y))
            ret_x[n++] = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }
    qsort(ret_x, n, sizeof *ret_x, compare_doubles);
    return n;
}

static double width_at(const struct outline *o, double y)
{
    double x[OUTLINE_MOST], sum = 0;
    const uint32_t n = cuts_at(o, y, x);
    for (uint32_t i = 0; i + 1 < n; i += 2)
        sum += x[i + 1] - x[i];
    return sum;
}

/* Returns the heights of corners and crossings: between them the width is linear. */
static size_t levels_of(const struct outline *o, double *ret_levels, size_t room)
{
    size_t n = 0;
    for (uint32_t i = 0; i < o->n; i++)
        ret_levels[n++] = o->xy[i][1];
    for (uint32_t i = 0; i < o->n; i++) {
        for (uint32_t j = i + 1; j < o->n && n < room; j++) {
            const double *a = o->xy[i], *b = o->xy[(i + 1) % o->n];
            const double *c = o->xy[j], *d = o->xy[(j + 1) % o->n];
            const double ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1];
            const double det = ux * vy - uy * vx;
            const double s = ((c[0] - a[0]) * vy - (c[1] - a[1]) * vx) / det;
            const double t = ((c[0] - a[0]) * uy - (c[1] - a[1]) * ux) / det;
            if (det != 0 && s >= 0 && s <= 1 && t >= 0 && t <= 1)
                ret_levels[n++] = a[1] + s * uy;
        }
    }
    qsort(ret_levels, n, sizeof *ret_levels, compare_doubles);
    return n;
}

static double even_odd_area(const struct outline *o)
{
    static double levels[1 << 14];
    const size_t n = levels_of(o, levels, sizeof levels / sizeof *levels);
    double sum = 0;
    for (size_t i = 0; i + 1 < n; i++)
        sum += (levels[i + 1] - levels[i]) * width_at(o, 0.5 * (levels[i] + levels[i + 1]));
    return sum;
}

/* ---- Triangles projected into the plane ------------------------------------------------------ */

struct mesh {
    struct orl_triangulation cut;
    double (*xy)[2];
};

static struct mesh cut_up(const struct outline *o)
{
    const struct orl_frame frame = tilt();
    struct orl_vec3 *vertices = malloc(o->n * sizeof *vertices);
    struct mesh mesh = {0};
    size_t most = 0;
    assert_non_null(vertices);
    for (uint32_t i = 0; i < o->n; i++)
        vertices[i] = orl_to_world(&frame, orl_v3(o->xy[i][0], o->xy[i][1], 5));
    assert_int_equal(orl_triangulate(&mesh.cut, vertices, o->n, frame.n), 0);
    for (size_t i = 0; i < 3 * mesh.cut.n_triples; i++)
        if (mesh.cut.triples[i / 3][i % 3] >= most)
            most = mesh.cut.triples[i / 3][i % 3] + 1;
    mesh.xy = calloc(most + 1, sizeof *mesh.xy);
    assert_non_null(mesh.xy);
    for (size_t i = 0; i < most; i++) {
        const struct orl_vec3 p = orl_to_local(&frame, mesh.cut.corners[i]);
        mesh.xy[i][0] = p.x;
        mesh.xy[i][1] = p.y;
    }
    free(vertices);
    return mesh;
}

static void mesh_done(struct mesh *mesh)
{
    orl_triangulation_done(&mesh->cut);
    free(mesh->xy);
}

static double cross_product(const double *a, const double *b, double x, double y)
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* Returns the number of triangles that contain the point. */
static int holding(const struct mesh *mesh, double x, double y)
{
    int n = 0;
    for (size_t i = 0; i < mesh->cut.n_triples; i++) {
        const uint32_t *t = mesh->cut.triples[i];
        const double *a = mesh->xy[t[0]], *b = mesh->xy[t[1]], *c = mesh->xy[t[2]];
        n += cross_product(a, b, x, y) > 0 && cross_product(b, c, x, y) > 0 &&
             cross_product(c, a, x, y) > 0;
    }
    return n;
}

static double mesh_area(const struct mesh *mesh)
{
    double sum = 0;
    for (size_t i = 0; i < mesh->cut.n_triples; i++) {
        const uint32_t *t = mesh->cut.triples[i];
        const double *c = mesh->xy[t[2]];
        sum += 0.5 * cross_product(mesh->xy[t[0]], mesh->xy[t[1]], c[0], c[1]);
    }
    return sum;
}

/* Returns the distance of a point from the segment from a to b. */
static double off_line(const double *a, const double *b, double x, double y)
{
    const double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
    const double t = l2 > 0 ? fmin(fmax(((x - a[0]) * dx + (y - a[1]) * dy) / l2, 0), 1) : 0;
    return hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

static double clear_of_outline(const struct outline *o, double x, double y)
{
    double best = INFINITY;
    for (uint32_t i = 0; i < o->n; i++)
        best = fmin(best, off_line(o->xy[i], o->xy[(i + 1) % o->n], x, y));
    return best;
}

static double clear_of_sides(const struct mesh *mesh, double x, double y)
{
    double best = INFINITY;
    for (size_t i = 0; i < 3 * mesh->cut.n_triples; i++) {
        const uint32_t *t = mesh->cut.triples[i / 3];
        best = fmin(best, off_line(mesh->xy[t[i % 3]], mesh->xy[t[(i + 1) % 3]], x, y));
    }
    return best;
}

static bool has_side(const struct mesh *mesh, uint32_t from, uint32_t to)
{
    for (size_t i = 0; i < 3 * mesh->cut.n_triples; i++)
        if (mesh->cut.triples[i / 3][i % 3] == from && mesh->cut.triples[i / 3][(i + 1) % 3] == to)
            return true;
    return false;
}

/* Counts sides without an opposite side in another triangle that are not on the outline. There a
 * corner lies on a side, and rays may leak. */
static int seams_open(const struct mesh *mesh, const struct outline *o, double near)
{
    int n = 0;
    for (size_t i = 0; i < 3 * mesh->cut.n_triples; i++) {
        const uint32_t *t = mesh->cut.triples[i / 3];
        const uint32_t a = t[i % 3], b = t[(i + 1) % 3];
        const double x = 0.5 * (mesh->xy[a][0] + mesh->xy[b][0]);
        const double y = 0.5 * (mesh->xy[a][1] + mesh->xy[b][1]);
        n += !has_side(mesh, b, a) && clear_of_outline(o, x, y) > near;
    }
    return n;
}

static int odd_at(const struct outline *o, double x, double y)
{
    double cuts[OUTLINE_MOST];
    const uint32_t n = cuts_at(o, y, cuts);
    int odd = 0;
    for (uint32_t i = 0; i < n; i++)
        odd ^= cuts[i] > x;
    return odd;
}

static void check_points(const struct outline *o, const struct mesh *mesh, uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 3);
    for (int i = 0; i < POINTS; i++) {
        const uint32_t at = (uint32_t)(uniform(&random) * o->n);
        const double spread = uniform(&random) < 0.5 ? 0.1 : 3;
        const double x = o->xy[at][0] + spread * (uniform(&random) - 0.5);
        const double y = o->xy[at][1] + spread * (uniform(&random) - 0.5);
        if (clear_of_outline(o, x, y) < 1e-7 || clear_of_sides(mesh, x, y) < 1e-7)
            continue;
        assert_int_equal(holding(mesh, x, y), odd_at(o, x, y));
    }
}

static void test_even_odd(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < OUTLINES; seed++) {
        const struct outline o = random_outline(seed);
        struct mesh mesh = cut_up(&o);
        const double area = even_odd_area(&o);
        check_points(&o, &mesh, seed);
        /* Crossings of nearly parallel edges move by some steps of the grid. */
        assert_true(fabs(mesh_area(&mesh) - area) <= 1e-7 * (1 + area));
        assert_int_equal(seams_open(&mesh, &o, 1e-7), 0);
        mesh_done(&mesh);
    }
}

/* ---- Specific outlines ----------------------------------------------------------------------- */

/* The traced outline: the inner loop has the orientation of the outer one. */
static void test_hole_wound_alike(void **state)
{
    static const double wall[][2] = {{0, 0},      {4, 0},     {4, 3.2},    {0, 3.2},
                                     {.45, 2.84}, {.45, .36}, {3.55, .36}, {3.55, 2.84},
                                     {.45, 2.84}, {0, 3.2}};
    struct outline o = outline_of(wall, 10);
    struct mesh mesh = cut_up(&o);
    (void)state;
    assert_true(fabs(mesh_area(&mesh) - (4 * 3.2 - 3.1 * 2.48)) < 1e-9);
    assert_int_equal(holding(&mesh, 2.011, 1.517), 0);
    assert_int_equal(holding(&mesh, 0.2, 1.517), 1);
    mesh_done(&mesh);
}

/* An outline traversed twice encloses nothing. */
static void test_walked_twice(void **state)
{
    static const double twice[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1},
                                      {0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const struct outline o = outline_of(twice, 8);
    struct mesh mesh = cut_up(&o);
    (void)state;
    assert_int_equal(mesh.cut.n_triples, 0);
    mesh_done(&mesh);
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static char *scene_of(const struct outline *o, const struct orl_frame *frame)
{
    char *text = malloc(128 + (size_t)o->n * 80);
    assert_non_null(text);
    size_t at =
        (size_t)sprintf(text, "void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon p 0 0 %u", 3 * o->n);
    for (uint32_t i = 0; i < o->n; i++) {
        const struct orl_vec3 v = orl_to_world(frame, orl_v3(o->xy[i][0], o->xy[i][1], 0));
        at += (size_t)sprintf(text + at, "\n%.17g %.17g %.17g", v.x, v.y, v.z);
    }
    return text;
}

/* Rays aimed at the sides and corners that triangles share, well within the polygon. */
static void test_no_leaks(void **state)
{
    uint64_t aimed = 0, missed = 0;
    (void)state;
    for (uint64_t seed = 0; seed < 400; seed++) {
        const struct outline o = random_outline(seed);
        const struct orl_frame frame = tilt();
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 4);
        if (fabs(outline_area(&o)) < 1e-3)
            continue;
        char *text = scene_of(&o, &frame);
        struct orl_geometry *g = scene_geometry(text);
        for (size_t i = 0; i < 30 * orl_geometry_triangles_end(g); i++) {
            if (orl_triangle_is_unused(g, i / 30))
                continue;
            const struct orl_triangle t = orl_triangle_get(g, i / 30);
            const struct orl_vec3 a = i % 3 == 0 ? t.a : t.b, b = i % 3 == 1 ? t.c : t.a;
            const double share = i % 5 == 0 ? 0 : uniform(&random);
            const struct orl_vec3 p = orl_madd(a, orl_sub(b, a), share);
            const struct orl_vec3 place = orl_to_local(&frame, orl_add(p, g->center));
            const struct orl_vec3 aside = orl_v3(uniform(&random) - 0.5, uniform(&random) - 0.5, 1);
            const struct orl_vec3 way = orl_normalize(orl_to_world(&frame, orl_neg(aside)));
            struct orl_hit hit;
            if (clear_of_outline(&o, place.x, place.y) < 1e-4)
                continue;
            aimed++;
            missed += !orl_geometry_intersect(g, orl_madd(p, way, -2), way, 10, &hit);
        }
        orl_geometry_free(g);
        free(text);
    }
    assert_true(aimed > 20000);
    assert_int_equal(missed, 0);
}

/* ---- Large ones ------------------------------------------------------------------------------ */

struct large {
    struct orl_vec3 *vertices;
    uint32_t n;
    struct orl_triangulation cut;
    int code;
};

static struct large cut_large(void (*place)(uint32_t i, uint32_t n, double ret_xy[2]), uint32_t n,
                              const char *what)
{
    struct large l = {.vertices = malloc(n * sizeof *l.vertices), .n = n};
    assert_non_null(l.vertices);
    for (uint32_t i = 0; i < n; i++) {
        double xy[2];
        place(i, n, xy);
        l.vertices[i] = orl_v3(xy[0], xy[1], 0);
    }
    const clock_t start = clock();
    l.code = orl_triangulate(&l.cut, l.vertices, n, orl_v3(0, 0, 1));
    print_message("%s: %u corners, %zu triangles, %.0f M pairs, %.3f s\n", what, n, l.cut.n_triples,
                  1e-6 * (double)l.cut.arrangement.tests,
                  (double)(clock() - start) / CLOCKS_PER_SEC);
    return l;
}

static void large_done(struct large *l)
{
    orl_triangulation_done(&l->cut);
    free(l->vertices);
}

/* A star of long thin teeth: concave, and every tooth is close to many others. */
static void place_teeth(uint32_t i, uint32_t n, double ret_xy[2])
{
    const double r = i % 2 ? 1 : 0.1, phi = 2 * ORL_PI * i / n;
    ret_xy[0] = r * cos(phi);
    ret_xy[1] = r * sin(phi);
}

/* A slanted zigzag: all edges are as long as the whole. */
static void place_slant(uint32_t i, uint32_t n, double ret_xy[2])
{
    const double x = 10.0 * (i < n / 2 ? i : n - 1 - i) / n;
    ret_xy[0] = x + (i % 2 ? 3 : 0);
    ret_xy[1] = (i % 2 ? 10 : 0) - (i < n / 2 ? 0 : 1e-4);
}

/* A star polygon of a few turns and many corners: each turn crosses the others. */
static void place_knot(uint32_t i, uint32_t n, double ret_xy[2])
{
    const double phi = 2 * ORL_PI * 7 * i / n, r = 1 + 0.5 * sin(phi * 5.0 / 7);
    ret_xy[0] = r * cos(phi);
    ret_xy[1] = r * sin(phi);
}

static void place_scribble(uint32_t i, uint32_t n, double ret_xy[2])
{
    (void)n;
    ret_xy[0] = fmod(i * 0.6180339887498949, 1);
    ret_xy[1] = fmod(i * 0.7548776662466927, 1);
}

static void test_large(void **state)
{
    struct large l = cut_large(place_teeth, ORL_LIMIT_POLYGON_VERTICES, "teeth");
    (void)state;
    assert_int_equal(l.code, 0);
    assert_int_equal(l.cut.n_triples, ORL_LIMIT_POLYGON_VERTICES - 2);
    assert_true(l.cut.arrangement.tests < 20 * ORL_LIMIT_POLYGON_VERTICES);
    large_done(&l);
    l = cut_large(place_knot, ORL_LIMIT_POLYGON_VERTICES, "knot");
    assert_int_equal(l.code, 0);
    large_done(&l);
    l = cut_large(place_slant, ORL_LIMIT_POLYGON_VERTICES, "slant");
    assert_int_equal(l.code, 0);
    /* Testing all pairs would take 2e8 tests. */
    assert_true(l.cut.arrangement.tests < 500 * ORL_LIMIT_POLYGON_VERTICES);
    large_done(&l);
    l = cut_large(place_scribble, ORL_LIMIT_POLYGON_VERTICES, "scribble");
    assert_int_equal(l.code, ORL_ERR_LIMIT);
    assert_true(l.cut.arrangement.tests < 100000000);
    large_done(&l);
    l = cut_large(place_scribble, 400, "short scribble");
    assert_int_equal(l.code, 0);
    large_done(&l);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_even_odd),     cmocka_unit_test(test_hole_wound_alike),
        cmocka_unit_test(test_walked_twice), cmocka_unit_test(test_no_leaks),
        cmocka_unit_test(test_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
