/*
 * Peak extraction for aBSDF: a peak is found exactly where there is one, and its straight and
 * scattered light sum to the file's transmission.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double z = sqrt(1 - uniform(random)), s = sqrt(1 - z * z);
    const double phi = 2 * ORL_PI * uniform(random);
    return orl_v3(s * cos(phi), s * sin(phi), uniform(random) < 0.5 ? z : -z);
}

/* Returns the centre of cell k of a hemisphere with `side` cells per axis, by the map of Shirley
 * and Chiu, rotated by `turn`. */
static struct orl_vec3 cell_centre(int k, int side, double turn)
{
    const double a = (k % side + 0.5) * 2 / side - 1, b = (k / side % side + 0.5) * 2 / side - 1;
    const double r = fmax(fabs(a), fabs(b));
    const double phi = fabs(a) >= fabs(b) ? ORL_PI / 4 * b / a + (a < 0 ? ORL_PI : 0)
                                          : ORL_PI / 2 - ORL_PI / 4 * a / b + (b < 0 ? ORL_PI : 0);
    return orl_v3(r * cos(phi + turn), r * sin(phi + turn), sqrt(1 - r * r));
}

/*
 * Integrates the light that is not straight over the transmitted hemisphere: an exact sum over
 * cells. In rank 3 the cells rotate with the light.
 */
static double scattered(const struct orl_bsdf *bsdf, struct orl_vec3 in, int side, bool turns)
{
    const double turn = turns ? atan2(in.y, in.x) + ORL_PI : 0;
    double sum = 0;
    for (int k = 0; k < side * side; k++) {
        struct orl_vec3 out = cell_centre(k, side, turn);
        out.z = in.z > 0 ? -out.z : out.z;
        sum += orl_luma(orl_bsdf_eval(bsdf, in, out)) * (1 - orl_bsdf_straight_part(bsdf, in, out));
    }
    return sum * ORL_PI / (side * side);
}

static void check_sum(const struct orl_bsdf *bsdf, int side, bool turns, double straight)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    for (int i = 0; i < 100; i++) {
        const struct orl_vec3 in = any_direction(&random);
        const double s = orl_luma(orl_bsdf_straight(bsdf, in));
        const double albedo = orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT));
        assert_true(fabs(s - straight) < 1e-5 * straight);
        assert_true(fabs(s + scattered(bsdf, in, side, turns) - albedo) < 1e-6);
    }
}

static void a_clear_panes_peak_is_all_that_is_straight(void **state)
{
    struct orl_bsdf *bsdf = load_text(make_clear_file(4, 0.6, 0.2));
    (void)state;
    assert_non_null(bsdf);
    check_sum(bsdf, 16, false, 0.6);
    orl_bsdf_unref(bsdf);
}

static void a_peak_of_rank_three_is_found(void **state)
{
    struct orl_bsdf *bsdf = load_text(make_clear_iso_file(4, 0.5, 0.2));
    (void)state;
    assert_non_null(bsdf);
    check_sum(bsdf, 16, true, 0.5);
    orl_bsdf_unref(bsdf);
}

/* Returns a file with a matrix in its own basis: one cell of the other side, and a constant
 * elsewhere. */
static struct text clear_matrix(double straight, double spread)
{
    /* Klems Quarter by its definition, as in core/bsdf/matrix/matrix.c. */
    static const double edges[] = {0, 9, 27, 45, 63, 90};
    static const int cells[] = {1, 8, 12, 12, 8};
    double omega[41];
    struct text t;
    int n = 0;
    for (int r = 0; r < 5; r++)
        for (int k = 0; k < cells[r]; k++)
            omega[n++] = ORL_PI / cells[r] *
                         (pow(cos(edges[r] * ORL_DEG_TO_RAD), 2) -
                          pow(cos(edges[r + 1] * ORL_DEG_TO_RAD), 2));
    text_open(&t);
    make_head(t.stream, "Columns");
    make_block_head(t.stream, "Visible", "Transmission Front", "LBNL/Klems Quarter");
    for (int out = 0; out < n; out++)
        for (int in = 0; in < n; in++)
            fprintf(t.stream, "%.9g,\n", spread / ORL_PI + (in == out ? straight / omega[in] : 0));
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t;
}

static void a_matrixs_straight_cell_is_its_peak(void **state)
{
    struct orl_bsdf *bsdf = load_text(clear_matrix(0.6, 0.1));
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 0);
    (void)state;
    assert_non_null(bsdf);
    for (int i = 0; i < 1000; i++) {
        const struct orl_vec3 in = any_direction(&random);
        assert_true(fabs(orl_luma(orl_bsdf_straight(bsdf, in)) - 0.6) < 1e-5);
        assert_true(fabs(orl_bsdf_straight_part(bsdf, in, orl_neg(in)) *
                             orl_luma(orl_bsdf_eval(bsdf, in, orl_neg(in))) -
                         (orl_luma(orl_bsdf_eval(bsdf, in, orl_neg(in))) - 0.1 / ORL_PI)) < 1e-5);
    }
    orl_bsdf_unref(bsdf);
}

/* BSDFs that only scatter, or have broad lobes, have no peak: aBSDF equals BSDF. */
static void broad_lobes_are_no_peak(void **state)
{
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 0);
    struct orl_bsdf *const bsdf[] = {
        load_text(make_file("TensorTree4", "Transmission Front", NULL, "{0.2}")),
        load_text(clear_matrix(0.05, 0.5)),
    };
    (void)state;
    for (size_t k = 0; k < sizeof bsdf / sizeof *bsdf; k++) {
        assert_non_null(bsdf[k]);
        for (int i = 0; i < 200; i++)
            assert_true(orl_luma(orl_bsdf_straight(bsdf[k], any_direction(&random))) == 0);
        orl_bsdf_unref(bsdf[k]);
    }
}

/*
 * For either given direction, the mean weight of straight samples is the straight share of the
 * light's direction, and that of all samples is the total. Tolerance: four standard deviations of
 * a binomial, because weights are constant.
 */
static void check_draws(const struct orl_bsdf *bsdf, bool adjoint)
{
    enum { DRAWS = 20000 };
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, adjoint);
    for (int g = 0; g < 12; g++) {
        const struct orl_vec3 given = any_direction(&random);
        const struct orl_vec3 in = adjoint ? orl_neg(given) : given;
        const double straight = orl_luma(orl_bsdf_straight(bsdf, in));
        double sum = 0, most = 0;
        if (!(straight > 0))
            continue;
        for (int i = 0; i < DRAWS; i++) {
            const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
            struct orl_bsdf_sample_result draw;
            assert_true(orl_bsdf_sample_split(bsdf, given, adjoint, ORL_BSDF_TRANSMIT, u, &draw));
            if (!draw.straight)
                continue;
            assert_true(draw.direction.x == -given.x && draw.direction.z == -given.z);
            sum += orl_luma(draw.weight);
            most = fmax(most, orl_luma(draw.weight));
        }
        const double p = straight / most;
        assert_true(fabs(sum / DRAWS - straight) < 4 * most * sqrt(p * (1 - p) / DRAWS) + 1e-5);
    }
}

static void draws_go_straight_as_often_as_they_should(void **state)
{
    struct orl_bsdf *const bsdf[] = {
        load_text(make_clear_file(4, 0.6, 0.2)),
        load_text(make_clear_iso_file(4, 0.5, 0.2)),
        load_text(clear_matrix(0.6, 0.1)),
        load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml")),
        load_text(read_fixture("tests/fixtures/bsdf_klems41.xml")),
    };
    (void)state;
    for (size_t k = 0; k < sizeof bsdf / sizeof *bsdf; k++) {
        assert_non_null(bsdf[k]);
        check_draws(bsdf[k], false);
        check_draws(bsdf[k], true);
        orl_bsdf_unref(bsdf[k]);
    }
}

/* A red pane's straight light has the colour of the rest. */
static void the_peak_has_its_colour(void **state)
{
    struct orl_bsdf *bsdf = load_text(make_tinted_file(4, 0.15, 0.05, 0.45, 0.52));
    const struct orl_vec3 in = orl_v3(0.3, 0.2, -sqrt(1 - 0.13));
    struct orl_rgb straight, albedo;
    (void)state;
    assert_non_null(bsdf);
    straight = orl_bsdf_straight(bsdf, in);
    albedo = orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH);
    assert_true(fabs(orl_luma(straight) - 0.15) < 1e-6);
    assert_true(straight.r > 2 * straight.g && albedo.r > 0.2);
    assert_true(fabs(straight.r / albedo.r - 0.75) < 1e-4);
    assert_true(fabs(straight.b - 0.75 * albedo.b) < 1e-4);
    orl_bsdf_unref(bsdf);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clear_panes_peak_is_all_that_is_straight),
        cmocka_unit_test(a_peak_of_rank_three_is_found),
        cmocka_unit_test(a_matrixs_straight_cell_is_its_peak),
        cmocka_unit_test(broad_lobes_are_no_peak),
        cmocka_unit_test(draws_go_straight_as_often_as_they_should),
        cmocka_unit_test(the_peak_has_its_colour),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
