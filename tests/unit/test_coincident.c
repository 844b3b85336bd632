/*
 * Coincident polygons: ray hits follow Radiance's rule, point by point and from either side, for
 * thousands of random stacks; and the warnings about them.
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

#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "support/scene_text.h"

/* Materials in order of definition. */
#define MATERIALS                                                                                  \
    "void glass pane 0 0 3 .9 .9 .9\nvoid plastic early 0 0 5 .5 .5 .5 0 0\n"                      \
    "void trans sheet 0 0 7 .5 .5 .5 0 0 .5 0\nvoid plastic late 0 0 5 .3 .3 .3 0 0\n"             \
    "void light lamp 0 0 3 1 1 1\n"

enum { KINDS = 6, HEAPS = 2000, MOST = 4, CORNERS = 12, POINTS = 24 };

static const struct {
    const char *name;
    int class, order;
} kinds[KINDS] = {{"void", 0, 0},  {"pane", 1, 1}, {"early", 2, 2},
                  {"sheet", 1, 3}, {"late", 2, 4}, {"lamp", 2, 5}};

struct shape {
    double xy[CORNERS][2];
    int n, kind;
    bool up;
};

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

static struct orl_lit_scene *load(const char *text)
{
    return build_lit_scene(text, NULL, NULL, NULL);
}

/* ---- Random stacks --------------------------------------------------------------------------- */

static double area_of(const struct shape *s)
{
    double sum = 0;
    for (int i = 0; i < s->n; i++) {
        const double *a = s->xy[i], *b = s->xy[(i + 1) % s->n];
        sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    return sum;
}

/* Returns a star, a rectangle with integer corners (which shares edges and corners with others),
 * or a copy of the previous shape. */
static struct shape random_shape(struct orl_random *random, const struct shape *before)
{
    struct shape s = {.n = 4};
    const double which = uniform(random);
    if (which < 0.4) {
        const double x = floor(4 * uniform(random)), y = floor(4 * uniform(random));
        const double w = 1 + floor(3 * uniform(random)), h = 1 + floor(3 * uniform(random));
        const double corners[4][2] = {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
        memcpy(s.xy, corners, sizeof corners);
    } else if (which < 0.5 && before) {
        s = *before;
    } else {
        const double x = 4 * uniform(random), y = 4 * uniform(random);
        s.n = 3 + (int)(uniform(random) * (CORNERS - 3));
        for (int i = 0; i < s.n; i++) {
            const double r = 0.5 + 2 * uniform(random), phi = 2 * ORL_PI * i / s.n;
            s.xy[i][0] = x + r * cos(phi);
            s.xy[i][1] = y + r * sin(phi);
        }
    }
    s.kind = (int)(uniform(random) * KINDS);
    s.up = uniform(random) < 0.5;
    return s;
}

static struct orl_frame tilt(void)
{
    return orl_frame_about(orl_normalize(orl_v3(0.3, 0.2, 0.9)));
}

static void write_heap(const struct shape *shapes, int n, char *text)
{
    const struct orl_frame frame = tilt();
    size_t at = (size_t)sprintf(text, "%s", MATERIALS);
    for (int i = 0; i < n; i++) {
        const struct shape *s = &shapes[i];
        at += (size_t)sprintf(text + at, "%s polygon p%d 0 0 %d", kinds[s->kind].name, i, 3 * s->n);
        for (int k = 0; k < s->n; k++) {
            const double *xy = s->xy[s->up == (area_of(s) > 0) ? k : s->n - 1 - k];
            const struct orl_vec3 v = orl_to_world(&frame, orl_v3(xy[0], xy[1], 3));
            at += (size_t)sprintf(text + at, " %.17g %.17g %.17g", v.x, v.y, v.z);
        }
        at += (size_t)sprintf(text + at, "\n");
    }
}

/* Returns true if the point is inside; sets *near if it is too close to the outline to decide. */
static bool is_in(const struct shape *s, const double p[2], bool *near)
{
    bool in = false;
    for (int i = 0; i < s->n; i++) {
        const double *a = s->xy[i], *b = s->xy[(i + 1) % s->n];
        const double dx = b[0] - a[0], dy = b[1] - a[1], l2 = dx * dx + dy * dy;
        const double t = fmin(fmax(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / l2, 0), 1);
        *near |= hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy) < 1e-4;
        if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / dy * dx)
            in = !in;
    }
    return in;
}

/* Returns the index of the shape that a ray from above or below hits there, or -1. */
static int expected(const struct shape *shapes, int n, const double p[2], bool from_above,
                    bool *near)
{
    int best = -1;
    for (int i = 0; i < n; i++) {
        if (!is_in(&shapes[i], p, near) || kinds[shapes[i].kind].class == 0)
            continue; /* surfaces of void are absent */
        const int mine[3] = {kinds[shapes[i].kind].class, shapes[i].up == from_above,
                             kinds[shapes[i].kind].order};
        int better = best < 0;
        for (int k = 0; k < 3 && !better && best >= 0; k++) {
            const int theirs[3] = {kinds[shapes[best].kind].class, shapes[best].up == from_above,
                                   kinds[shapes[best].kind].order};
            if (mine[k] < theirs[k])
                break;
            better = mine[k] > theirs[k] || k == 2; /* equal precedence: the later surface */
        }
        if (better)
            best = i;
    }
    return best;
}

static void check_point(const struct orl_lit_scene *lit_scene, const struct shape *shapes, int n,
                        const double p[2], bool from_above, struct orl_random *random)
{
    const struct orl_frame frame = tilt();
    const struct orl_geometry *g = lit_scene->geometry;
    const double down = from_above ? -1 : 1;
    const struct orl_vec3 way = orl_normalize(orl_to_world(
        &frame, orl_v3(uniform(random) - 0.5, uniform(random) - 0.5, down * uniform(random))));
    const struct orl_vec3 place = orl_sub(orl_to_world(&frame, orl_v3(p[0], p[1], 3)), g->center);
    bool near = false;
    const int who = expected(shapes, n, p, from_above, &near);
    struct orl_hit hit;
    if (near || fabs(orl_dot(way, frame.n)) < 0.05)
        return;
    const bool met = orl_geometry_intersect(g, orl_madd(place, way, -3), way, 5, &hit);
    assert_int_equal(met, who >= 0);
    if (!met)
        return;
    const char *name = orl_scene_name_of(lit_scene->scene, hit.facet);
    if (atoi(name + 1) != who)
        fail_msg("a ray meets %s, not p%d", name, who);
    assert_int_equal(hit.front, shapes[who].up == from_above);
}

static void test_heaps(void **state)
{
    static char text[8192];
    (void)state;
    for (uint64_t seed = 0; seed < HEAPS; seed++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 5);
        struct shape shapes[MOST];
        const int n = 2 + (int)(uniform(&random) * (MOST - 1));
        for (int i = 0; i < n; i++)
            shapes[i] = random_shape(&random, i > 0 ? &shapes[i - 1] : NULL);
        write_heap(shapes, n, text);
        struct orl_lit_scene *lit_scene = load(text);
        for (int i = 0; i < POINTS; i++) {
            const double p[2] = {8 * uniform(&random) - 1, 8 * uniform(&random) - 1};
            check_point(lit_scene, shapes, n, p, i % 2 == 0, &random);
        }
        orl_lit_scene_free(lit_scene);
    }
}

/* ---- Warnings -------------------------------------------------------------------------------- */

/* Returns the number of warnings that contain the words. */
static int said(const struct orl_lit_scene *lit_scene, const char *words)
{
    int n = 0;
    for (size_t i = 0; i < lit_scene->scene->parsed_scene.n_warnings; i++)
        n += strstr(lit_scene->scene->parsed_scene.warnings[i], words) != NULL;
    return n;
}

static void test_words(void **state)
{
    struct orl_lit_scene *lit_scene =
        load(MATERIALS "early polygon ground 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
                       "pane polygon window 0 0 12 1 1 0 2 1 0 2 2 0 1 2 0\n"
                       "late polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
                       "late polygon high 0 0 12 0 0 .001 4 0 .001 4 4 .001 0 4 .001\n"
                       "late polygon beside 0 0 12 9 0 0 12 0 0 12 4 0 9 4 0\n"
                       "early polygon below 0 0 12 0 0 0 0 4 0 4 4 0 4 0 0\n");
    (void)state;
    assert_int_equal(said(lit_scene, "there, as in Radiance"), 3);
    assert_int_equal(said(lit_scene, "as in Radiance: 1 more pair"), 1);
    assert_int_equal(said(lit_scene,
                          "polygon floor at scene.rad:8 and polygon below at scene.rad:11 "
                          "coincide and face opposite ways"),
                     1);
    assert_int_equal(said(lit_scene, "face opposite ways"), 1);
    assert_int_equal(said(lit_scene, "polygon ground at scene.rad:6 coincides with polygon "
                                     "floor at scene.rad:8: light hits floor"),
                     1);
    assert_int_equal(said(lit_scene, "polygon window at scene.rad:7 coincides entirely with"), 2);
    /* The ground around the floor remains, the window does not; surfaces that face the other way
     * stay. */
    assert_int_equal(lit_scene->scene->parsed_scene.n_surfaces, 5);
    assert_true(fabs(lit_scene->geometry->facets[0].area - (324 - 16)) < 1e-6);
    assert_int_equal(lit_scene->scene->parsed_scene.n_opposed, 2);
    orl_lit_scene_free(lit_scene);
}

/* No warnings: walls of one paint back to back, tiles side by side, a box on a floor. */
static void test_nothing_to_say(void **state)
{
    static char text[1 << 16];
    size_t at = (size_t)sprintf(text, "%s!genbox early box 1 1 1\n", MATERIALS);
    (void)state;
    for (int i = 0; i < 400; i++) {
        const int x = i % 20, y = i / 20;
        at += (size_t)sprintf(text + at, "%s polygon t%d 0 0 12 %d %d 0 %d %d 0 %d %d 0 %d %d 0\n",
                              i % 2 ? "late" : "early", i, x, y, x + 1, y, x + 1, y + 1, x, y + 1);
    }
    struct orl_lit_scene *lit_scene = load(text);
    assert_int_equal(lit_scene->scene->parsed_scene.n_warnings, 0);
    assert_int_equal(lit_scene->scene->parsed_scene.n_surfaces, 406);
    orl_lit_scene_free(lit_scene);
}

/* A ground below a floor of many tiles gives few warnings, in a short time. */
static void test_many(void **state)
{
    enum { SIDE = 70 };
    char *text = malloc(SIDE * SIDE * 2 * 100 + 1000);
    (void)state;
    assert_non_null(text);
    size_t at = (size_t)sprintf(
        text, "%searly polygon ground 0 0 12 -9 -9 0 99 -9 0 99 99 0 -9 99 0\n", MATERIALS);
    for (int i = 0; i < 2 * SIDE * SIDE; i++) {
        const int x = i / 2 % SIDE, y = i / 2 / SIDE, half = i % 2;
        at += (size_t)sprintf(text + at, "late polygon t%d 0 0 9 %d %d 0 %d %d 0 %d %d 0\n", i, x,
                              y, x + 1, y + half, half ? x : x + 1, y + 1);
    }
    const clock_t start = clock();
    struct orl_lit_scene *lit_scene = load(text);
    print_message("%d tiles on a ground: %.2f s\n", 2 * SIDE * SIDE,
                  (double)(clock() - start) / CLOCKS_PER_SEC);
    assert_int_equal(said(lit_scene, "polygon ground"), 3);
    assert_int_equal(said(lit_scene, "9797 more pairs"), 1);
    assert_int_equal(lit_scene->scene->parsed_scene.n_warnings, 4);
    assert_true(fabs(lit_scene->geometry->facets[0].area - (108.0 * 108 - SIDE * SIDE)) < 1e-3);
    orl_lit_scene_free(lit_scene);
    free(text);
}

#define POSTS 12

/* Rails and posts of one paint, or of one paint under two names: one line for all of them. */
static void test_one_paint(void **state)
{
    static char text[1 << 14];
    size_t at = (size_t)sprintf(text,
                                "%svoid plastic again 0 0 5 .3 .3 .3 0 0\n"
                                "late polygon rail 0 0 12 0 0 0 99 0 0 99 1 0 0 1 0\n",
                                MATERIALS);
    (void)state;
    for (int i = 0; i < POSTS; i++)
        at += (size_t)sprintf(text + at, "%s polygon p%d 0 0 12 %d 0 0 %d 0 0 %d 9 0 %d 9 0\n",
                              i % 2 ? "late" : "again", i, 5 * i, 5 * i + 1, 5 * i + 1, 5 * i);
    struct orl_lit_scene *lit_scene = load(text);
    assert_int_equal(lit_scene->scene->parsed_scene.n_warnings, 1);
    assert_int_equal(said(lit_scene, "does not matter which one light hits: 12 pairs"), 1);
    orl_lit_scene_free(lit_scene);
}

/* Surfaces that face opposite ways give a warning if their paints or their sides differ. */
static void test_opposed(void **state)
{
    static const struct {
        const char *below;
        int told;
    } cases[] = {{"late", 1}, {"early", 0}, {"sheet", 0}, {"lamp", 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 MATERIALS "early polygon floor 0 0 12 0 0 0 9 0 0 9 9 0 0 9 0\n"
                           "%s polygon under 0 0 12 1 1 0 1 2 0 2 2 0 2 1 0\n",
                 cases[i].below);
        struct orl_lit_scene *lit_scene = load(text);
        assert_int_equal(said(lit_scene, "face opposite ways"), cases[i].told);
        orl_lit_scene_free(lit_scene);
    }
}

/* Curved surfaces, rings and proxies are not resolved: a warning says so, but not for adjacent
 * ones. */
static void test_open(void **state)
{
    static const struct {
        const char *pair;
        int open, alike;
    } cases[] = {
        {"early sphere a 0 0 4 1 2 3 .5\nlate sphere b 0 0 4 1 2 3 .5\n", 1, 0},
        {"early sphere a 0 0 4 1 2 3 .5\nlate bubble b 0 0 4 1 2 3 .5\n", 1, 0},
        {"early sphere a 0 0 4 1 2 3 .5\nearly sphere b 0 0 4 1 2 3 .5\n", 0, 1},
        {"early sphere a 0 0 4 1 2 3 .5\nlate sphere b 0 0 4 1 2 3 .51\n", 0, 0},
        {"lamp sphere a 0 0 4 1 2 3 .5\nlamp sphere b 0 0 4 1 2 3 .5\n", 1, 0},
        {"early cylinder a 0 0 7 0 0 0 1 2 4 .2\nlate tube b 0 0 7 2 4 8 .5 1 2 .2\n", 1, 0},
        {"early cylinder a 0 0 7 0 0 0 1 2 4 .2\nlate cylinder b 0 0 7 2 4 8 1 2 4 .2\n", 0, 0},
        {"early cylinder a 0 0 7 0 0 0 1 2 4 .2\nlate cylinder b 0 0 7 0 0 1 1 2 5 .2\n", 0, 0},
        {"early cone a 0 0 8 0 0 0 0 0 1 .2 .1\nlate cup b 0 0 8 0 0 1 0 0 0 .1 .2\n", 1, 0},
        {"early cone a 0 0 8 0 0 0 0 0 1 .2 .1\nlate cup b 0 0 8 0 0 1 0 0 0 .2 .1\n", 0, 0},
        {"early polygon a 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
         "lamp ring b 0 0 8 2 2 0 0 0 -1 0 .3\n",
         1, 0},
        {"early polygon a 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
         "lamp ring b 0 0 8 -.3 2 0 0 0 -1 0 .3\n",
         0, 0},
        {"early ring a 0 0 8 2 2 0 0 0 1 .3 .5\nlate ring b 0 0 8 2 2 0 0 0 -1 0 .3\n", 0, 0},
        {"early ring a 0 0 8 2 2 0 0 0 1 .2 .5\nlate ring b 0 0 8 2 2 0 0 0 -1 0 .3\n", 1, 0},
        {"early ring a 0 0 8 2 2 0 0 0 1 .2 .5\nearly ring b 0 0 8 2 2 0 0 0 -1 0 .3\n", 0, 1},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text, "%s%s", MATERIALS, cases[i].pair);
        struct orl_lit_scene *lit_scene = load(text);
        if (said(lit_scene, "light may hit either") != cases[i].open ||
            said(lit_scene, "does not matter which one") != cases[i].alike ||
            (int)lit_scene->scene->parsed_scene.n_warnings != cases[i].open + cases[i].alike)
            fail_msg("of %s %zu warnings: %s", cases[i].pair,
                     lit_scene->scene->parsed_scene.n_warnings,
                     lit_scene->scene->parsed_scene.n_warnings
                         ? lit_scene->scene->parsed_scene.warnings[0]
                         : "none");
        orl_lit_scene_free(lit_scene);
    }
}

/* Two panes closer than the resolution of surfaces act as one pane, with a warning. Exact
 * duplicates, which Radiance also takes as one, give none. */
static void test_double_panes(void **state)
{
    static const struct {
        const char *second;
        int told, alike;
    } cases[] = {
        {"12 0 0 1e-4 4 0 1e-4 4 4 1e-4 0 4 1e-4", 1, 0},
        {"12 0 0 1e-4 0 4 1e-4 4 4 1e-4 4 0 1e-4", 1, 0}, /* faces the other way */
        {"12 0 0 0 4 0 0 4 4 0 0 4 0", 0, 1},
        {"12 0 0 .01 4 0 .01 4 4 .01 0 4 .01", 0, 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "%svoid glass clear 0 0 3 .9 .9 .9\nlate ring ground 0 0 8 0 0 -9 0 0 1 0 1000\n"
                 "clear polygon a 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\nclear polygon b 0 0 %s\n",
                 MATERIALS, cases[i].second);
        struct orl_lit_scene *lit_scene = load(text);
        if (said(lit_scene,
                 "are panes only 0.0001 apart, which count as one in a scene of this size: light "
                 "passes through only one; if both are intended, move them at least 0.001 "
                 "apart") != cases[i].told ||
            said(lit_scene, "does not matter which one") != cases[i].alike)
            fail_msg("case %zu: %zu warnings: %s", i, lit_scene->scene->parsed_scene.n_warnings,
                     lit_scene->scene->parsed_scene.n_warnings
                         ? lit_scene->scene->parsed_scene.warnings[0]
                         : "none");
        orl_lit_scene_free(lit_scene);
    }
}

/* Proxies: two that face the same way give a warning; a pair, or a proxy with the geometry it
 * stands for, does not. */
static void test_proxies(void **state)
{
    static const char square[] = "0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n",
                      turned[] = "0 0 12 0 0 0 0 4 0 4 4 0 4 0 0\n";
    static const struct {
        const char *kinds[2], *corners;
        int told;
    } cases[] = {{{"proxy", "other"}, square, 1},
                 {{"proxy", "other"}, turned, 0},
                 {{"proxy", "early"}, square, 0}};
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.1, xml);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 MATERIALS "void BSDF proxy 6 .1 x.xml 0 1 0 . 0 0\n"
                           "void BSDF other 6 .2 x.xml 0 1 0 . 0 0\n%s polygon a %s%s polygon b "
                           "%s",
                 cases[i].kinds[0], square, cases[i].kinds[1], cases[i].corners);
        struct orl_lit_scene *lit_scene = build_lit_scene(text, "x.xml", xml, NULL);
        assert_int_equal(said(lit_scene, "light may hit either"), cases[i].told);
        orl_lit_scene_free(lit_scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_heaps),          cmocka_unit_test(test_words),
        cmocka_unit_test(test_nothing_to_say), cmocka_unit_test(test_one_paint),
        cmocka_unit_test(test_opposed),        cmocka_unit_test(test_open),
        cmocka_unit_test(test_proxies),        cmocka_unit_test(test_many),
        cmocka_unit_test(test_double_panes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
