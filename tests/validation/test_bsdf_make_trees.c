/*
 * Tensor trees from the virtual goniophotometer: closed forms, agreement with matrices of the same
 * panel, and merging of cells without significant differences. Tolerances as in test_bsdf_make.c.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bsdf/tree/shirley.h"
#include "fixtures/bsdf_ask.h"
#include "support/extent.h"
#include "support/panels.h"

static const double square[4] = {0, 1, 0, 1};

/* Returns the middle of a cell of a square with that many cells per side, above. */
static struct orl_vec3 cell_direction(int x, int y, int side)
{
    return orl_square_to_hemisphere(
        (struct orl_square){2 * (x + 0.5) / side - 1, 2 * (y + 0.5) / side - 1});
}

/* A featureless panel has one number per part, however fine the cells. */
static void an_even_sheet_is_four_numbers(void **state)
{
    static const enum orl_bsdf_basis bases[] = {ORL_BSDF_TENSOR_TREE_3, ORL_BSDF_TENSOR_TREE_4};
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct panel panel = {.text = "void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                                            "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n",
                                    .basis = bases[i],
                                    .paths = 512};
        struct orl_bsdf_make_result made = panel_make(&panel);
        struct orl_bsdf *bsdf = panel_read(&made);
        struct orl_bsdf_info info;
        orl_bsdf_describe(bsdf, &info);
        assert_int_equal(info.values, 4);
        assert_int_equal(info.resolution, i == 0 ? 2 : 1);
        for (int front = 0; front < 2; front++) {
            const struct orl_vec3 in = direction(0.3, -0.4, front ? 1 : -1);
            for (int t = 0; t < 2; t++) {
                const struct orl_bsdf_share *s = &made.diffuse[front][t];
                assert_close(s->value, t ? 0.3 : 0.2, 6 * s->error);
                assert_close(eval(bsdf, in, direction(0.5, 0.1, front == t ? -1 : 1)),
                             (t ? 0.3 : 0.2) / ORL_PI, 6 * made.worst);
            }
        }
        assert_int_equal(made.n_directions, 0);
        assert_null(made.errors[0][0]);
        orl_bsdf_unref(bsdf);
        orl_bsdf_make_result_done(&made);
    }
}

/*
 * Slabs of index 1.5, in rings of equal projected solid angle: all transmitted light is straight.
 */
static void a_slab_is_fresnels_in_every_ring(void **state)
{
    enum { RINGS = 8, STEPS = 64 }; /* resolution 16 */
    const struct panel panel = {.text = "void dielectric d 0 0 5 .7 .7 .7 1.5 0\n"
                                        "!genbox d slab 4 4 .5 | xform -t -2 -2 -.5\n",
                                .basis = ORL_BSDF_TENSOR_TREE_3,
                                .cell = square,
                                .paths = 4096};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    double mean = 0;
    (void)state;
    for (int ring = 0; ring < RINGS; ring++) {
        const double low = (double)ring / RINGS, high = (ring + 1.0) / RINGS;
        double transmitted = 0;
        for (int i = 0; i < STEPS; i++) {
            double r, t;
            const double s2 = low * low + (high * high - low * low) * (i + 0.5) / STEPS;
            slab_shares(sqrt(1 - s2), 1.5, pow(0.7, 0.5 / sqrt(1 - s2 / 2.25)), &r, &t);
            transmitted += t / STEPS;
        }
        mean += transmitted * (high * high - low * low);
        const double sine = 0.5 * (low + high);
        for (int k = 0; k < 7; k++) { /* from all sides */
            const struct orl_vec3 in = direction(sine * cos(k), sine * sin(k), -1);
            const double got = orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT).g;
            /* The error of 4096 stratified points, and 0.8 % where faint cells were merged. */
            assert_close(got, transmitted, 0.003);
            assert_true(eval(bsdf, in, orl_neg(in)) > 10 * got / ORL_PI);
        }
    }
    assert_close(made.diffuse[0][1].value, mean, 6 * made.diffuse[0][1].error + 3e-5);
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

/* Trees and matrices of the same panel agree, for either way of counting. */
static void trees_and_matrices_agree(void **state)
{
    struct panel panel = {.text = "void dielectric d 0 0 5 1 1 1 1.5 0\n"
                                  "void plastic p 0 0 5 .5 .5 .5 0 0\n"
                                  "d polygon flat 0 0 12 -1 -1 0 2 -1 0 2 2 0 -1 2 0\n"
                                  "d polygon slope 0 0 12 -1 0 -.2 -1 1 -.6 2 1 -.6 2 0 -.2\n"
                                  "d polygon riser 0 0 12 -1 1 -.6 -1 1 -.2 2 1 -.2 2 1 -.6\n"
                                  "p polygon slat 0 0 12 0 .2 -.8 0 .5 -.7 1 .5 -.7 1 .2 -.8\n",
                          .cell = square,
                          .paths = 1024,
                          .basis = ORL_BSDF_KLEMS_FULL};
    struct orl_bsdf_make_result matrix = panel_make(&panel);
    (void)state;
    panel.basis = ORL_BSDF_TENSOR_TREE_4;
    panel.resolution = 32;
    panel.paths = 256;
    struct orl_bsdf_make_result tree = panel_make(&panel);
    for (int front = 0; front < 2; front++) {
        for (int t = 0; t < 2; t++) {
            const struct orl_bsdf_share *a = &matrix.diffuse[front][t],
                                        *b = &tree.diffuse[front][t];
            assert_close(a->value, b->value, 6 * hypot(a->error, b->error));
        }
    }
    orl_bsdf_make_result_done(&tree);
    orl_bsdf_make_result_done(&matrix);
}

/* Black slats at 45 degrees, as in test_bsdf_make_blinds.c, fix the directions up, left and
 * outside. */
static void directions_are_where_they_are(void **state)
{
    static const double s = 0.70710678;
    static const char *const texts[2] = {
        "void plastic b 0 0 5 0 0 0 0 0\nb polygon s 0 0 12 0 0 0 1 0 0 1 1 -1 0 1 -1\n",
        "void plastic b 0 0 5 0 0 0 0 0\nb polygon s 0 0 12 0 0 0 0 1 0 1 1 -1 1 0 -1\n"};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const struct panel panel = {
            .text = texts[k], .basis = ORL_BSDF_TENSOR_TREE_4, .paths = 256};
        struct orl_bsdf_make_result made = panel_make(&panel);
        struct orl_bsdf *bsdf = panel_read(&made);
        const double x = k ? s : 0.01, y = k ? 0.01 : s;
        assert_true(orl_bsdf_albedo(bsdf, direction(x, y, -1), ORL_BSDF_TRANSMIT).g > 0.75);
        assert_true(orl_bsdf_albedo(bsdf, direction(-x, -y, 1), ORL_BSDF_TRANSMIT).g > 0.75);
        assert_true(orl_bsdf_albedo(bsdf, direction(-x, -y, -1), ORL_BSDF_TRANSMIT).g < 1e-3);
        assert_true(orl_bsdf_albedo(bsdf, direction(x, y, 1), ORL_BSDF_TRANSMIT).g < 1e-3);
        assert_true(eval(bsdf, direction(x, y, -1), direction(-x, -y, 1)) > 10);
        orl_bsdf_unref(bsdf);
        orl_bsdf_make_result_done(&made);
    }
}

/* Mirrored trees are measured once and equal to the bit, also for any number of threads. */
static void mirrors_and_threads_change_nothing(void **state)
{
    char *first = NULL;
    (void)state;
    for (uint32_t threads = 1; threads <= 7; threads += 3) {
        const struct panel panel = {.text = "void dielectric d 0 0 5 1 1 1 1.491 0\n"
                                            "!genbox d part 4 1 1.5 | xform -t -2 0 -1.5\n",
                                    .basis = ORL_BSDF_TENSOR_TREE_4,
                                    .symmetry = ORL_BSDF_QUADRILATERAL,
                                    .cell = square,
                                    .paths = 128,
                                    .threads = threads};
        struct orl_bsdf_make_result made = panel_make(&panel);
        if (!first) {
            struct orl_bsdf *bsdf = panel_read(&made);
            first = strdup(made.xml);
            for (int i = 0; i < 30; i++) {
                const double r = 0.0301 * i + 0.0131; /* not on a border of cells */
                const struct orl_vec3 in = direction(r * cos(i), r * sin(i), -1);
                for (int m = 1; m < 4; m++) {
                    const double sx = m & 1 ? -1 : 1, sy = m & 2 ? -1 : 1;
                    const struct orl_vec3 a = orl_v3(sx * in.x, sy * in.y, in.z);
                    assert_true(eval(bsdf, a, orl_neg(a)) == eval(bsdf, in, orl_neg(in)));
                }
            }
            /* 16 by 16 cells from each side, of which a quarter is measured. */
            assert_int_equal(made.paths, 2 * 64 * 128);
            orl_bsdf_unref(bsdf);
        }
        assert_string_equal(made.xml, first);
        orl_bsdf_make_result_done(&made);
    }
    free(first);
}

/* A panel whose mirror planes are detected equals one for which they are given; no plane is
 * detected if its geometry or its materials are asymmetric. */
static void mirrors_are_found(void **state)
{
    static const double tall[4] = {0, 1, 0, 0.8};
    static const struct {
        const char *text;
        const double *cell;
        enum orl_bsdf_symmetry has;
    } cases[] = {
        {"void dielectric d 0 0 5 1 1 1 1.491 0\n!genbox d part 4 1 1.5 | xform -t -2 0 -1.5\n",
         square, ORL_BSDF_QUADRILATERAL},
        {"void plastic w 0 0 5 .7 .7 .7 0 0\nw polygon s 0 0 12 0 0 0 1 0 0 1 .6 -.6 0 .6 -.6\n",
         tall, ORL_BSDF_LEFT_RIGHT},
        {"void metal m 0 0 5 .8 .8 .8 .9 .1\nm polygon s 0 0 12 0 0 0 0 .8 0 .3 .8 -.6 .3 0 -.6\n",
         tall, ORL_BSDF_UP_DOWN},
        /* A hole with a hundredth of the cell's area. */
        {"void plastic w 0 0 5 .7 .7 .7 0 0\nw polygon s 0 0 12 0 0 0 1 0 0 1 .8 0 0 .8 0\n"
         "void metal m 0 0 5 .8 .8 .8 1 0\nm ring r 0 0 8 .2 .3 .01 0 0 1 0 .05\n",
         tall, ORL_BSDF_ASYMMETRIC},
        {"void plastic2 w 4 1 1 0 . 0 6 .7 .7 .7 .1 .1 .3\n"
         "w polygon s 0 0 12 0 0 0 1 0 0 1 .8 0 0 .8 0\n",
         tall, ORL_BSDF_ASYMMETRIC},
        {"void brightfunc f 2 Px . 0 0\nf plastic w 0 0 5 .7 .7 .7 0 0\n"
         "w polygon s 0 0 12 0 0 0 1 0 0 1 .8 0 0 .8 0\n",
         tall, ORL_BSDF_ASYMMETRIC},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct panel panel = {.text = cases[i].text,
                              .basis = ORL_BSDF_TENSOR_TREE_4,
                              .symmetry = ORL_BSDF_SYMMETRY_AUTO,
                              .cell = cases[i].cell,
                              .resolution = 4,
                              .paths = 16};
        struct orl_bsdf_make_result found = panel_make(&panel);
        panel.symmetry = cases[i].has;
        struct orl_bsdf_make_result told = panel_make(&panel);
        assert_string_equal(found.xml, told.xml); /* the XML names the mirror planes */
        orl_bsdf_make_result_done(&found);
        orl_bsdf_make_result_done(&told);
    }
}

/*
 * A stated accuracy is met for a laser cut panel, compared with ten times the paths of another
 * seed. Cells from 2 % of the peak on, clear of the threshold where errors count: the worst of
 * about a thousand is within 4.5 standard errors (of 15 degrees of freedom, one in 10^3 by chance),
 * the rms within one of them.
 */
static void an_accuracy_is_kept(void **state)
{
    const int side = (int)extent(8, 16);
    const double accuracy = 0.02;
    struct panel panel = {.text = "void dielectric d 0 0 5 1 1 1 1.491 0\n"
                                  "!genbox d part 4 1 1.5 | xform -t -2 0 -1.5\n",
                          .basis = ORL_BSDF_TENSOR_TREE_4,
                          .symmetry = ORL_BSDF_QUADRILATERAL,
                          .cell = square,
                          .resolution = (uint32_t)side,
                          .cull = 1e-6,
                          .paths = 1024,
                          .accuracy = accuracy};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    panel.accuracy = 0;
    panel.paths = 1 << 15;
    panel.seed = 2;
    struct orl_bsdf_make_result longer = panel_make(&panel);
    struct orl_bsdf *reference = panel_read(&longer);
    double peak = 0, squares = 0, worst = 0;
    int count = 0;
    (void)state;
    assert_true(made.reached && made.worst < 2 * accuracy && made.worst > accuracy / 10);
    assert_true(10 * made.paths < longer.paths);
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < side * side * side * side; i++) {
            const struct orl_vec3 in = cell_direction(i % side, i / side % side, side);
            const struct orl_vec3 out =
                cell_direction(i / (side * side) % side, i / (side * side * side), side);
            const double b = eval(reference, orl_neg(in), out);
            peak = pass == 0 ? fmax(peak, b) : peak;
            if (pass == 0 || b < 0.02 * peak)
                continue;
            const double off = (eval(bsdf, orl_neg(in), out) - b) / b;
            squares += off * off;
            worst = fmax(worst, fabs(off));
            count++;
        }
    assert_true(count > (int)extent(125, 500)); /* cells along a peak, a quarter as many */
    assert_true(sqrt(squares / count) < accuracy);
    assert_true(worst < 4.5 * accuracy);
    orl_bsdf_unref(reference);
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&longer);
    orl_bsdf_make_result_done(&made);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_even_sheet_is_four_numbers),
        cmocka_unit_test(a_slab_is_fresnels_in_every_ring),
        cmocka_unit_test(trees_and_matrices_agree),
        cmocka_unit_test(directions_are_where_they_are),
        cmocka_unit_test(mirrors_and_threads_change_nothing),
        cmocka_unit_test(mirrors_are_found),
        cmocka_unit_test(an_accuracy_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
