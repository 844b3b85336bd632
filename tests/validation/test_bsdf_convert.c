/*
 * BSDFs in other bases: an equal basis keeps values, total light is kept, and differences are
 * reported correctly.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf/bsdf_convert.h>

#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"
#include "support/panels.h"

static struct orl_bsdf_make_result convert(const struct orl_bsdf *bsdf, enum orl_bsdf_basis basis,
                                           uint32_t resolution, double cull)
{
    struct orl_bsdf_make_request to;
    struct orl_bsdf_make_result made = {0};
    struct orl_error err = {0};
    const struct orl_bsdf_make_env env = {.pool = orl_thread_pool_start(2)};
    orl_bsdf_make_request_init(&to);
    to.basis = basis;
    to.resolution = resolution;
    to.cull = cull;
    if (orl_bsdf_convert(bsdf, "a fixture", &to, &env, &made, &err) < 0)
        fail_msg("%s", err.message);
    orl_thread_pool_stop(env.pool);
    return made;
}

/* Returns directions on no border of any basis, in all four quarters. */
static struct orl_vec3 some_direction(int i, bool front)
{
    const double r = 0.031 + 0.94 * fmod(0.618034 * i, 1), phi = 2.4 * i + 0.1;
    return direction(r * cos(phi), r * sin(phi), front ? 1 : -1);
}

static void assert_same(const struct orl_bsdf *a, const struct orl_bsdf *b, double tolerance)
{
    enum { DIRECTIONS = 48 };
    for (int i = 0; i < DIRECTIONS; i++)
        for (int k = 0; k < DIRECTIONS; k++)
            for (int side = 0; side < 4; side++) {
                const struct orl_vec3 in = some_direction(i, side & 1);
                const struct orl_vec3 out = some_direction(k + 7, side & 2);
                const double f = eval(a, in, out);
                assert_close(eval(b, in, out), f, tolerance * (f + 1e-3));
            }
}

/* Values are floats; a mean over equal ones is the same value except for rounding. */
static void the_same_basis_is_the_same(void **state)
{
    struct orl_bsdf *tree = load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml"));
    struct orl_bsdf *matrix = load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"));
    (void)state;
    for (uint32_t side = 8; side <= 16; side *= 2) {
        struct orl_bsdf_make_result made = convert(tree, ORL_BSDF_TENSOR_TREE_4, side, 0);
        struct orl_bsdf *again = panel_read(&made);
        assert_same(tree, again, 1e-5);
        orl_bsdf_unref(again);
        orl_bsdf_make_result_done(&made);
    }
    struct orl_bsdf_make_result made = convert(matrix, ORL_BSDF_KLEMS_QUARTER, 64, 0);
    struct orl_bsdf *again = panel_read(&made);
    assert_same(matrix, again, 1e-5);
    assert_non_null(strstr(made.xml, "Converted by Oriel"));
    assert_non_null(strstr(made.xml, "From: a fixture"));
    orl_bsdf_unref(again);
    orl_bsdf_make_result_done(&made);
    orl_bsdf_unref(matrix);
    orl_bsdf_unref(tree);
}

/* Diffuse light keeps its total in any basis: exactly if cells consist of cells, otherwise within
 * the error of points along incident cells for a panel with 8 by 8 directions, on whose borders
 * they fall. */
static void light_in_all_is_kept(void **state)
{
    static const struct {
        enum orl_bsdf_basis basis;
        double tolerance;
    } cases[] = {{ORL_BSDF_TENSOR_TREE_4, 2e-6},
                 {ORL_BSDF_TENSOR_TREE_3, 0.01},
                 {ORL_BSDF_KLEMS_FULL, 0.004},
                 {ORL_BSDF_KLEMS_HALF, 0.004}};
    struct orl_bsdf *tree = load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml"));
    struct orl_bsdf_make_result whole = convert(tree, ORL_BSDF_TENSOR_TREE_4, 8, 0);
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_bsdf_make_result made = convert(tree, cases[i].basis, 4, 0.3);
        for (int part = 0; part < 4; part++)
            assert_close(made.diffuse[part / 2][part % 2].value,
                         whole.diffuse[part / 2][part % 2].value, cases[i].tolerance);
        assert_true(made.paths == 0 && made.reached);
        orl_bsdf_make_result_done(&made);
    }
    orl_bsdf_make_result_done(&whole);
    orl_bsdf_unref(tree);
}

/* Two sheets: the light that the second lacks is missing evenly in all directions. */
static void differences_are_told(void **state)
{
    static const char *const texts[2] = {"void trans s 0 0 7 .5 .5 .5 0 0 .6 0\n"
                                         "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n",
                                         "void trans s 0 0 7 .4 .4 .4 0 0 .6 0\n"
                                         "s polygon p 0 0 12 0 0 0 2 0 0 2 1 0 0 1 0\n"};
    struct orl_bsdf *sheets[2];
    struct orl_bsdf_comparison c;
    struct orl_thread_pool *pool = orl_thread_pool_start(2);
    (void)state;
    for (int i = 0; i < 2; i++) {
        const struct panel panel = {
            .text = texts[i], .basis = ORL_BSDF_TENSOR_TREE_4, .resolution = 8, .paths = 1024};
        struct orl_bsdf_make_result made = panel_make(&panel);
        sheets[i] = panel_read(&made);
        orl_bsdf_make_result_done(&made);
    }
    assert_int_equal(orl_bsdf_compare(sheets[0], sheets[0], pool, NULL, &c, NULL), 0);
    assert_true(c.of[0][1].albedo_worst == 0 && c.of[1][0].moved_worst == 0 &&
                c.of[1][1].cone_worst == 0);
    assert_int_equal(orl_bsdf_compare(sheets[0], sheets[1], pool, NULL, &c, NULL), 0);
    for (int front = 0; front < 2; front++) {
        /* A share of .3 and .2 of the light, of which the second has four fifths; sampled by 16384
         * paths from each of 64 cells. A cone holds whole cells of half a degree: a tenth more or
         * less. */
        const double missing = 0.2 * 0.3, cone = missing * 2 * (1 - cos(ORL_DEG_TO_RAD));
        assert_close(c.of[front][1].albedo_worst, -missing, 0.002);
        assert_close(c.of[front][1].albedo_rms, missing, 0.002);
        assert_close(c.of[front][1].moved_mean, missing / 2, 0.001);
        assert_close(c.of[front][1].cone_worst, -cone, 0.25 * cone);
        assert_close(c.of[front][0].albedo_worst, -0.2 * 0.2, 0.002);
    }
    orl_thread_pool_stop(pool);
    orl_bsdf_unref(sheets[0]);
    orl_bsdf_unref(sheets[1]);
}

static double worst(const struct orl_bsdf_comparison *c)
{
    double most = 0;
    for (int i = 0; i < 4; i++)
        most = fmax(most, fmax(fabs(c->of[i / 2][i % 2].albedo_worst),
                               fabs(c->of[i / 2][i % 2].cone_worst)));
    return most;
}

/* Culling stays within its limits: the file is smaller than without culling, and three times the
 * allowed share per cell loses more than requested. */
static void a_cull_loses_what_it_may(void **state)
{
    static const double within = 0.01;
    struct orl_bsdf *tree = load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml"));
    const struct orl_bsdf_make_env env = {.pool = orl_thread_pool_start(2)};
    struct orl_bsdf_comparison lost;
    struct orl_bsdf_make_request to;
    struct orl_bsdf_make_result made = {0}, more = {0};
    struct orl_error err = {0};
    double cull_fraction = 0;
    (void)state;
    orl_bsdf_make_request_init(&to);
    to.basis = ORL_BSDF_TENSOR_TREE_4;
    to.resolution = 8;
    assert_int_equal(orl_bsdf_convert_within(tree, "a fixture", &to, within, &env, &cull_fraction,
                                             &made, &lost, &err),
                     0);
    assert_true(cull_fraction > ORL_BSDF_CULL_FRACTION && worst(&lost) <= within &&
                worst(&lost) > 0);
    struct orl_bsdf_make_result whole = convert(tree, ORL_BSDF_TENSOR_TREE_4, 8, 0);
    assert_true(made.xml_size < whole.xml_size);
    to.cull = 0;
    to.cull_fraction = 3 * cull_fraction;
    assert_int_equal(orl_bsdf_convert(tree, "a fixture", &to, &env, &more, &err), 0);
    struct orl_bsdf *culled = panel_read(&more);
    assert_int_equal(orl_bsdf_compare(tree, culled, env.pool, NULL, &lost, NULL), 0);
    assert_true(worst(&lost) > within);
    orl_bsdf_unref(culled);
    orl_bsdf_make_result_done(&more);
    orl_bsdf_make_result_done(&whole);
    orl_bsdf_make_result_done(&made);
    to.resolution = 4; /* these cells are too wide for that */
    assert_int_equal(orl_bsdf_convert_within(tree, "a fixture", &to, 1e-4, &env, &cull_fraction,
                                             &made, &lost, &err),
                     ORL_ERR_RANGE);
    assert_non_null(strstr(err.message, "the resolution loses"));
    orl_thread_pool_stop(env.pool);
    orl_bsdf_unref(tree);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_basis_is_the_same),
        cmocka_unit_test(light_in_all_is_kept),
        cmocka_unit_test(differences_are_told),
        cmocka_unit_test(a_cull_loses_what_it_may),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
