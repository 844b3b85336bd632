/*
 * Antimatter: ray hits against closed forms for holes, linings and remaining parts; light through
 * a hole against the same hole cut by hand; refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/geometry/antimatter/antimatter.h"
#include "support/scene_text.h"

/* A wall from x = 0 to .2, 4 wide and 3 high, with a round hole of radius 1 through it, about (2,
 * 1.5). */
#define WALL                                                                                       \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid plastic o 0 0 5 .2 .2 .2 0 0\n"                       \
    "!genbox w wall .2 4 3\n"
#define ROUND(kind)                                                                                \
    "void antimatter a 2 " kind " w 0 0\n"                                                         \
    "a cylinder c 0 0 7 -.1 2 1.5 .3 2 1.5 1\n"                                                    \
    "a ring d 0 0 8 -.1 2 1.5 -1 0 0 0 1\na ring e 0 0 8 .3 2 1.5 1 0 0 0 1\n"

enum { RAYS = 10000 };

static double uniform(struct orl_random *random, double low, double high)
{
    return low + (high - low) * orl_random_uniform(random);
}

/* Computes where a ray from x = -1 with direction (1, v, w) is stopped: at the wall's outer face,
 * or by the hole's lining. Returns false if it goes through. */
static bool expected_hit(double y, double z, double v, double w, double *ret_x)
{
    /* Solves |p + t d| = 1 in the hole's cross-section, t counted from the face. */
    const double py = y + v - 2, pz = z + w - 1.5;
    const double a = v * v + w * w, b = py * v + pz * w, c = py * py + pz * pz - 1;
    *ret_x = c > 0 ? 0 : (-b + sqrt(b * b - a * c)) / a;
    return *ret_x < 0.2;
}

static void test_lined(void **state)
{
    struct orl_geometry *g = scene_geometry(WALL ROUND("w"));
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_PILOT, 0);
    size_t lining = 0, through = 0;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        const double y = uniform(&random, .5, 3.5), z = uniform(&random, .2, 2.8);
        const double v = uniform(&random, -1, 1), w = uniform(&random, -1, 1);
        const struct orl_vec3 origin = orl_sub(orl_v3(-1, y, z), g->center);
        const struct orl_vec3 direction = orl_normalize(orl_v3(1, v, w));
        const struct orl_ray ray = {origin, direction};
        struct orl_hit hit, again;
        double x;
        bool found;
        /* Rays that miss the wall, or pass close to an edge, are not checked. */
        const bool expected = expected_hit(y, z, v, w, &x);
        if (y + v < 0 || y + v > 4 || z + w < 0 || z + w > 3 || fabs(x - .2) < 1e-4 ||
            fabs(hypot(y + v - 2, z + w - 1.5) - 1) < 1e-4)
            continue;
        assert_int_equal(expected, orl_geometry_intersect(g, origin, direction, INFINITY, &hit));
        assert_int_equal(expected, orl_geometry_occluded(g, origin, direction, INFINITY));
        orl_geometry_intersect_many(g, &ray, 1, false, &again, &found);
        assert_int_equal(expected, found);
        if (expected) {
            assert_true(fabs(hit.point.x + g->center.x - x) < 1e-5);
            assert_true(fabs(hit.distance - (x + 1) / direction.x) < 1e-5);
            assert_int_equal(hit.front, !(x > 0));
        }
        lining += expected && x > 0;
        through += !expected;
    }
    assert_true(through > 500);
    assert_true(lining > 100);
    orl_geometry_free(g);
}

/* A volume without a lining is invisible: rays go on to the remaining surfaces, if any. */
static void test_unlined(void **state)
{
    struct orl_geometry *g = scene_geometry(WALL ROUND("void"));
    struct orl_hit hit;
    (void)state;
    /* A straight ray passes; a slanted one enters the wall through the hole's side and leaves by
     * the back face. */
    assert_false(orl_geometry_occluded(g, orl_sub(orl_v3(-1, 2, 1.5), g->center), orl_v3(1, 0, 0),
                                       INFINITY));
    const struct orl_vec3 slanting = orl_normalize(orl_v3(.2, .3, 0));
    assert_true(orl_geometry_intersect(g, orl_sub(orl_v3(-.01, 2.9, 1.5), g->center), slanting,
                                       INFINITY, &hit));
    assert_true(fabs(hit.point.x + g->center.x - .2) < 1e-5 && !hit.front);
    orl_geometry_free(g);
}

/* Other materials remain; a volume that ends flush with the wall cuts both of its faces. */
static void test_what_stays(void **state)
{
    struct orl_geometry *g =
        scene_geometry(WALL "o polygon p 0 0 12 .1 0 0 .1 4 0 .1 4 3 .1 0 3\n"
                            "void antimatter a 1 w 0 0\n!genbox a hole .2 1 1 | xform -t 0 1 1\n");
    struct orl_hit hit;
    (void)state;
    for (int side = 0; side < 2; side++) {
        const struct orl_vec3 from = orl_sub(orl_v3(side ? 1 : -1, 1.5, 1.5), g->center);
        assert_true(orl_geometry_intersect(g, from, orl_v3(side ? -1 : 1, 0, 0), INFINITY, &hit));
        assert_true(fabs(hit.point.x + g->center.x - .1) < 1e-5);
    }
    orl_geometry_free(g);
}

/* Two overlapping volumes are one hole: the lining of one is absent inside the other. */
static void test_overlapping(void **state)
{
    struct orl_geometry *g = scene_geometry(
        WALL "void antimatter a 1 w 0 0\n!genbox a one .4 1 1 | xform -t -.1 1 1\n"
             "void antimatter b 1 w 0 0\n!genbox b two .4 1 1 | xform -t -.1 1.5 1\n");
    struct orl_hit hit;
    (void)state;
    const struct orl_vec3 from = orl_sub(orl_v3(.1, 1.2, 1.5), g->center);
    assert_true(orl_geometry_intersect(g, from, orl_v3(0, 1, 0), INFINITY, &hit));
    assert_true(fabs(hit.point.y + g->center.y - 2.5) < 1e-5);
    orl_geometry_free(g);
}

/* Holes for the windows of a whole town with one antimatter: each is small in the common bounding
 * box. */
static void test_far_apart(void **state)
{
    struct orl_geometry *g = scene_geometry(
        WALL "!genbox w far .2 4 3 | xform -t 300 200 50\nvoid antimatter a 2 void w 0 0\n"
             "!genbox a hole .4 .5 .5 | xform -t -.1 1 1\n"
             "!genbox a hole .4 .5 .5 | xform -t 299.9 201 51\n");
    (void)state;
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 place = i % 2 ? orl_v3(299, 200, 50) : orl_v3(-1, 0, 0);
        const struct orl_vec3 from = orl_add(place, orl_v3(0, i < 2 ? 1.2 : 1.7, 1.2));
        assert_int_equal(orl_geometry_occluded(g, orl_sub(from, g->center), orl_v3(1, 0, 0), 2),
                         i >= 2);
    }
    orl_geometry_free(g);
}

#define ROOM                                                                                       \
    "void plastic b 0 0 5 .3 .3 .3 0 0\nvoid glow g 0 0 4 1 1 1 0\n"                               \
    "g source sky 0 0 4 0 0 1 360\n"                                                               \
    "b polygon f 0 0 12 .2 0 0 4 0 0 4 4 0 .2 4 0\nb polygon c 0 0 12 .2 0 3 .2 4 3 4 4 3 4 0 3\n" \
    "b polygon s 0 0 12 .2 0 0 .2 0 3 4 0 3 4 0 0\nb polygon n 0 0 12 .2 4 0 4 4 0 4 4 3 .2 4 3\n" \
    "b polygon e 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0\n"
#define CUT ROOM WALL "void antimatter a 1 w 0 0\n!genbox a hole .4 2 1 | xform -t -.1 1 1\n"
#define BY_HAND                                                                                    \
    ROOM "void plastic w 0 0 5 .5 .5 .5 0 0\n"                                                     \
         "w polygon in 0 0 30 .2 0 0 .2 4 0 .2 4 3 .2 0 3 .2 0 0 "                                 \
         ".2 1 1 .2 1 2 .2 3 2 .2 3 1 .2 1 1\n"                                                    \
         "w polygon out 0 0 30 0 0 0 0 0 3 0 4 3 0 4 0 0 0 0 0 1 1 0 3 1 0 3 2 0 1 2 0 1 1\n"      \
         "w polygon l1 0 0 12 0 1 1 .2 1 1 .2 3 1 0 3 1\n"                                         \
         "w polygon l2 0 0 12 0 1 2 0 3 2 .2 3 2 .2 1 2\n"                                         \
         "w polygon l3 0 0 12 0 1 1 0 1 2 .2 1 2 .2 1 1\n"                                         \
         "w polygon l4 0 0 12 0 3 1 .2 3 1 .2 3 2 0 3 2\n"

/*
 * An even sky through a hole into a dark box: antimatter gives the same as polygons cut by hand,
 * lining included. Backward, each sensor has a standard error of about 0.5 % (4 096 samples of a
 * sky of which a tenth is seen); by maps of 20 000 photons about 1 %.
 */
static void test_light(void **state)
{
    static const struct orl_sensor sensors[] = {
        {{1, 2, .8}, {0, 0, 1}}, {{3, 1, .8}, {0, 0, 1}}, {{1, 2, 1.5}, {-1, 0, 0}}};
    (void)state;
    for (int gather = 0; gather < 2; gather++) {
        double lx[2][3];
        for (int i = 0; i < 2; i++) {
            const struct scene_run run = {.scene = i ? BY_HAND : CUT,
                                          .sensors = sensors,
                                          .n_sensors = 3,
                                          .technique = gather ? ORL_TECHNIQUE_GATHER
                                                              : ORL_TECHNIQUE_BACKWARD,
                                          .samples = 4096};
            scene_run_lx(&run, lx[i]);
        }
        for (int k = 0; k < 3; k++) {
            assert_true(lx[1][k] > 1);
            if (!(fabs(lx[0][k] / lx[1][k] - 1) < (gather ? 0.06 : 0.03)))
                fail_msg("sensor %d: %g lx by antimatter, %g by hand", k, lx[0][k], lx[1][k]);
        }
    }
}

/* The hole does not affect a pane that fills a window of the wall's outline. */
static void test_pane_beside(void **state)
{
    struct orl_geometry *g = scene_geometry(
        "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glass p 0 0 3 1 1 1\n"
        "w polygon out 0 0 30 0 0 0 0 0 3 0 4 3 0 4 0 0 0 0 0 1 1 0 3 1 0 3 2 0 1 2 0 1 1\n"
        "p polygon pane 0 0 12 0 1 1 0 3 1 0 3 2 0 1 2\n"
        "void antimatter a 1 w 0 0\na sphere s 0 0 4 0 .5 .5 .3\n");
    (void)state;
    assert_true(orl_geometry_occluded(g, orl_sub(orl_v3(-1, 2, 1.5), g->center), orl_v3(1, 0, 0),
                                      INFINITY));
    assert_false(orl_geometry_occluded(g, orl_sub(orl_v3(-1, .5, .5), g->center), orl_v3(1, 0, 0),
                                       INFINITY));
    orl_geometry_free(g);
}

/*
 * A room with a shell around it, and a hole through both that ends a tenth of a metre inside the
 * room and outside the shell. Its surfaces face into the room or, as OpenStudio writes them, out
 * of it.
 */
#define INTO " -i"
#define OUT_OF ""
#define PANE "void glass p 0 0 3 .9 .9 .9\np polygon q 0 0 12 -.1 1 1 -.1 1 2 -.1 3 2 -.1 3 1\n"
/* A thick pane: its edges face the lining and coincide with it. */
#define BLOCK "void glass p 0 0 3 .9 .9 .9\n!genbox p pane .02 2 1 | xform -t -.1 1 1\n"
/* A pane of another hole, which extends down into the floor. */
#define DOOR                                                                                       \
    "!genbox a door .4 .8 2.5 | xform -t -.3 .1 -.3\nvoid glass p 0 0 3 .9 .9 .9\n"                \
    "!genbox p pane .02 .78 2.38 | xform -t -.1 .11 -.19\n"
#define SHELL(albedo, look, cut)                                                                   \
    "void plastic w 0 0 5 " albedo " " albedo " " albedo " 0 0\nvoid glow g 0 0 4 1 1 1 0\n"       \
    "g source sky 0 0 4 0 0 1 360\n!genbox w room 4 4 3" look "\n"                                 \
    "!genbox w shell 4.4 4.4 3.4 | xform -t -.2 -.2 -.2\n"                                         \
    "void antimatter a " cut " 0 0\n!genbox a hole .4 2 1 | xform -t -.3 1 1\n"

static const struct orl_sensor in_room[] = {
    {{1, 2, .8}, {0, 0, 1}}, {{3, 1, .8}, {0, 0, 1}}, {{1, 2, 1.5}, {-1, 0, 0}}};

/* Runs the scene; returns the number of warnings with those words. */
static int shell_lx(const char *scene, enum orl_technique technique, const char *words,
                    double ret_lx[3])
{
    const struct scene_run run = {.scene = scene,
                                  .sensors = in_room,
                                  .n_sensors = 3,
                                  .technique = technique,
                                  .samples = 4096};
    struct orl_result result = scene_run(&run);
    int n = 0;
    memcpy(ret_lx, result.illuminance_lx, 3 * sizeof *ret_lx);
    for (size_t i = 0; i < result.n_warnings; i++)
        n += strstr(result.warnings[i], words) != NULL;
    orl_result_done(&result);
    return n;
}

/* Rays from the middle of the hole: sideways, where it has a lining; and straight into the room,
 * where it never has one. */
static void test_looking_out(void **state)
{
    static const struct {
        const char *text;
        bool out, lined;
    } cases[] = {
        {SHELL(".5", INTO, "1 w") PANE, false, true},
        {SHELL(".5", INTO, "1 w") BLOCK, false, true},
        {SHELL(".5", INTO, "1 w") DOOR, false, true},
        {SHELL(".5", INTO, "2 void w") PANE, false, false},
        {SHELL(".5", OUT_OF, "1 w") PANE, true, false},
        {SHELL(".5", OUT_OF, "1 w") BLOCK, true, false},
        {SHELL(".5", OUT_OF, "2 void w") PANE, false, false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_lit_scene *lit_scene = build_lit_scene(cases[i].text, NULL, NULL, NULL);
        const struct orl_geometry *g = lit_scene->geometry;
        const struct orl_vec3 from = orl_sub(orl_v3(-.05, 2, 1.5), g->center);
        struct orl_hit hit;
        assert_int_equal(orl_linings_count(g), 1);
        assert_int_equal(orl_lining_is_omitted(g, 0), cases[i].out);
        assert_true(orl_geometry_intersect(g, from, orl_v3(0, 1, 0), INFINITY, &hit));
        if (fabs(hit.point.y + g->center.y - (cases[i].lined ? 3 : 4.2)) > 1e-5)
            fail_msg("case %zu: sideways to y = %g", i, hit.point.y + g->center.y);
        assert_true(orl_geometry_intersect(g, from, orl_v3(1, 0, 0), INFINITY, &hit));
        assert_true(fabs(hit.point.x + g->center.x - 4) < 1e-5);
        orl_lit_scene_free(lit_scene);
    }
}

/*
 * With black surfaces, the light is the sky's through the pane alone, for either orientation. Each
 * value of 4 096 samples has a standard error of 0.7 %, and most are equal. Otherwise, a missing
 * lining equals "void" to the digit.
 */
static void test_light_looking_out(void **state)
{
    static const char gone[] = "is left out, because windows face it";
    double into[3], out[3];
    (void)state;
    assert_int_equal(shell_lx(SHELL("0", INTO, "1 w") PANE, ORL_TECHNIQUE_BACKWARD, gone, into), 0);
    assert_int_equal(shell_lx(SHELL("0", OUT_OF, "1 w") PANE, ORL_TECHNIQUE_BACKWARD, gone, out),
                     1);
    for (int k = 0; k < 3; k++) {
        assert_true(into[k] > 1);
        assert_true(fabs(out[k] / into[k] - 1) < 0.03);
    }
    for (int i = 0; i < 2; i++) {
        const enum orl_technique t = i ? ORL_TECHNIQUE_GATHER : ORL_TECHNIQUE_BACKWARD;
        assert_int_equal(shell_lx(SHELL(".5", OUT_OF, "1 w") PANE, t, gone, out), 1);
        assert_int_equal(shell_lx(SHELL(".5", OUT_OF, "2 void w") PANE, t, gone, into), 0);
        for (int k = 0; k < 3; k++)
            assert_true(out[k] > 1 && out[k] == into[k]);
    }
}

/* If sensors are inside matter and there is no window, the warning names the antimatter and its
 * place. */
static void test_places_in_matter(void **state)
{
    static const char words[] = "'a' ('hole.";
    double lx[3];
    (void)state;
    assert_int_equal(
        shell_lx(SHELL(".5", OUT_OF, "1 w"), ORL_TECHNIQUE_BACKWARD, "the point (1 2 0.8)", lx), 1);
    assert_int_equal(shell_lx(SHELL(".5", OUT_OF, "1 w"), ORL_TECHNIQUE_BACKWARD, words, lx), 1);
    assert_int_equal(shell_lx(SHELL(".5", OUT_OF, "2 void w"), ORL_TECHNIQUE_BACKWARD, words, lx),
                     0);
    assert_int_equal(shell_lx(SHELL(".5", INTO, "1 w"), ORL_TECHNIQUE_BACKWARD, words, lx), 0);
    assert_int_equal(shell_lx(CUT, ORL_TECHNIQUE_BACKWARD, words, lx), 0);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {WALL "void antimatter a 1 w 0 0\na polygon p 0 0 9 -1 0 0 1 0 0 1 1 0\n", "no volume"},
        {WALL "void antimatter a 1 w 0 0\n!genbox a h .4 1 1 -i | xform -t -.1 1 1\n", "no volume"},
        {WALL "void antimatter a 1 nobody 0 0\na sphere s 0 0 4 0 2 1 .3\n", "not defined"},
        {WALL "void glass p 0 0 3 1 1 1\nvoid antimatter a 2 w p 0 0\na sphere s 0 0 4 0 2 1 .3\n",
         "antimatter can cut"},
        {WALL "void antimatter a 1 w 0 0\n!genbox a h .4 1 1 | xform -t -.1 1 1\n"
              "void glass p 0 0 3 1 1 1\np polygon q 0 0 12 0 1 1 0 2 1 0 2 2 0 1 2\n",
         "which antimatter cuts"},
        {WALL "void antimatter a 1 w 0 1 .5\na sphere s 0 0 4 0 2 1 .3\n", "antimatter"},
    };
    static const struct orl_sensor sensor = {{1, 2, .8}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct scene_run run = {.scene = cases[i].text, .sensors = &sensor, .n_sensors = 1};
        struct orl_error err = {0};
        assert_int_not_equal(scene_run_fails(&run, &err), 0);
        if (!strstr(err.message, cases[i].says) && !strstr(err.primitive, cases[i].says))
            fail_msg("case %zu: %s (%s)", i, err.message, err.primitive);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lined),
        cmocka_unit_test(test_unlined),
        cmocka_unit_test(test_what_stays),
        cmocka_unit_test(test_overlapping),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_pane_beside),
        cmocka_unit_test(test_far_apart),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_looking_out),
        cmocka_unit_test(test_light_looking_out),
        cmocka_unit_test(test_places_in_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
