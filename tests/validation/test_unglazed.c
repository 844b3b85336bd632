/*
 * Unglazed openings as photon ports: which are detected, and the light of small ones in deep rooms.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/scene_text.h"

#define SKY "void glow l 0 0 4 10 10 10 0\nl source sky 0 0 4 0 0 1 360\n"
#define BOX                                                                                        \
    "w polygon floor 0 0 12 0 0 0 8 0 0 8 12 0 0 12 0\n"                                           \
    "w polygon ceiling 0 0 12 0 0 3 0 12 3 8 12 3 8 0 3\n"                                         \
    "w polygon west 0 0 12 0 0 0 0 12 0 0 12 3 0 0 3\n"                                            \
    "w polygon east 0 0 12 8 0 0 8 0 3 8 12 3 8 12 0\n"                                            \
    "w polygon north 0 0 12 0 12 0 8 12 0 8 12 3 0 12 3\n"
#define BLACK "void plastic w 0 0 5 0 0 0 0 0\n" BOX
/* A wall with a hole (x 3.9 to 4.2, z 1.5 to 1.8) as one polygon, and as four rectangles. */
#define HOLE                                                                                       \
    "w polygon south 0 0 30 0 0 0 0 0 3 8 0 3 8 0 0 0 0 0 3.9 0 1.5 4.2 0 1.5 4.2 0 1.8 3.9 0 "    \
    "1.8 "                                                                                         \
    "3.9 0 1.5\n"
#define FOUR                                                                                       \
    "w polygon a 0 0 12 0 0 0 3.9 0 0 3.9 0 3 0 0 3\nw polygon b 0 0 12 4.2 0 0 8 0 0 8 0 3 4.2 "  \
    "0 3\nw polygon c 0 0 12 3.9 0 0 4.2 0 0 4.2 0 1.5 3.9 0 1.5\n"                                \
    "w polygon d 0 0 12 3.9 0 1.8 4.2 0 1.8 4.2 0 3 3.9 0 3\n"
#define GLASS "void glass p 0 0 3 .9 .9 .9\n"

struct found {
    const char *name, *text;
    size_t openings, ports;
};

static void test_found(void **state)
{
    static const struct found cases[] = {
        {"hole", BLACK HOLE SKY, 1, 1},
        {"four rectangles", BLACK FOUR SKY, 1, 1},
        {"glazed",
         BLACK HOLE GLASS "p polygon p 0 0 12 3.9 0 1.5 3.9 0 1.8 4.2 0 1.8 4.2 0 1.5\n" SKY, 0, 1},
        {"half glazed",
         BLACK HOLE GLASS "p polygon p 0 0 12 3.9 0 1.5 3.9 0 1.8 4.05 0 1.8 4.05 0 1.5\n" SKY, 1,
         2},
        {"pane set back", /* the pane is a port itself */
         BLACK HOLE GLASS
         "p polygon p 0 0 12 3.8 .05 1.4 3.8 .05 1.9 4.1 .05 1.9 4.1 .05 1.4\n" SKY,
         0, 1},
        {"pane behind a frame",
         BLACK HOLE GLASS "p polygon p 0 0 12 3.8 .05 1.4 3.8 .05 1.9 4.3 .05 1.9 4.3 .05 1.4\n"
                          "w polygon a 0 0 12 3.9 0 1.5 3.9 0 1.8 3.9 .05 1.8 3.9 .05 1.5\n"
                          "w polygon b 0 0 12 4.2 0 1.5 4.2 .05 1.5 4.2 .05 1.8 4.2 0 1.8\n"
                          "w polygon c 0 0 12 3.9 0 1.8 4.2 0 1.8 4.2 .05 1.8 3.9 .05 1.8\n"
                          "w polygon d 0 0 12 3.9 0 1.5 3.9 .05 1.5 4.2 .05 1.5 4.2 0 1.5\n" SKY,
         0, 1},
        {"round pane in the hole", /* the free part beside it is no rectangle */
         BLACK HOLE GLASS "p ring p 0 0 8 4.05 0 1.65 0 -1 0 0 .15\n" SKY, 0, 0},
        {"shutter in the hole", BLACK HOLE "w ring p 0 0 8 4.05 0 1.65 0 -1 0 0 .3\n" SKY, 0, 0},
        {"cabinet of glass inside",
         BLACK HOLE GLASS "p polygon p 0 0 12 3 9 0 3 9 2.9 5 9 2.9 5 9 0\n" SKY, 1, 1},
        {"window opposite",
         "void plastic w 0 0 5 0 0 0 0 0\n" GLASS "w polygon floor 0 0 12 0 0 0 8 0 0 8 6 0 0 6 0\n"
         "w polygon ceiling 0 0 12 0 0 3 0 6 3 8 6 3 8 0 3\n"
         "w polygon west 0 0 12 0 0 0 0 6 0 0 6 3 0 0 3\n"
         "w polygon east 0 0 12 8 0 0 8 0 3 8 6 3 8 6 0\n"
         "p polygon north 0 0 12 0 6 0 8 6 0 8 6 3 0 6 3\n" HOLE SKY,
         1, 2},
        {"courtyard", /* its windows are ports themselves */
         "void plastic w 0 0 5 .4 .4 .4 0 0\n" GLASS
         "w polygon roof 0 0 30 0 0 3 12 0 3 12 12 3 0 12 3 0 0 3 4 4 3 4 8 3 8 8 3 8 4 3 4 4 3\n"
         "w polygon floor 0 0 12 0 0 0 0 12 0 12 12 0 12 0 0\n"
         "w polygon a 0 0 12 0 0 0 12 0 0 12 0 3 0 0 3\nw polygon b 0 0 12 0 12 0 0 12 3 12 12 3 "
         "12 "
         "12 0\nw polygon c 0 0 12 0 0 0 0 0 3 0 12 3 0 12 0\n"
         "w polygon d 0 0 12 12 0 0 12 12 0 12 12 3 12 0 3\n"
         "p polygon e 0 0 12 4 4 0 8 4 0 8 4 3 4 4 3\np polygon f 0 0 12 4 8 0 4 8 3 8 8 3 8 8 0\n"
         "w polygon g 0 0 12 4 4 0 4 4 3 4 8 3 4 8 0\nw polygon h 0 0 12 8 4 0 8 8 0 8 8 3 8 4 "
         "3\n" SKY,
         0, 2},
        {"diamond", /* its rectangle is not completely free */
         BLACK "w polygon south 0 0 30 0 0 0 0 0 3 8 0 3 8 0 0 0 0 0 4 0 1 5 0 1.5 4 0 2 3 0 1.5 4 "
               "0 1\n" SKY,
         0, 0},
        {"partition", /* indoors */
         BLACK HOLE
         "w polygon m 0 0 30 0 6 0 0 6 3 8 6 3 8 6 0 0 6 0 3 6 0 4 6 0 4 6 2 3 6 2 3 6 0\n" SKY,
         1, 1},
        {"fence", /* the sky is on both sides */
         "void plastic w 0 0 5 .4 .4 .4 0 0\nw polygon a 0 0 12 0 0 0 .1 0 0 .1 0 2 0 0 2\n"
         "w polygon b 0 0 12 .2 0 0 .3 0 0 .3 0 2 .2 0 2\n"
         "w polygon c 0 0 12 .1 0 1 .2 0 1 .2 0 1.1 .1 0 1.1\n"
         "w polygon d 0 0 12 .1 0 1.9 .2 0 1.9 .2 0 2 .1 0 2\n" SKY,
         0, 0},
    };
    struct orl_thread_pool *const pool = orl_thread_pool_start(1);
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_lit_scene *const lit_scene = build_lit_scene(cases[i].text, NULL, NULL, pool);
        print_message("%s: %zu openings, %zu ports\n", cases[i].name, lit_scene->scene->n_openings,
                      lit_scene->n_ports);
        assert_int_equal(lit_scene->scene->n_openings, cases[i].openings);
        assert_int_equal(lit_scene->n_ports, cases[i].ports);
        orl_lit_scene_free(lit_scene);
    }
    orl_thread_pool_stop(pool);
}

/* The opening is also detected in a room that is rotated about the vertical by odd angles and away
 * from the origin. */
static void test_turned(void **state)
{
    static const double angles_deg[] = {13.7, 45, 199.3};
    struct orl_thread_pool *const pool = orl_thread_pool_start(1);
    (void)state;
    for (size_t i = 0; i < sizeof angles_deg / sizeof *angles_deg; i++) {
        static const double corners[][4][3] = {
            {{0, 0, 0}, {8, 0, 0}, {8, 12, 0}, {0, 12, 0}},
            {{0, 0, 3}, {0, 12, 3}, {8, 12, 3}, {8, 0, 3}},
            {{0, 0, 0}, {0, 12, 0}, {0, 12, 3}, {0, 0, 3}},
            {{8, 0, 0}, {8, 0, 3}, {8, 12, 3}, {8, 12, 0}},
            {{0, 12, 0}, {8, 12, 0}, {8, 12, 3}, {0, 12, 3}},
            {{0, 0, 0}, {3.9, 0, 0}, {3.9, 0, 3}, {0, 0, 3}},
            {{4.2, 0, 0}, {8, 0, 0}, {8, 0, 3}, {4.2, 0, 3}},
            {{3.9, 0, 0}, {4.2, 0, 0}, {4.2, 0, 1.5}, {3.9, 0, 1.5}},
            {{3.9, 0, 1.8}, {4.2, 0, 1.8}, {4.2, 0, 3}, {3.9, 0, 3}}};
        char text[4096] = "void plastic w 0 0 5 0 0 0 0 0\n" SKY;
        size_t n = strlen(text);
        const double c = cos(angles_deg[i] * ORL_DEG_TO_RAD),
                     s = sin(angles_deg[i] * ORL_DEG_TO_RAD);
        for (size_t k = 0; k < sizeof corners / sizeof *corners; k++) {
            n += (size_t)snprintf(text + n, sizeof text - n, "w polygon s%zu 0 0 12", k);
            for (int j = 0; j < 4; j++)
                n += (size_t)snprintf(text + n, sizeof text - n, " %.9f %.9f %g",
                                      250 + c * corners[k][j][0] - s * corners[k][j][1],
                                      -90 + s * corners[k][j][0] + c * corners[k][j][1],
                                      corners[k][j][2]);
            n += (size_t)snprintf(text + n, sizeof text - n, "\n");
        }
        struct orl_lit_scene *const lit_scene = build_lit_scene(text, NULL, NULL, pool);
        assert_int_equal(lit_scene->n_ports, 1);
        orl_lit_scene_free(lit_scene);
    }
    orl_thread_pool_stop(pool);
}

/* Returns irradiance over radiance at a point, by a rectangle in the plane y = 0, for a normal
 * along y (towards it, 0) or up (2): the sum over its edges (Lambert 1760; Baum, Rushmeier and
 * Winget 1989). */
static double seen_through(struct orl_vec3 p, struct orl_vec3 normal)
{
    static const double x[] = {3.9, 4.2, 4.2, 3.9}, z[] = {1.5, 1.5, 1.8, 1.8};
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 a = orl_sub(orl_v3(x[i], 0, z[i]), p);
        const struct orl_vec3 b = orl_sub(orl_v3(x[(i + 1) % 4], 0, z[(i + 1) % 4]), p);
        const struct orl_vec3 cross = orl_cross(a, b);
        const double angle = atan2(orl_length(cross), orl_dot(a, b));
        sum += 0.5 * angle * orl_dot(normal, orl_normalize(cross));
    }
    return fabs(sum);
}

/* Cosine-sampled rays represent up to this share of the hole's light, and almost none of them hits
 * the hole. */
static const double by_chance = 0.005;

/* The hole fills 1/7000 of the hemisphere. Before it was a port, values were off by 50 to 100 %. */
static void test_deep_room(void **state)
{
    static const struct orl_sensor sensors[] = {{{4, 3.6, .8}, {0, 0, 1}},
                                                {{4.4, 10.2, .8}, {0, 0, 1}},
                                                {{4.2, 7.8, 1.2}, {0, -1, 0}},
                                                {{1.6, 8.4, .3}, {0, -1, 0}}};
    enum { SENSORS = sizeof sensors / sizeof *sensors };
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                    ORL_TECHNIQUE_DIRECT,
                                                    ORL_TECHNIQUE_PRECOMPUTED};
    (void)state;
    for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = BLACK HOLE SKY,
                                                            .sensors = sensors,
                                                            .n_sensors = SENSORS,
                                                            .seed = 3,
                                                            .technique = techniques[t],
                                                            .by_plan = true,
                                                            .global = 20000});
        for (size_t i = 0; i < SENSORS; i++) {
            const double truth = 1790 * seen_through(sensors[i].position, sensors[i].direction);
            print_message("%s, sensor %zu: %.4f +- %.2g, truth %.4f\n",
                          orl_technique_name(techniques[t]), i, r.illuminance_lx[i],
                          r.standard_error_lx[i], truth);
            assert_true(fabs(r.illuminance_lx[i] - truth) <
                        4 * r.standard_error_lx[i] + by_chance * truth);
            assert_true(r.standard_error_lx[i] < 0.2 * truth);
        }
        orl_result_done(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_found), cmocka_unit_test(test_turned),
                                       cmocka_unit_test(test_deep_room)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
