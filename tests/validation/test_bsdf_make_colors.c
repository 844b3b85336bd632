/*
 * Tensor trees in colour: red, green and blue compared with closed forms, with matrices of the same
 * panel, and as panes of a room. Tolerances of cells: colours of merged cells differ by at most the
 * cull's 5 % of a value, those of separate cells by at most a quarter of it; shares in a file have
 * 16 bits.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf/bsdf_convert.h>

#include "fixtures/bsdf_ask.h"
#include "support/extent.h"
#include "support/panels.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"

enum { RED, GREEN, BLUE, COLORS };

static const double square[4] = {0, 1, 0, 1};
static const enum orl_bsdf_basis bases[] = {ORL_BSDF_TENSOR_TREE_3, ORL_BSDF_TENSOR_TREE_4,
                                            ORL_BSDF_KLEMS_FULL};

/* A pane with normal transmittances of .2, .5 and .8. */
static const double passes[COLORS] = {0.2177, 0.5427, 0.8659};
#define PANE "void glass p 0 0 3 .2177 .5427 .8659\n"
/* Diffuse transmission of .54, .36 and .18. */
#define SHEET "void trans p 0 0 7 .9 .6 .3 0 0 .6 0\n"
#define LYING "p polygon f 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
/* Facets facing left and right with equal luminance. */
static const char roof[] =
    "void plastic a 0 0 5 .9 .1 .1 0 0\nvoid plastic b 0 0 5 .1 .4123 .1 0 0\n"
    "a polygon left 0 0 12 0 0 -.5 .5 0 0 .5 1 0 0 1 -.5\n"
    "b polygon right 0 0 12 .5 0 0 1 0 -.5 1 1 -.5 .5 1 0\n";

static double of(struct orl_rgb color, int channel)
{
    return channel == RED ? color.r : channel == GREEN ? color.g : color.b;
}

static struct orl_bsdf *read_panel(const struct panel *panel)
{
    struct orl_bsdf_make_result made = panel_make(panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    orl_bsdf_make_result_done(&made);
    return bsdf;
}

/* ---- Closed forms ---------------------------------------------------------------------------- */

/* Compared at the middles of the tree's rings. Stratified points find a ring's mean to 1 %. */
static void a_filter_is_fresnels_in_every_colour(void **state)
{
    enum { RINGS = 8 };
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct panel panel = {
            .text = PANE LYING, .basis = bases[i], .cell = square, .color = true, .paths = 1024};
        struct orl_bsdf *bsdf = read_panel(&panel);
        struct orl_bsdf_info info;
        orl_bsdf_describe(bsdf, &info);
        assert_true(info.colored && info.out_of_gamut == 0);
        for (int ring = 0; ring < RINGS - 1; ring++) {
            const double sine = (ring + 0.5) / RINGS, cosine = sqrt(1 - sine * sine);
            const struct orl_vec3 in = direction(sine * cos(0.3), sine * sin(0.3), -1);
            const struct orl_rgb through = orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT);
            const struct orl_rgb back = orl_bsdf_albedo(bsdf, in, ORL_BSDF_REFLECT);
            for (int c = 0; c < COLORS; c++) {
                double r, t;
                slab_shares(cosine, 1.52, pow(passes[c], 1 / sqrt(1 - sine * sine / (1.52 * 1.52))),
                            &r, &t);
                assert_close(of(through, c), t, 0.03 * t);
                assert_close(of(back, c), r, 0.05 * r);
            }
        }
        /* At normal incidence the peak has the pane's colours: two levels of a quarter of 5 %, and
         * 0.3 % for the cell's angles. */
        const struct orl_vec3 in = direction(0.01, 0.02, -1);
        const struct orl_rgb peak = orl_bsdf_eval(bsdf, in, orl_neg(in));
        assert_close(peak.r / peak.g, 0.2 / 0.5, 0.028 * 0.4);
        assert_close(peak.b / peak.g, 0.8 / 0.5, 0.028 * 1.6);
        orl_bsdf_unref(bsdf);
    }
}

/* The tree has twelve numbers, whatever the resolution. */
static void an_even_sheet_has_one_colour(void **state)
{
    static const double shares[2][COLORS] = {{0.36, 0.24, 0.12}, {0.54, 0.36, 0.18}};
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct panel panel = {.text = SHEET LYING,
                                    .basis = bases[i],
                                    .cell = square,
                                    .color = true,
                                    .resolution = (uint32_t)extent(8, 16),
                                    .paths = 512};
        struct orl_bsdf_make_result made = panel_make(&panel);
        struct orl_bsdf *bsdf = panel_read(&made);
        struct orl_bsdf_info info;
        orl_bsdf_describe(bsdf, &info);
        assert_int_equal(info.values, 4);
        for (int part = 0; part < 4; part++) {
            const bool front = part / 2, t = part % 2;
            const struct orl_rgb f = orl_bsdf_eval(bsdf, direction(0.3, -0.4, front ? 1 : -1),
                                                   direction(0.5, 0.1, front == t ? -1 : 1));
            for (int c = 0; c < COLORS; c++)
                assert_close(of(f, c), shares[t][c] / ORL_PI,
                             (6 * made.worst + 1e-4) * shares[t][c] / ORL_PI);
        }
        orl_bsdf_unref(bsdf);
        orl_bsdf_make_result_done(&made);
    }
}

/* ---- Cells ----------------------------------------------------------------------------------- */

/* Returns the braces of all parts' luminances. */
static char *visible_of(const char *xml)
{
    const char *end = strstr(xml, "CIE-u");
    const char *from = strstr(xml, "<Wavelength ");
    const size_t size = end ? (size_t)(end - from) : strlen(from);
    char *text = malloc(size + 1);
    memcpy(text, from, size);
    text[size] = '\0';
    char *last = NULL;
    for (char *at = text; (at = strstr(at, "</WavelengthData>")); at++)
        last = at;
    assert_non_null(last);
    *last = '\0';
    return text;
}

/* If all light to a cell has one colour, colour adds no cells: equal to the byte. */
static void colour_leaves_luminance_alone(void **state)
{
    static const char *const texts[] = {SHEET LYING,
                                        "void plastic g 0 0 5 .4 .4 .4 .05 .1\n"
                                        "g polygon f 0 0 12 0 0 0 1 0 0 1 .7 -.7 0 .7 -.7\n"};
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct panel panel = {.text = texts[k / 2],
                              .basis = bases[k % 2],
                              .cell = square,
                              .resolution = (uint32_t)extent(8, 16),
                              .accuracy = k / 2 ? 0.2 : 0,
                              .paths = 512,
                              .paths_most = 2048};
        struct orl_bsdf_make_result gray = panel_make(&panel);
        panel.color = true;
        struct orl_bsdf_make_result colored = panel_make(&panel);
        char *a = visible_of(gray.xml), *b = visible_of(colored.xml);
        assert_null(strstr(gray.xml, "CIE-u"));
        assert_string_equal(a, b);
        assert_true(gray.worst == colored.worst && gray.paths == colored.paths);
        free(a);
        free(b);
        orl_bsdf_make_result_done(&gray);
        orl_bsdf_make_result_done(&colored);
    }
}

/* Colours split cells that luminances do not: light from above goes red to the left, green to the
 * right. A matrix has the same totals for either half, except noise and cells across the middle. */
static void colours_alone_are_told_apart(void **state)
{
    double left[3][COLORS], right[3][COLORS];
    (void)state;
    for (int i = 1; i < 3; i++) {
        const struct panel panel = {.text = roof,
                                    .basis = bases[i],
                                    .cell = square,
                                    .color = true,
                                    .paths = (uint32_t)extent(1024, 2048)};
        struct orl_bsdf *bsdf = read_panel(&panel);
        for (int c = 0; c < COLORS; c++)
            left[i][c] = right[i][c] = 0;
        enum { N = 40 };
        for (int k = 0; k < N * N; k++) {
            const double r = sqrt((k / N + 0.5) / N), phi = 2 * ORL_PI * (k % N + 0.37) / N;
            const struct orl_vec3 out = direction(r * cos(phi), r * sin(phi), 1);
            for (int q = 0; q < 4; q++) { /* four cells of a tree meet in the middle */
                const struct orl_vec3 in = direction(q & 1 ? 0.02 : -0.02, q & 2 ? 0.03 : -0.03, 1);
                const struct orl_rgb f = orl_bsdf_eval(bsdf, in, out);
                for (int c = 0; c < COLORS; c++)
                    *(out.x < 0 ? &left[i][c] : &right[i][c]) += of(f, c) * ORL_PI / (4 * N * N);
            }
        }
        orl_bsdf_unref(bsdf);
    }
    for (int i = 1; i < 3; i++)
        print_message("left %.4f %.4f %.4f, right %.4f %.4f %.4f\n", left[i][0], left[i][1],
                      left[i][2], right[i][0], right[i][1], right[i][2]);
    assert_true(left[1][RED] > 3 * left[1][GREEN] && right[1][GREEN] > right[1][RED]);
    for (int c = 0; c < COLORS; c++) {
        assert_close(left[1][c], left[2][c], 0.06 * left[2][c] + 0.003);
        assert_close(right[1][c], right[2][c], 0.06 * right[2][c] + 0.003);
    }
}

/* The bytes are equal for any number of threads, and a symmetric panel is symmetric to the last
 * bit, in each colour. */
static void bytes_are_the_same(void **state)
{
    char *first = NULL;
    (void)state;
    for (uint32_t threads = 1; threads <= 7; threads += 3) {
        const struct panel panel = {.text = roof,
                                    .basis = ORL_BSDF_TENSOR_TREE_4,
                                    .symmetry = ORL_BSDF_UP_DOWN,
                                    .cell = square,
                                    .color = true,
                                    .resolution = 8,
                                    .paths = 256,
                                    .threads = threads};
        struct orl_bsdf_make_result made = panel_make(&panel);
        struct orl_bsdf *bsdf = panel_read(&made);
        for (int i = 0; i < 64; i++) {
            const double r = 0.015 * i, s = 1 - 0.0149 * i;
            struct orl_vec3 in = direction(r * cos(i), r * sin(i), 1);
            struct orl_vec3 out = direction(s * cos(3 * i), s * sin(3 * i), 1);
            const struct orl_rgb f = orl_bsdf_eval(bsdf, in, out);
            in.y = -in.y, out.y = -out.y;
            const struct orl_rgb g = orl_bsdf_eval(bsdf, in, out);
            assert_true(f.r == g.r && f.g == g.g && f.b == g.b);
        }
        if (first)
            assert_string_equal(made.xml, first);
        else
            first = strdup(made.xml);
        orl_bsdf_unref(bsdf);
        orl_bsdf_make_result_done(&made);
    }
    free(first);
}

/* Glass without absorption in blue: all blue is reflected or transmitted, and no more. Noise, and
 * one chromaticity for several cells, would otherwise add light for single directions; the bound
 * for the mean allows for the light that the limit removes. */
static void no_colour_gains(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct panel panel = {.text = "void dielectric d 0 0 5 .3 .8 1 1.5 0\n"
                                            "d polygon flat 0 0 12 -1 -1 0 2 -1 0 2 2 0 -1 2 0\n"
                                            "d polygon low 0 0 12 -1 0 -.2 -1 1 -.6 2 1 -.6 2 0 "
                                            "-.2\nd polygon riser 0 0 12 -1 1 -.6 -1 1 -.2 2 1 "
                                            "-.2 2 1 -.6\n",
                                    .basis = bases[i],
                                    .cell = square,
                                    .color = true,
                                    .resolution = (uint32_t)extent(8, 16),
                                    .paths = (uint32_t)extent(1024, 4096)};
        struct orl_bsdf *bsdf = read_panel(&panel);
        double most = 0, mean = 0;
        enum { N = 400 };
        for (int k = 0; k < 2 * N; k++) {
            const double r = sqrt((k / 2 + 0.5) / N);
            const struct orl_vec3 in =
                direction(r * cos(2.4 * k), r * sin(2.4 * k), k % 2 ? 1 : -1);
            const struct orl_rgb all = orl_rgb_add(orl_bsdf_albedo(bsdf, in, ORL_BSDF_REFLECT),
                                                   orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT));
            assert_true(all.r < 0.9 && all.g < 1);
            most = fmax(most, all.b);
            mean += all.b / (2 * N);
        }
        print_message("rank %d: blue in all %.4f, at most %.4f\n", i + 3, mean, most);
        assert_close(mean, 1, 0.002);
        assert_true(most <= 1 + 1e-9);
        orl_bsdf_unref(bsdf);
    }
}

/* ---- Other bases ----------------------------------------------------------------------------- */

static struct orl_bsdf *converted(const struct orl_bsdf *bsdf, enum orl_bsdf_basis basis,
                                  bool color)
{
    struct orl_bsdf_make_request to;
    struct orl_bsdf_make_result made = {0};
    struct orl_error err = {0};
    const struct orl_bsdf_make_env env = {.pool = orl_thread_pool_start(2)};
    orl_bsdf_make_request_init(&to);
    to.basis = basis;
    to.resolution = 16;
    to.cull = 0;
    to.color = color;
    if (orl_bsdf_convert(bsdf, "a fixture", &to, &env, &made, &err) < 0)
        fail_msg("%s", err.message);
    orl_thread_pool_stop(env.pool);
    struct orl_bsdf *after = panel_read(&made);
    orl_bsdf_make_result_done(&made);
    return after;
}

static struct orl_bsdf_comparison compared(const struct orl_bsdf *a, const struct orl_bsdf *b)
{
    struct orl_bsdf_comparison c;
    struct orl_thread_pool *pool = orl_thread_pool_start(2);
    assert_int_equal(orl_bsdf_compare(a, b, pool, NULL, &c, NULL), 0);
    orl_thread_pool_stop(pool);
    return c;
}

static void expect_no_difference(const struct orl_bsdf *a, const struct orl_bsdf *b)
{
    const struct orl_bsdf_comparison c = compared(a, b);
    assert_true(c.colored[0] && c.colored[1]);
    for (int part = 0; part < 4; part++)
        assert_true(fabs(c.of[part / 2][part % 2].color.albedo_worst) < 1e-4);
}

/* Compares albedos at 256 directions. orl_bsdf_compare uses many more, and takes over a second. */
static void assert_same_albedos(const struct orl_bsdf *a, const struct orl_bsdf *b)
{
    enum { N = 64 };
    for (int i = 0; i < 4 * N; i++) {
        const double r = sqrt((i / 4 + 0.5) / N);
        const struct orl_vec3 in = direction(r * cos(2.4 * i), r * sin(2.4 * i), i & 1 ? 1 : -1);
        const enum orl_bsdf_side side = i & 2 ? ORL_BSDF_REFLECT : ORL_BSDF_TRANSMIT;
        const struct orl_rgb f = orl_bsdf_albedo(a, in, side), g = orl_bsdf_albedo(b, in, side);
        for (int c = 0; c < COLORS; c++)
            assert_close(of(g, c), of(f, c), 1e-4);
    }
}

/* A tree converted to an equal tree is unchanged; converted to grey it reports its colour
 * differences. */
static void conversions_keep_colour_or_say_so(void **state)
{
    const struct panel panel = {.text = SHEET LYING,
                                .basis = ORL_BSDF_TENSOR_TREE_4,
                                .cell = square,
                                .color = true,
                                .paths = 1024};
    struct orl_bsdf *tree = read_panel(&panel);
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct orl_bsdf *after = converted(tree, bases[i], true);
        assert_same_albedos(tree, after);
        if (bases[i] != ORL_BSDF_KLEMS_FULL && !extent_is_long()) {
            orl_bsdf_unref(after);
            continue; /* the long suite compares all, and converts back in all ways */
        }
        expect_no_difference(tree, after);
        struct orl_bsdf *again = converted(after, ORL_BSDF_TENSOR_TREE_4, true);
        assert_same_albedos(tree, again);
        if (extent_is_long())
            expect_no_difference(tree, again);
        orl_bsdf_unref(again);
        orl_bsdf_unref(after);
    }
    struct orl_bsdf *gray = converted(tree, ORL_BSDF_TENSOR_TREE_4, false);
    const struct orl_bsdf_comparison c = compared(tree, gray);
    assert_true(c.colored[0] && !c.colored[1]);
    const double luma = orl_luma((struct orl_rgb){0.54, 0.36, 0.18});
    /* Blue has the largest difference of the three. */
    assert_close(c.of[0][1].color.albedo_worst, luma - 0.18, 0.005);
    assert_true(fabs(c.of[0][1].albedo_worst) < 1e-5);
    orl_bsdf_unref(gray);
    orl_bsdf_unref(tree);
}

/* ---- In a room ------------------------------------------------------------------------------- */

enum { SENSORS = 2 };
static const struct orl_sensor sensors[SENSORS] = {{{2, 1.5, .8}, {0, 0, 1}},
                                                   {{1, 2.5, 1.2}, {0, -1, 0}}};

struct reading {
    double lx[SENSORS], error[SENSORS];
};

/* Returns the reading under a sky of one colour. */
static struct reading read_room(const char *pane, const char *xml, int channel)
{
    static const char *const skies[COLORS] = {"3 0 0", "0 1.5 0", "0 0 12"};
    char scene[4096];
    struct reading reading;
    snprintf(scene, sizeof scene,
             "void glow g 0 0 4 %s 0\n%sg source sky 0 0 4 0 0 1 360\nvoid plastic w 0 0 5 .5 .5 "
             ".5 0 0\n"
             "%sp polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n",
             skies[channel], pane, scene_fixture("room_4x5_window"));
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .resource_name = xml ? "pane.xml" : NULL,
                                                        .resource_text = xml,
                                                        .sensors = sensors,
                                                        .n_sensors = SENSORS,
                                                        .technique = ORL_TECHNIQUE_BACKWARD,
                                                        .samples = (uint32_t)extent(2048, 8192)});
    for (int i = 0; i < SENSORS; i++) {
        reading.lx[i] = r.illuminance_lx[i];
        reading.error[i] = (r.interval_95_lx[i][1] - r.interval_95_lx[i][0]) / (2 * 1.96);
    }
    orl_result_done(&r);
    return reading;
}

/* Trees and the matrix as panes of a room, and the material itself, agree within four errors of
 * both, and 1.5 % for chromaticities and the angular resolution of 16 cells per side, or 145. */
static void rooms_have_the_same_light(void **state)
{
    static const char *const materials[2] = {PANE, SHEET}, *const panels[2] = {PANE LYING,
                                                                               SHEET LYING};
    (void)state;
    for (int m = 0; m < 2; m++) {
        struct reading truth[COLORS];
        for (int c = 0; c < COLORS; c++)
            truth[c] = read_room(materials[m], NULL, c);
        for (int i = 0; i < 3; i++) {
            const struct panel panel = {
                .text = panels[m], .basis = bases[i], .cell = square, .color = true, .paths = 1024};
            struct orl_bsdf_make_result made = panel_make(&panel);
            for (int c = 0; c < COLORS; c++) {
                const struct reading got =
                    read_room("void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n", made.xml, c);
                for (int s = 0; s < SENSORS; s++)
                    assert_close(got.lx[s], truth[c].lx[s],
                                 4 * hypot(got.error[s], truth[c].error[s]) +
                                     0.015 * truth[c].lx[s]);
                print_message("panel %d, basis %d, colour %d: %.1f +- %.1f, %.1f +- %.1f lx\n", m,
                              i, c, got.lx[0], got.error[0], truth[c].lx[0], truth[c].error[0]);
            }
            orl_bsdf_make_result_done(&made);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_filter_is_fresnels_in_every_colour),
        cmocka_unit_test(an_even_sheet_has_one_colour),
        cmocka_unit_test(colour_leaves_luminance_alone),
        cmocka_unit_test(colours_alone_are_told_apart),
        cmocka_unit_test(bytes_are_the_same),
        cmocka_unit_test(no_colour_gains),
        cmocka_unit_test(conversions_keep_colour_or_say_so),
        cmocka_unit_test(rooms_have_the_same_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
