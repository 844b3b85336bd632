/*
 * Guarantees of the virtual goniophotometer for any panel: equal bytes for any number of threads,
 * correct error estimates, the accuracy or a warning, energy, reciprocity, symmetry; and the inputs
 * that it refuses.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/bsdf_ask.h"
#include "support/panels.h"

/* A saw of clear plastic with asymmetric teeth without gaps; coloured paint on one tooth's back. */
static const char saw[] = "void dielectric d 0 0 5 1 1 1 1.5 0\n"
                          "void plastic p 0 0 5 .7 .5 .2 .1 .1\n"
                          "d polygon flat 0 0 12 -1 -1 0 2 -1 0 2 2 0 -1 2 0\n"
                          "d polygon slope 0 0 12 -1 0 -.2 -1 1 -.6 2 1 -.6 2 0 -.2\n"
                          "d polygon riser 0 0 12 -1 1 -.6 -1 1 -.2 2 1 -.2 2 1 -.6\n"
                          "p polygon paint 0 0 12 0 .2 -.8 0 .5 -.8 .6 .5 -.8 .6 .2 -.8\n";
static const double square[4] = {0, 1, 0, 1};

/* Uniform diffuse transmission of half of the light. */
static const char sheet[] = "void trans s 0 0 7 .8 .8 .8 0 0 .5 0\n"
                            "s polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n";

static void bytes_do_not_depend_on_threads(void **state)
{
    static const uint32_t threads[] = {1, 2, 7};
    char *first = NULL;
    (void)state;
    for (int i = 0; i < 4; i++) {
        const struct panel panel = {.text = saw,
                                    .basis = ORL_BSDF_KLEMS_QUARTER,
                                    .cell = square,
                                    .color = true,
                                    .paths = 256,
                                    .accuracy = 0.2,
                                    .paths_most = 1024,
                                    .seed = i < 3 ? 1 : 2,
                                    .threads = i < 3 ? threads[i] : 1};
        struct orl_bsdf_make_result made = panel_make(&panel);
        if (!first)
            first = strdup(made.xml);
        else if (i < 3)
            assert_string_equal(made.xml, first);
        else
            assert_string_not_equal(made.xml, first);
        orl_bsdf_make_result_done(&made);
    }
    free(first);
}

/* For 41 * 41 equal values the stated errors are the actual errors, and below the accuracy. */
static void errors_are_stated_and_kept(void **state)
{
    const struct panel panel = {
        .text = sheet, .basis = ORL_BSDF_KLEMS_QUARTER, .paths = 256, .accuracy = 0.04};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    const size_t n = made.n_directions;
    double squares = 0, far = 0;
    (void)state;
    assert_true(made.reached);
    assert_true(made.worst > 0.01 && made.worst <= 0.04);
    assert_true(made.paths > 2 * n * 256);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            const struct orl_bsdf_make_direction *from = &made.directions[i],
                                                 *to = &made.directions[k];
            const double a = sin(from->theta_deg * ORL_DEG_TO_RAD),
                         b = sin(to->theta_deg * ORL_DEG_TO_RAD);
            const struct orl_vec3 in = direction(a * cos(from->phi_deg * ORL_DEG_TO_RAD),
                                                 a * sin(from->phi_deg * ORL_DEG_TO_RAD), -1);
            const struct orl_vec3 out = direction(-b * cos(to->phi_deg * ORL_DEG_TO_RAD),
                                                  -b * sin(to->phi_deg * ORL_DEG_TO_RAD), 1);
            const double error = (double)made.errors[0][1][i * n + k];
            const double off = (eval(bsdf, in, out) - 0.4 / ORL_PI) / error;
            squares += off * off / (double)(n * n);
            far = fmax(far, fabs(eval(bsdf, in, out) * ORL_PI / 0.4 - 1));
        }
    /* Student's t with 15 degrees of freedom has a variance of 15/13. Rounds stop when errors look
     * small, so a few stated errors are too small. */
    assert_true(squares > 0.8 && squares < 1.6);
    assert_true(far < 6 * 0.04);
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

static void an_accuracy_out_of_reach_is_said(void **state)
{
    const struct panel panel = {.text = sheet,
                                .basis = ORL_BSDF_KLEMS_QUARTER,
                                .paths = 256,
                                .accuracy = 0.001,
                                .paths_most = 1024};
    struct orl_bsdf_make_result made = panel_make(&panel);
    (void)state;
    assert_false(made.reached);
    assert_true(made.worst > 0.001);
    assert_int_equal(made.paths, 82 * 1024);
    assert_non_null(strstr(made.xml, "accuracy 0.001 (not reached)"));
    orl_bsdf_make_result_done(&made);
}

/* ---- Physics --------------------------------------------------------------------------------- */

/* Returns the direction from which light of a cell comes, on that side. */
static struct orl_vec3 origin_of(const struct orl_bsdf_make_result *made, size_t cell, double side)
{
    const struct orl_bsdf_make_direction *d = &made->directions[cell];
    const double s = sin(d->theta_deg * ORL_DEG_TO_RAD), phi = d->phi_deg * ORL_DEG_TO_RAD;
    return direction(s * cos(phi), s * sin(phi), side);
}

/* Returns the cell rotated by half a turn. */
static size_t turned(const struct orl_bsdf_make_result *made, size_t cell)
{
    const struct orl_vec3 d = origin_of(made, cell, 1);
    for (size_t i = 0; i < made->n_directions; i++) {
        const struct orl_vec3 e = origin_of(made, i, 1);
        if (hypot(d.x + e.x, d.y + e.y) < 1e-6)
            return i;
    }
    fail();
    return 0;
}

/* Clear and reflecting surfaces are reciprocal and lose no light. */
static void energy_is_kept_and_paths_go_both_ways(void **state)
{
    const struct panel panel = {
        .text = saw, .basis = ORL_BSDF_KLEMS_QUARTER, .cell = square, .paths = 8192};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    const size_t n = made.n_directions;
    double squares = 0;
    size_t count = 0;
    (void)state;
    for (size_t i = 0; i < n; i++) {
        for (int front = 0; front < 2; front++) {
            const struct orl_bsdf_share *s = made.directions[i].shares[front];
            assert_true(s[0].value + s[1].value <= 1 + 6 * (s[0].error + s[1].error));
        }
        for (size_t k = 0; k < n; k++) {
            const struct orl_vec3 in = origin_of(&made, i, -1);
            const struct orl_vec3 out = origin_of(&made, turned(&made, k), 1);
            const double there = eval(bsdf, in, out), back = eval(bsdf, out, in);
            const double e0 = (double)made.errors[0][1][i * n + k];
            const double e1 = (double)made.errors[1][1][turned(&made, k) * n + turned(&made, i)];
            if (there < 0.02)
                continue;
            squares += (there - back) * (there - back) / (e0 * e0 + e1 * e1 + 1e-12);
            count++;
        }
    }
    assert_true(count > 100);
    assert_true(squares / (double)count < 1.6);
    assert_true(made.lost < 1e-4);
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

static void symmetry_is_exact_where_asked_for(void **state)
{
    const struct panel panel = {.text = sheet,
                                .basis = ORL_BSDF_KLEMS_HALF,
                                .symmetry = ORL_BSDF_QUADRILATERAL,
                                .color = true,
                                .paths = 64};
    struct orl_bsdf_make_result made = panel_make(&panel);
    struct orl_bsdf *bsdf = panel_read(&made);
    bool varied = false;
    (void)state;
    assert_int_equal(made.n_directions, 77);
    for (int i = 0; i < 40; i++) {
        const double r = 0.025 * i, s = 1 - 0.02 * i;
        const struct orl_vec3 in = direction(r * cos(i), r * sin(i), -1);
        const struct orl_vec3 out = direction(s * cos(3 * i), s * sin(3 * i), 1);
        const double f = eval(bsdf, in, out);
        for (int m = 1; m < 4; m++) {
            struct orl_vec3 a = in, b = out;
            a.x *= m & 1 ? -1 : 1, b.x *= m & 1 ? -1 : 1;
            a.y *= m & 2 ? -1 : 1, b.y *= m & 2 ? -1 : 1;
            assert_true(eval(bsdf, a, b) == f);
        }
        varied = varied || fabs(f - 0.4 / ORL_PI) > 1e-3;
    }
    assert_true(varied); /* the equal values contain noise */
    orl_bsdf_unref(bsdf);
    orl_bsdf_make_result_done(&made);
}

/* ---- Refused inputs -------------------------------------------------------------------------- */

static void what_is_no_panel_is_refused(void **state)
{
    static const double upside_down[4] = {0, 1, 1, 0};
    static const struct {
        struct panel panel;
        int code;
        const char *says;
    } cases[] = {
        {{.text = "void light l 0 0 3 1 1 1\nl source sun 0 0 4 0 0 1 .5\n"
                  "void plastic p 0 0 5 1 1 1 0 0\np polygon a 0 0 9 0 0 0 1 0 0 1 1 0\n"},
         ORL_ERR_INVALID,
         "a panel cannot contain"},
        {{.text = "void glow l 0 0 4 1 1 1 0\nl polygon a 0 0 9 0 0 0 1 0 0 1 1 0\n"},
         ORL_ERR_INVALID,
         "emits light"},
        {{.text = "void plastic p 0 0 5 1 1 1 0 0\n"}, ORL_ERR_INVALID, "no surface"},
        {{.text = "void plastic p 0 0 5 1 1 1 0 0\np polygon a 0 0 9 0 0 0 0 0 1 0 1 0\n"},
         ORL_ERR_INVALID,
         "no extent in x"},
        {{.text = "void paint p 0 0 0\n"}, ORL_ERR_SYNTAX, ""},
        {{.text = sheet, .paths = 3}, ORL_ERR_RANGE, "paths"},
        {{.text = sheet, .cell = upside_down}, ORL_ERR_RANGE, "cell"},
        {{.text = sheet, .accuracy = 1.5}, ORL_ERR_RANGE, "accuracy"},
        {{.text = sheet, .accuracy = 0.1, .paths_most = 64}, ORL_ERR_RANGE, "paths_most must be"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_bsdf_make_result made = {0};
        struct orl_error err = {0};
        assert_int_equal(panel_try(&cases[i].panel, NULL, &made, &err), cases[i].code);
        if (!strstr(err.message, cases[i].says))
            fail_msg("\"%s\" does not say \"%s\"", err.message, cases[i].says);
    }
}

static void a_cancelled_one_leaves_nothing(void **state)
{
    const struct panel panel = {.text = sheet};
    atomic_bool cancel = true;
    struct orl_bsdf_make_result made = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(panel_try(&panel, &cancel, &made, &err), ORL_ERR_CANCELLED);
    assert_null(made.xml);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_do_not_depend_on_threads),
        cmocka_unit_test(errors_are_stated_and_kept),
        cmocka_unit_test(an_accuracy_out_of_reach_is_said),
        cmocka_unit_test(energy_is_kept_and_paths_go_both_ways),
        cmocka_unit_test(symmetry_is_exact_where_asked_for),
        cmocka_unit_test(what_is_no_panel_is_refused),
        cmocka_unit_test(a_cancelled_one_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
