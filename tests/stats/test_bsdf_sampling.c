/*
 * The contract of BSDFs: samples follow their pdf, the pdf is that of f |cos|, integrals agree.
 *
 * The square of the other direction is cut into cells of equal projected solid angle, on each side
 * of the surface. Samples are counted per cell and compared with the pdf by Pearson's chi-square;
 * cells with fewer than 10 expected samples are pooled. Seeds are fixed, so the outcome is too.
 * The threshold still allows for chance: 1e-3 for the whole file, divided by its number of
 * comparisons (Bonferroni).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "bsdf/loaded_bsdf.h"
#include "fixtures/bsdf_make.h"

enum {
    SIDE = 32, /* cells per axis in which samples are counted */
    CELLS = 2 * SIDE * SIDE,
    FINE = 16, /* points per axis of a cell in which the pdf is integrated */
    DRAWS = 20000,
    GIVEN = 2, /* given directions per BSDF, side and direction of sampling */
    BSDFS = 10,
    PREPARED = 3, /* BSDFs for which tables are built */
    COMPARISONS = BSDFS * 2 * 3 * GIVEN + PREPARED * 2,
};

static const double significance = 1e-3 / COMPARISONS;

struct fixture {
    struct orl_bsdf *bsdf[BSDFS];
};

/* A matrix with bases defined in the file: three rings in, two out, some cells wide. */
static struct orl_bsdf *load_own_basis(void)
{
    static const struct make_ring in[] = {{1, 20}, {5, 50}, {3, 90}, {0, 0}};
    static const struct make_ring out[] = {{1, 40}, {7, 90}, {0, 0}};
    struct text own;
    text_open(&own);
    make_basis(own.stream, "in", in);
    make_basis(own.stream, "out", out);
    text_close(&own);
    struct orl_bsdf *bsdf = load_text(make_matrix_file("Columns", own.data, "in", 9, "out", 8));
    free(own.data);
    return bsdf;
}

static int load_all(void **state)
{
    static struct fixture fixture;
    fixture.bsdf[0] = load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml"));
    fixture.bsdf[1] = load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"));
    fixture.bsdf[2] = load_text(make_tree_file(4));
    fixture.bsdf[3] =
        load_text(make_file("TensorTree4", "Transmission Back", NULL,
                            "{{0}{0}{1e-12}{0}{0}{3}{0}{0}{0}{0}{0}{0}{0}{0}{1}{.2}}"));
    fixture.bsdf[4] = load_text(make_iso_file(4));
    fixture.bsdf[5] =
        load_text(make_matrix_file("Columns", "", "LBNL/Klems Full", 145, "LBNL/Klems Full", 145));
    fixture.bsdf[6] =
        load_text(make_matrix_file("Rows", "", "LBNL/Klems Half", 77, "LBNL/Klems Half", 77));
    fixture.bsdf[7] =
        load_text(make_matrix_file("Rows", "", "LBNL/Klems Quarter", 41, "LBNL/Klems Full", 145));
    fixture.bsdf[8] = load_own_basis();
    fixture.bsdf[9] = load_text(make_tinted_file(4, 0.2, 0.1, 0.3, 0.5));
    *state = &fixture;
    for (int i = 0; i < BSDFS; i++)
        if (!fixture.bsdf[i])
            return -1;
    return 0;
}

static int unload_all(void **state)
{
    struct fixture *fixture = *state;
    for (int i = 0; i < BSDFS; i++)
        orl_bsdf_unref(fixture->bsdf[i]);
    return 0;
}

/* ---- An independent map of the hemisphere ---------------------------------------------------- */

/* Returns a direction from (cos^2, azimuth): equal areas are equal projected solid angles.
 * Independent of the map in the code under test. */
static struct orl_vec3 square_to_direction(double u, double v, bool front)
{
    const double cosine = sqrt(1 - u), sine = sqrt(u), azimuth = 2 * ORL_PI * v;
    return orl_v3(sine * cos(azimuth), sine * sin(azimuth), front ? cosine : -cosine);
}

static int cell_of(struct orl_vec3 d)
{
    double v = atan2(d.y, d.x) / (2 * ORL_PI);
    const int i = (int)((1 - d.z * d.z) * SIDE);
    int j;
    v = v < 0 ? v + 1 : v;
    j = (int)(v * SIDE);
    return ((d.z > 0) * SIDE + (i < SIDE ? i : SIDE - 1)) * SIDE + (j < SIDE ? j : SIDE - 1);
}

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double u = uniform(random), v = uniform(random);
    return square_to_direction(u, v, uniform(random) < 0.5);
}

/* ---- Chi-square ------------------------------------------------------------------------------ */

/* Returns the upper tail by Wilson and Hilferty's cube root; a few percent accurate this far out.
 */
static double chi_square_tail(double x, int degrees)
{
    const double k = degrees, z = (cbrt(x / k) - (1 - 2 / (9 * k))) / sqrt(2 / (9 * k));
    return 0.5 * erfc(z / sqrt(2));
}

static double p_value(const double *expected, const double *counted)
{
    double pooled_expected = 0, pooled_counted = 0, x = 0;
    int cells = 0;
    for (int i = 0; i < CELLS; i++) {
        if (expected[i] < 10) {
            pooled_expected += expected[i];
            pooled_counted += counted[i];
            continue;
        }
        x += (counted[i] - expected[i]) * (counted[i] - expected[i]) / expected[i];
        cells++;
    }
    if (pooled_expected >= 10) {
        x += (pooled_counted - pooled_expected) * (pooled_counted - pooled_expected) /
             pooled_expected;
        cells++;
    } else if (pooled_counted > 40) {
        return 0; /* samples where almost none are expected */
    }
    return cells > 1 ? chi_square_tail(x, cells - 1) : 1;
}

/* A way to sample a direction; `incident` has tables built in advance, or is NULL. */
struct way {
    bool adjoint;
    enum orl_bsdf_side sides;
    const struct orl_cone_table *cone_table;
};

static double pdf_of(const struct orl_bsdf *bsdf, const struct way *way, struct orl_vec3 given,
                     struct orl_vec3 other)
{
    return way->adjoint ? orl_bsdf_pdf_adjoint(bsdf, given, way->sides, other)
                        : orl_bsdf_pdf(bsdf, given, way->sides, other);
}

static bool sample_direction(const struct orl_bsdf *bsdf, const struct way *way,
                             struct orl_vec3 given, const double u[3], struct orl_vec3 *other,
                             struct orl_rgb *weight, double *pdf)
{
    if (way->cone_table) {
        *pdf = 0; /* sampling by tables returns no pdf */
        return orl_cone_table_sample(way->cone_table, given, u, other, weight);
    }
    return way->adjoint ? orl_bsdf_sample_adjoint(bsdf, given, way->sides, u, other, weight, pdf)
                        : orl_bsdf_sample(bsdf, given, way->sides, u, other, weight, pdf);
}

/* Returns f |cos| of the pair, for either given direction. */
static double scattered(const struct orl_bsdf *bsdf, const struct way *way, struct orl_vec3 given,
                        struct orl_vec3 other)
{
    const struct orl_rgb f =
        way->adjoint ? orl_bsdf_eval(bsdf, other, given) : orl_bsdf_eval(bsdf, given, other);
    return orl_luma(f) * fabs(other.z);
}

/*
 * Integrates the pdf over every cell, at jittered points so that no border of the data stays
 * hidden between them. Returns the sum over all cells.
 */
static double expect(const struct orl_bsdf *bsdf, const struct way *way, struct orl_vec3 given,
                     struct orl_random *random, double *ret_expected)
{
    const double share = ORL_PI / (SIDE * SIDE) / (FINE * FINE);
    double total = 0;
    for (int cell = 0; cell < CELLS; cell++) {
        double sum = 0;
        for (int k = 0; k < FINE * FINE; k++) {
            const double u = cell / SIDE % SIDE + (k / FINE + uniform(random)) / FINE;
            const double v = cell % SIDE + (k % FINE + uniform(random)) / FINE;
            const struct orl_vec3 d = square_to_direction(u / SIDE, v / SIDE, cell >= SIDE * SIDE);
            sum += pdf_of(bsdf, way, given, d) / fabs(d.z);
        }
        ret_expected[cell] = sum * share;
        total += sum * share;
    }
    return total;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void check_draws(const struct orl_bsdf *bsdf, const struct way *way, struct orl_vec3 given,
                        struct orl_random *random, int label)
{
    static double expected[CELLS], counted[CELLS];
    const double centre[3] = {0.5, 0.5, 0.5};
    struct orl_vec3 some;
    struct orl_rgb ignored;
    double total, p;
    if (!sample_direction(bsdf, way, given, centre, &some, &ignored, &p))
        return; /* black on these sides */
    total = expect(bsdf, way, given, random, expected);
    assert_true(fabs(total - 1) < 1e-2); /* the error is jitter; sampling is exact below */
    memset(counted, 0, sizeof counted);
    for (int i = 0; i < DRAWS; i++) {
        const double u[3] = {uniform(random), uniform(random), uniform(random)};
        struct orl_vec3 other;
        struct orl_rgb weight;
        double pdf;
        assert_true(sample_direction(bsdf, way, given, u, &other, &weight, &pdf));
        counted[cell_of(other)]++;
    }
    for (int c = 0; c < CELLS; c++)
        expected[c] *= DRAWS / total;
    p = p_value(expected, counted);
    if (p < significance)
        fail_msg("BSDF %d, adjoint %d, sides %d, tables %d: p = %g", label, way->adjoint,
                 way->sides, way->cone_table != NULL, p);
}

static void draws_follow_the_pdf(void **state)
{
    const struct fixture *fixture = *state;
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 1);
    for (int b = 0; b < BSDFS; b++)
        for (int adjoint = 0; adjoint < 2; adjoint++)
            for (int sides = ORL_BSDF_REFLECT; sides <= ORL_BSDF_BOTH; sides++) {
                const struct way way = {adjoint, (enum orl_bsdf_side)sides, NULL};
                for (int g = 0; g < GIVEN; g++)
                    check_draws(fixture->bsdf[b], &way, any_direction(&random), &random, b);
            }
}

/* Sampling by tables has the distribution and the weights of a descent through the data; also
 * beyond the tables' cone. */
static void tables_of_a_cone_follow_the_pdf(void **state)
{
    static const int trees[PREPARED] = {0, 2, 3};
    const struct fixture *fixture = *state;
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, 1);
    for (int i = 0; i < 2 * PREPARED; i++) {
        const struct orl_bsdf *bsdf = fixture->bsdf[trees[i / 2]];
        /* Light comes from above the horizon and from above the surface, or from below both. */
        const double side = i % 2 ? 1 : -1;
        const struct orl_vec3 middle =
            orl_normalize(orl_v3(0.31 * side, -0.22 * side, trees[i / 2] == 3 ? 0.8 : 0.8 * side));
        struct way way = {false, ORL_BSDF_TRANSMIT, NULL};
        struct orl_cone_table *cone_table;
        assert_int_equal(orl_cone_table_new(bsdf, middle, 0.0047, &cone_table), 0);
        assert_non_null(cone_table);
        way.cone_table = cone_table;
        check_draws(bsdf, &way, middle, &random, trees[i / 2]);
        for (int k = 0; k < 1000; k++) {
            const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
            const double spread = k % 2 ? 0.003 : 2;
            const struct orl_vec3 in = orl_normalize(
                orl_add(middle, orl_scale(orl_v3(u[0] - 0.5, u[1] - 0.5, u[2] - 0.5), spread)));
            struct orl_vec3 out, other;
            struct orl_rgb weight, expected;
            double pdf;
            const bool drawn = orl_cone_table_sample(cone_table, in, u, &out, &weight);
            assert_int_equal(
                drawn, orl_bsdf_sample(bsdf, in, ORL_BSDF_TRANSMIT, u, &other, &expected, &pdf));
            if (!drawn)
                continue;
            assert_true((out.z > 0) != (in.z > 0) && fabs(orl_length(out) - 1) < 1e-12);
            assert_true(orl_luma(orl_bsdf_eval(bsdf, in, out)) > 0);
            assert_true(weight.r == expected.r && weight.b == expected.b);
        }
        orl_cone_table_free(cone_table);
    }
}

/* Data that tables cannot represent has none: matrices, trees of rank 3, colour. */
static void other_data_have_no_tables(void **state)
{
    static const int others[] = {1, 4, 5, 9};
    const struct fixture *fixture = *state;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct orl_cone_table *cone_table;
        assert_int_equal(
            orl_cone_table_new(fixture->bsdf[others[i]], orl_v3(0.6, 0, -0.8), 0.0047, &cone_table),
            0);
        assert_null(cone_table);
    }
}

/* The sample, its value and its pdf use the same cell; directions are unit vectors and never
 * level. */
static void draws_values_and_pdfs_agree(void **state)
{
    const struct fixture *fixture = *state;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 1);
    int drawn = 0;
    for (int i = 0; i < 200000; i++) {
        static const double edge[] = {0, 0x1p-53, 0.5, 1 - 0x1p-53, 0.25, 0x1p-60, 0.75};
        const struct orl_bsdf *bsdf = fixture->bsdf[i % BSDFS];
        const struct way way = {i / BSDFS % 2, (enum orl_bsdf_side)(1 + i / (2 * BSDFS) % 3), NULL};
        const struct orl_vec3 given = any_direction(&random);
        double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
        struct orl_vec3 other;
        struct orl_rgb weight;
        double pdf, value;
        for (int k = 0; k < 3; k++) /* half of the numbers are at the edges of the unit interval */
            if (uniform(&random) < 0.5)
                u[k] = edge[(int)(uniform(&random) * 7)];
        if (!sample_direction(bsdf, &way, given, u, &other, &weight, &pdf))
            continue;
        drawn++;
        value = scattered(bsdf, &way, given, other);
        assert_true(pdf > 0 && value > 0);
        assert_true(pdf == pdf_of(bsdf, &way, given, other));
        assert_true(fabs(orl_luma(weight) * pdf / value - 1) < 1e-12);
        assert_true(fabs(orl_length(other) - 1) < 1e-14 && other.z != 0);
        assert_true(way.sides == ORL_BSDF_BOTH ||
                    ((given.z > 0) == (other.z > 0)) == (way.sides == ORL_BSDF_REFLECT));
    }
    assert_in_range(drawn, 100000, 200000);
}

/* Directions with precomputed places have the values and pdfs of plain ones. Values and pdfs are
 * constant within a cell of incident directions. */
static void placed_directions_have_the_same_values(void **state)
{
    const struct fixture *fixture = *state;
    struct orl_random random = orl_random_stream(11, ORL_PURPOSE_BENCH, 0);
    size_t alike = 0, apart = 0;
    for (int i = 0; i < BSDFS; i++)
        for (int n = 0; n < 400; n++) {
            const struct orl_bsdf *bsdf = fixture->bsdf[i];
            const bool front = n & 1;
            const double u = uniform(&random), v = uniform(&random);
            const struct orl_vec3 in = square_to_direction(u, v, front);
            const struct orl_vec3 out =
                square_to_direction(uniform(&random), uniform(&random), !front);
            const struct orl_vec3 near =
                square_to_direction(fmin(u + 0.01 * uniform(&random), 1), v, front);
            const struct orl_bsdf_incidence a = orl_bsdf_locate_incident(bsdf, in);
            const struct orl_bsdf_incidence b = orl_bsdf_locate_incident(bsdf, near);
            const struct orl_bsdf_direction to = orl_bsdf_locate(bsdf, out);
            double pdf, near_pdf;
            const struct orl_rgb f = orl_bsdf_transmit(bsdf, &a, &to, &pdf);
            const struct orl_rgb near_f = orl_bsdf_transmit(bsdf, &b, &to, &near_pdf);
            const struct orl_rgb expected = orl_bsdf_eval(bsdf, in, out);
            assert_memory_equal(&f, &expected, sizeof f);
            assert_true(pdf == orl_bsdf_pdf(bsdf, in, ORL_BSDF_TRANSMIT, out));
            if (!orl_bsdf_in_one_cell(bsdf, &a, &b)) {
                apart++;
                continue;
            }
            assert_memory_equal(&f, &near_f, sizeof f);
            assert_true(pdf == near_pdf);
            alike++;
        }
    assert_true(alike > 1000 && apart > 500);
}

/* The albedo against jittered quadrature that ignores cells; steps of the data leave an error of
 * 0.2 %. */
static void albedo_is_the_integral_of_f(void **state)
{
    const struct fixture *fixture = *state;
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 1);
    for (int i = 0; i < 36; i++) {
        static const int smooth[] = {0, 1, 2, 4, 5, 6, 7, 8, 9}; /* BSDF 3 has only 16 cells */
        const struct orl_bsdf *bsdf = fixture->bsdf[smooth[i % 9]];
        const struct orl_vec3 in = any_direction(&random);
        const int n = 512;
        double sum = 0;
        for (int k = 0; k < 2 * n * n; k++) {
            const double u = (k / n % n + uniform(&random)) / n;
            const double v = (k % n + uniform(&random)) / n;
            sum += orl_luma(orl_bsdf_eval(bsdf, in, square_to_direction(u, v, k >= n * n)));
        }
        sum *= ORL_PI / ((double)n * n);
        assert_true(fabs(sum / orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH)) - 1) < 1e-2);
    }
}

/* Exact for a tree of 2^3: one point in each cell of the square gives the integral. */
static void a_trees_integrals_are_sums_over_its_cells(void **state)
{
    const struct orl_bsdf *bsdf = ((const struct fixture *)*state)->bsdf[0];
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 1);
    for (int i = 0; i < 200; i++) {
        const struct orl_vec3 in = any_direction(&random);
        double sum = 0, pdf = 0, adjoint = 0;
        for (int k = 0; k < 128; k++) {
            /* The centre of a cell, by the map of Shirley and Chiu, from the paper. */
            const double a = (k % 8 + 0.5) / 4 - 1, b = (k / 8 % 8 + 0.5) / 4 - 1;
            const double r = fmax(fabs(a), fabs(b));
            const double phi = fabs(a) >= fabs(b)
                                   ? ORL_PI / 4 * b / a + (a < 0 ? ORL_PI : 0)
                                   : ORL_PI / 2 - ORL_PI / 4 * a / b + (b < 0 ? ORL_PI : 0);
            const double z = sqrt(1 - r * r);
            const struct orl_vec3 d = orl_v3(r * cos(phi), r * sin(phi), k < 64 ? z : -z);
            sum += orl_luma(orl_bsdf_eval(bsdf, in, d));
            pdf += orl_bsdf_pdf(bsdf, in, ORL_BSDF_BOTH, d) / z;
            adjoint += orl_bsdf_pdf_adjoint(bsdf, in, ORL_BSDF_BOTH, d) / z;
        }
        sum *= ORL_PI / 64;
        assert_true(fabs(sum - orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH))) < 1e-6);
        assert_true(fabs(pdf * ORL_PI / 64 - 1) < 1e-6);
        assert_true(fabs(adjoint * ORL_PI / 64 - 1) < 1e-6);
    }
}

/*
 * A matrix with bases defined in the file: the cells of a ring have pi (cos^2 - cos^2) over their
 * number, and light from inside uses the file's Back data.
 */
static void a_matrixs_integrals_are_sums_over_its_cells(void **state)
{
    const struct orl_bsdf *bsdf = ((const struct fixture *)*state)->bsdf[8];
    const double c40 = pow(cos(40 * ORL_DEG_TO_RAD), 2);
    for (int front = 0; front < 2; front++) {
        /* The middle of the pole's cell; and cell 0 of ring 1, where light travels along +x. */
        const double angle[] = {0, 35 * ORL_DEG_TO_RAD};
        for (int in = 0; in < 2; in++) {
            const struct orl_vec3 d =
                orl_v3(-sin(angle[in]), 0, front ? cos(angle[in]) : -cos(angle[in]));
            for (int transmitted = 0; transmitted < 2; transmitted++) {
                const int k = (transmitted ? 0 : 2) + front;
                double sum = 0;
                for (int out = 0; out < 8; out++)
                    sum += make_matrix_value(k, in, out) * ORL_PI * (out == 0 ? 1 - c40 : c40 / 7);
                const enum orl_bsdf_side side = transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT;
                assert_true(fabs(orl_luma(orl_bsdf_albedo(bsdf, d, side)) - sum) < 1e-6);
            }
        }
    }
}

/* The panel file has one transmission; the other is its transpose, and the adjoint samples the
 * same distribution. */
static void a_filled_in_transmission_is_reciprocal(void **state)
{
    const struct orl_bsdf *bsdf = ((const struct fixture *)*state)->bsdf[0];
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 1);
    for (int i = 0; i < 20000; i++) {
        struct orl_vec3 in = any_direction(&random), out = any_direction(&random);
        const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
        struct orl_vec3 forward, adjoint;
        struct orl_rgb weight[2];
        double pdf[2];
        if ((in.z > 0) == (out.z > 0))
            out.z = -out.z;
        assert_true(orl_luma(orl_bsdf_eval(bsdf, in, out)) ==
                    orl_luma(orl_bsdf_eval(bsdf, out, in)));
        assert_true(orl_bsdf_sample(bsdf, in, ORL_BSDF_TRANSMIT, u, &forward, &weight[0], &pdf[0]));
        assert_true(
            orl_bsdf_sample_adjoint(bsdf, in, ORL_BSDF_TRANSMIT, u, &adjoint, &weight[1], &pdf[1]));
        assert_true(forward.x == adjoint.x && forward.y == adjoint.y && forward.z == adjoint.z);
        assert_true(pdf[0] == pdf[1]);
    }
}

/* A cell of 1e-12 of its neighbours is almost never sampled, and black cells never. */
static void a_sliver_does_no_harm(void **state)
{
    const struct orl_bsdf *bsdf = ((const struct fixture *)*state)->bsdf[3];
    struct orl_random random = orl_random_stream(6, ORL_PURPOSE_BENCH, 1);
    /* Light travelling towards (-, +) finds the sliver at B (-, -) and 1 at B (+, +). */
    const struct orl_vec3 in = orl_v3(0.5, -0.5, sqrt(0.5));
    for (int i = 0; i < 1000000; i++) {
        const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
        struct orl_vec3 out;
        struct orl_rgb weight;
        double pdf;
        assert_true(orl_bsdf_sample(bsdf, in, ORL_BSDF_BOTH, u, &out, &weight, &pdf));
        assert_true(out.x > 0 && out.y > 0 && out.z < 0);
    }
    assert_true(orl_bsdf_pdf(bsdf, in, ORL_BSDF_BOTH, orl_v3(-0.5, -0.5, -sqrt(0.5))) > 0);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_follow_the_pdf),
        cmocka_unit_test(tables_of_a_cone_follow_the_pdf),
        cmocka_unit_test(other_data_have_no_tables),
        cmocka_unit_test(draws_values_and_pdfs_agree),
        cmocka_unit_test(placed_directions_have_the_same_values),
        cmocka_unit_test(albedo_is_the_integral_of_f),
        cmocka_unit_test(a_trees_integrals_are_sums_over_its_cells),
        cmocka_unit_test(a_matrixs_integrals_are_sums_over_its_cells),
        cmocka_unit_test(a_filled_in_transmission_is_reciprocal),
        cmocka_unit_test(a_sliver_does_no_harm),
    };
    return cmocka_run_group_tests(tests, load_all, unload_all);
}
