/* The meaning of BSDF files; it does not depend on other loaded BSDFs or on the calling thread. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <oriel/base/thread_pool.h>

#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"

/*
 * Values in the quadrants of the square: child bit i is axis i, A (the first two) is where the
 * light travels, B where it leaves.
 */
static void a_tree_numbers_its_children_by_axis(void **state)
{
    struct orl_bsdf *bsdf =
        load_text(make_file("TensorTree4", "Reflection Front", NULL,
                            "{{0}{.03125}{.0625}{.09375}{.125}{.15625}{.1875}{.21875}{.25}{.28125}{"
                            ".3125}{.34375}{.375}{.40625}{.4375}{.46875}}"));
    (void)state;
    assert_non_null(bsdf);
    for (int i = 0; i < 16; i++) {
        const double ax = i & 1 ? 0.3 : -0.3, ay = i & 2 ? 0.2 : -0.2;
        const double bx = i & 4 ? 0.3 : -0.3, by = i & 8 ? 0.2 : -0.2;
        /* The file's Front is z < 0; light from (-x, -y) travels to (x, y). */
        assert_close(eval(bsdf, direction(-ax, -ay, -1), direction(bx, by, -1)), i / 32.0, 0);
        assert_close(eval(bsdf, direction(-ax, -ay, 1), direction(bx, by, 1)), 0, 0);
        assert_close(eval(bsdf, direction(-ax, -ay, -1), direction(bx, by, 1)), 0, 0);
    }
    orl_bsdf_unref(bsdf);
}

static void a_grid_runs_its_last_axis_fastest(void **state)
{
    struct orl_bsdf *grid =
        load_text(make_file("TensorTree4", "Reflection Back", NULL,
                            "{0 .25 .125 .375 .0625 .3125 .1875 .4375 .03125 .28125 .15625 .40625 "
                            ".09375 .34375 .21875 .46875}"));
    struct orl_bsdf *braces =
        load_text(make_file("TensorTree4", "Reflection Back", NULL,
                            "{{0}{.03125}{.0625}{.09375}{.125}{.15625}{.1875}{.21875}{.25}{.28125}{"
                            ".3125}{.34375}{.375}{.40625}{.4375}{.46875}}"));
    (void)state;
    assert_non_null(grid);
    assert_non_null(braces);
    for (int i = 0; i < 16; i++) {
        const struct orl_vec3 in = direction(i & 1 ? 0.4 : -0.4, i & 2 ? 0.1 : -0.1, 1);
        const struct orl_vec3 out = direction(i & 4 ? 0.2 : -0.2, i & 8 ? 0.5 : -0.5, 1);
        assert_close(eval(grid, in, out), eval(braces, in, out), 0);
    }
    orl_bsdf_unref(grid);
    orl_bsdf_unref(braces);
}

/* Light from the interior is the file's Transmission Back; the other direction follows by
 * reciprocity. */
static void a_missing_transmission_is_the_transpose(void **state)
{
    struct orl_bsdf *bsdf =
        load_text(make_file("TensorTree4", "Transmission Back", NULL,
                            "{0 .125 .0625 .1875 .03125 .15625 .09375 .21875 .015625 .140625 "
                            ".078125 .203125 .046875 .171875 .109375 .234375}"));
    struct orl_bsdf_info info;
    (void)state;
    assert_non_null(bsdf);
    for (int i = 0; i < 256; i++) {
        const struct orl_vec3 in = direction(i % 4 * 0.4 - 0.6, i / 4 % 4 * 0.3 - 0.5, 1);
        const struct orl_vec3 out = direction(i / 16 % 4 * 0.4 - 0.5, i / 64 * 0.4 - 0.6, -1);
        const int cell = (in.x < 0) | (in.y < 0) << 1 | (out.x > 0) << 2 | (out.y > 0) << 3;
        assert_close(eval(bsdf, in, out), cell / 64.0, 0);
        assert_close(eval(bsdf, out, in), cell / 64.0, 0);
    }
    orl_bsdf_describe(bsdf, &info);
    assert_true(info.has[1][1]);
    assert_false(info.has[0][1]);
    assert_int_equal(info.values, 16);
    assert_string_equal(info.kind, "TensorTree4");
    orl_bsdf_unref(bsdf);
}

/*
 * Rank 3: bit 0 is A, bits 1 and 2 are B once A travels along +x. A = 1, near the normal, is never
 * reached, because sines end at the middle. A common rotation of both directions keeps the value.
 */
static void a_tree_of_rank_3_turns_with_the_light(void **state)
{
    struct orl_bsdf *grid =
        load_text(make_file("TensorTree3", "Reflection Front", NULL,
                            "{0 .03125 .0625 .09375 .28125 .28125 .28125 .28125}"));
    struct orl_bsdf *braces =
        load_text(make_file("TensorTree3", "Reflection Front", NULL,
                            "{{0}{.28125}{.0625}{.28125}{.03125}{.28125}{.09375}{.28125}}"));
    struct orl_bsdf *deep = load_text(make_file(
        "TensorTree3", "Reflection Front", NULL,
        "{{0}{.28125}{{.15625}{.1875}{.15625}{.1875}{.15625}{.1875}{.15625}{.1875}}{.28125}{.03125}"
        "{.28125}{.09375 .09375 .09375 .09375 .125 .125 .125 .125}{.28125}}"));
    (void)state;
    assert_non_null(grid);
    assert_non_null(braces);
    assert_non_null(deep);
    for (int i = 0; i < 24; i++) {
        const double turn = 0.1 + i * 0.7, c = cos(turn), s = sin(turn);
        for (int cell = 0; cell < 4; cell++) {
            const double x = cell & 2 ? 0.4 : -0.3, y = cell & 1 ? 0.5 : -0.2;
            const struct orl_vec3 out = direction(x * c - y * s, x * s + y * c, -1);
            const struct orl_vec3 flat = direction(-0.8 * c, -0.8 * s, -1); /* sine 0.8 */
            const struct orl_vec3 steep = direction(-0.2 * c, -0.2 * s, -1);
            assert_close(eval(grid, flat, out), cell / 32.0, 0);
            assert_close(eval(braces, steep, out), cell / 32.0, 0);
            assert_close(eval(deep, flat, out), ((double[]){0, 1, 5, 3}[cell]) / 32, 0);
            assert_close(eval(deep, steep, out), ((double[]){0, 1, 6, 4}[cell]) / 32, 0);
        }
    }
    orl_bsdf_unref(grid);
    orl_bsdf_unref(braces);
    orl_bsdf_unref(deep);
}

static void a_tree_of_rank_3_is_not_reversed(void **state)
{
    struct orl_bsdf *bsdf =
        load_text(make_file("TensorTree3", "Transmission Front", NULL, "{0.2}"));
    struct orl_bsdf_info info;
    (void)state;
    assert_non_null(bsdf);
    assert_close(eval(bsdf, direction(0.1, 0, -1), direction(0.2, 0.3, 1)), 0.2, 1e-7);
    assert_close(eval(bsdf, direction(0.1, 0, 1), direction(0.2, 0.3, -1)), 0, 0);
    assert_close(orl_bsdf_diffuse(bsdf, false, true).g, 0.2, 1e-7);
    assert_close(orl_bsdf_albedo(bsdf, direction(0.7, 0.1, -1), ORL_BSDF_BOTH).g, 0.2 * ORL_PI,
                 1e-7);
    orl_bsdf_describe(bsdf, &info);
    assert_string_equal(info.kind, "TensorTree3");
    assert_int_equal(info.values, 1);
    orl_bsdf_unref(bsdf);
}

/* Values by Radiance 6.1a (SDevalBSDF, SDdirectHemi), which perturbs each by up to 3e-4 on
 * purpose. */
static void values_are_radiances(void **state)
{
    static const struct {
        double in[3], out[3], value, hemispherical;
    } tree[] =
        {
            {{-0.04, -0.772, -0.634362672},
             {0.146, -0.886, -0.440099989},
             5.166735053e-01,
             9.885884387e-01},
            {{0.705, 0.607, 0.366777862},
             {-0.669, 0.622, -0.406884504},
             1.085279942e+01,
             9.891997497e-01},
            {{0.023, 0.11, 0.993665437},
             {-0.023, -0.11, -0.993665437},
             1.579629898e+01,
             9.929140821e-01},
            {{-0.27, -0.246, -0.930904936},
             {0.27, 0.246, 0.930904936},
             1.217272091e+01,
             9.862783527e-01},
            {{0.484, 0.829, -0.280183868},
             {-0.484, -0.829, 0.280183868},
             2.233403683e+00,
             9.884666345e-01},
            {{0.757, -0.597, 0.26559744},
             {-0.757, -0.597, -0.26559744},
             1.085265541e+01,
             9.891997497e-01},
            {{-0.273, 0.622, 0.733884868},
             {0.302, 0.602, 0.739183333},
             5.418003798e-01,
             9.876815950e-01},
        },
      matrix[] = {
          {{-0.04, -0.772, -0.634362672},
           {0.146, -0.886, -0.440099989},
           1.243005879e-02,
           3.134788293e-01},
          {{0.705, 0.607, 0.366777862},
           {-0.669, 0.622, -0.406884504},
           4.151275903e-01,
           1.877051116e-01},
          {{-0.27, -0.246, -0.930904936},
           {0.27, 0.246, 0.930904936},
           4.795067310e-01,
           3.294720834e-01},
          {{0.757, -0.597, 0.26559744},
           {-0.757, -0.597, -0.26559744},
           4.187002331e-01,
           2.852470679e-01},
          {{-0.273, 0.622, 0.733884868},
           {0.302, 0.602, 0.739183333},
           1.446817778e-01,
           2.652753404e-01},
          {{0.508, -0.262, -0.820543722},
           {-0.223, 0.5, -0.836821964},
           7.506961748e-02,
           3.276190404e-01},
          {{-0.083, 0.546, 0.833663601},
           {0.377, 0.496, 0.782211608},
           6.781046838e-02,
           2.557772630e-01},
      };
    struct orl_bsdf *bsdfs[2] = {load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml")),
                                 load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"))};
    (void)state;
    for (int b = 0; b < 2; b++) {
        assert_non_null(bsdfs[b]);
        for (int i = 0; i < 7; i++) {
            const double *in = b ? matrix[i].in : tree[i].in,
                         *out = b ? matrix[i].out : tree[i].out;
            const double value = b ? matrix[i].value : tree[i].value;
            const struct orl_vec3 vin = orl_v3(in[0], in[1], in[2]);
            assert_close(eval(bsdfs[b], vin, orl_v3(out[0], out[1], out[2])) / value, 1, 5e-4);
            assert_close(orl_bsdf_albedo(bsdfs[b], vin, ORL_BSDF_BOTH).g,
                         b ? matrix[i].hemispherical : tree[i].hemispherical, 1e-6);
        }
        orl_bsdf_unref(bsdfs[b]);
    }
}

static void the_klems_fixture_describes_itself(void **state)
{
    struct orl_bsdf *bsdf = load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"));
    struct orl_bsdf_info info;
    (void)state;
    assert_non_null(bsdf);
    orl_bsdf_describe(bsdf, &info);
    assert_string_equal(info.name, "Test matrix");
    assert_string_equal(info.kind, "Klems Quarter");
    assert_int_equal(info.resolution, 41);
    assert_int_equal(info.values, 4 * 41 * 41);
    assert_close(info.thickness_m, 0.0125, 1e-12);
    assert_true(info.has[0][0] && info.has[0][1] && info.has[1][0] && info.has[1][1]);
    orl_bsdf_unref(bsdf);
}

/* One cell of a full Klems matrix is 1: directions inside the cell find it, those outside do not.
 */
static void the_full_klems_basis_has_its_cells_in_place(void **state)
{
    struct text t;
    struct orl_bsdf *bsdf;
    /* Ring 15 to 25 degrees, 16 cells, first index 9; the fifth is centred on 90 degrees. */
    const int cell_out = 9 + 4, cell_in = 1; /* ring 5 to 15, the first: centred on azimuth 0 */
    const double inside[][2] = {{15.01, 79}, {24.99, 101}, {20, 90}};
    const double outside[][2] = {{14.99, 90}, {25.01, 90}, {20, 78.7}, {20, 101.3}};
    const struct orl_vec3 in = direction(-sin(10 * ORL_DEG_TO_RAD), 0, -1);
    (void)state;
    text_open(&t);
    make_head(t.stream, "Columns");
    make_block_head(t.stream, "Visible", "Transmission Front", "LBNL/Klems Full");
    for (int out = 0; out < 145; out++)
        for (int i = 0; i < 145; i++)
            fputs(out == cell_out && i == cell_in ? "1\n" : "0 ", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    bsdf = load_text(t);
    assert_non_null(bsdf);
    for (int i = 0; i < 7; i++) {
        const double *angles = i < 3 ? inside[i] : outside[i - 3];
        const double s = sin(angles[0] * ORL_DEG_TO_RAD), a = angles[1] * ORL_DEG_TO_RAD;
        const struct orl_vec3 out = direction(s * cos(a), s * sin(a), 1);
        assert_close(eval(bsdf, in, out), i < 3, 0);
        assert_close(eval(bsdf, out, in), i < 3, 0); /* by reciprocity */
    }
    /* pi (cos^2 15 - cos^2 25) / 16 */
    assert_close(
        orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH).g,
        ORL_PI / 16 * (pow(cos(15 * ORL_DEG_TO_RAD), 2) - pow(cos(25 * ORL_DEG_TO_RAD), 2)), 1e-12);
    orl_bsdf_unref(bsdf);
}

static void only_visible_data_are_read(void **state)
{
    struct text t;
    struct orl_bsdf *bsdf;
    (void)state;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Solar", "Reflection Front", NULL);
    fputs("{ 0.3 }", t.stream);
    make_block_tail(t.stream);
    make_block_head(t.stream, "Visible", "Reflection Front", NULL);
    fputs("{ 0.2 }", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    bsdf = load_text(t);
    assert_non_null(bsdf);
    assert_close(eval(bsdf, direction(0, 0, -1), direction(0.5, 0, -1)), 0.2, 1e-7);
    orl_bsdf_unref(bsdf);
}

static void a_uniform_tree_is_all_diffuse_and_a_zero_one_black(void **state)
{
    struct orl_bsdf *even = load_text(make_file("TensorTree4", "Reflection Back", NULL, "{ .25 }"));
    struct orl_bsdf *zero = load_text(make_file("TensorTree4", "Reflection Back", NULL, "{ 0 }"));
    const struct orl_vec3 in = direction(0.3, -0.2, 1);
    const double u[3] = {0.1, 0.2, 0.3};
    struct orl_vec3 out;
    struct orl_rgb weight;
    double pdf;
    (void)state;
    assert_non_null(even);
    assert_non_null(zero);
    assert_close(orl_bsdf_diffuse(even, true, false).g, 0.25, 0);
    assert_close(orl_bsdf_diffuse(even, false, false).g, 0, 0);
    assert_close(orl_bsdf_albedo(even, in, ORL_BSDF_BOTH).g, 0.25 * ORL_PI, 1e-12);
    assert_close(orl_bsdf_albedo(even, in, ORL_BSDF_TRANSMIT).g, 0, 0);
    assert_true(orl_bsdf_sample(even, in, ORL_BSDF_BOTH, u, &out, &weight, &pdf));
    assert_false(orl_bsdf_sample(even, in, ORL_BSDF_TRANSMIT, u, &out, &weight, &pdf));
    assert_false(orl_bsdf_sample(zero, in, ORL_BSDF_BOTH, u, &out, &weight, &pdf));
    orl_bsdf_unref(even);
    orl_bsdf_unref(zero);
}

static void negative_values_are_cut_and_counted(void **state)
{
    struct orl_bsdf *bsdf = load_text(make_file("TensorTree4", "Reflection Front", NULL,
                                                "{-1 -1e-3 1 1 1 1 1 1 1 1 1 1 1 1 1 -0.0}"));
    struct orl_bsdf_info info;
    (void)state;
    assert_non_null(bsdf);
    orl_bsdf_describe(bsdf, &info);
    assert_int_equal(info.clamped, 2);
    assert_close(eval(bsdf, direction(0.3, 0.2, -1), direction(-0.3, -0.2, -1)), 0, 0);
    orl_bsdf_unref(bsdf);
}

/* A leaf of 2e4 1/sr in a tree of 2^8: the integral is exact even for the smallest cell. */
static void the_deepest_tree_keeps_a_tall_peak(void **state)
{
    struct text t;
    struct orl_bsdf *bsdf;
    (void)state;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Visible", "Reflection Front", NULL);
    for (int level = 0; level < 8; level++)
        fputs("{", t.stream);
    fputs("{20000}", t.stream);
    for (int level = 0; level < 8; level++)
        fputs("{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}}", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    bsdf = load_text(t);
    assert_non_null(bsdf);
    /* A's first cell is the corner of the square: just above the horizon at azimuth 45 degrees. */
    const struct orl_vec3 in = direction(0.9999 * M_SQRT1_2, 0.9999 * M_SQRT1_2, -1);
    assert_close(orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH).g, 2e4 * ORL_PI / 65536, 1e-6);
    orl_bsdf_unref(bsdf);
}

/* ---- Threads --------------------------------------------------------------------------------- */

enum { SHARES = 8, DRAWS = 20000 };

/* One thread's share of the samples, from BSDFs that all threads use at once. */
struct crowd {
    struct orl_bsdf *bsdf[3];
    double sums[SHARES];
};

static void draw_share(void *ctx, size_t share, uint32_t member)
{
    struct crowd *crowd = ctx;
    double sum = 0;
    (void)member;
    for (int i = 0; i < DRAWS; i++) {
        const double u[3] = {i * 7 % 1000 / 1000.0, i * 3 % 1000 / 1000.0, i % 1000 / 1000.0};
        struct orl_bsdf_sample_result draw;
        if (!orl_bsdf_sample_split(crowd->bsdf[i % 3],
                                   direction(0.1 * (double)share, 0.2, i % 2 ? 1 : -1), i % 4 < 2,
                                   ORL_BSDF_BOTH, u, &draw))
            continue;
        sum += draw.direction.x + draw.direction.y + draw.weight.r + draw.pdf;
        sum += eval(crowd->bsdf[i % 3], draw.direction, direction(0.3, 0.1, 1));
    }
    crowd->sums[share] = sum;
}

/* Any number of threads can use one BSDF; nothing in it is built lazily. */
static void threads_may_share_it(void **state)
{
    static struct crowd alone, together;
    struct orl_thread_pool *pool[2] = {orl_thread_pool_start(1), orl_thread_pool_start(4)};
    (void)state;
    alone.bsdf[0] = load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml"));
    alone.bsdf[1] = load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"));
    alone.bsdf[2] = load_text(make_tinted_file(4, 0.1, 0.1, 0.3, 0.5));
    together = alone;
    assert_non_null(pool[0]);
    assert_non_null(pool[1]);
    orl_parallel_for(pool[0], SHARES, draw_share, &alone);
    orl_parallel_for(pool[1], SHARES, draw_share, &together);
    assert_memory_equal(alone.sums, together.sums, sizeof alone.sums);
    for (int k = 0; k < 3; k++)
        orl_bsdf_unref(alone.bsdf[k]);
    orl_thread_pool_stop(pool[0]);
    orl_thread_pool_stop(pool[1]);
}

/* A BSDF does not depend on which others are loaded, or when. */
static void the_order_of_loading_does_not_matter(void **state)
{
    static const char *const paths[2] = {"tests/fixtures/bsdf_lcp8.xml",
                                         "tests/fixtures/bsdf_klems41.xml"};
    double sums[2][2];
    (void)state;
    for (int order = 0; order < 2; order++) {
        struct orl_bsdf *bsdfs[2] = {NULL, NULL};
        for (int i = 0; i < 2; i++)
            bsdfs[i ^ order] = load_text(read_fixture(paths[i ^ order]));
        for (int b = 0; b < 2; b++) {
            sums[order][b] = 0;
            for (int i = 0; i < 1000; i++) {
                const double u[3] = {i / 1000.0, i * 7 % 1000 / 1000.0, i * 3 % 1000 / 1000.0};
                struct orl_vec3 out;
                struct orl_rgb weight;
                double pdf;
                assert_true(orl_bsdf_sample(bsdfs[b], direction(0.3, 0.4, i % 2 ? 1 : -1),
                                            ORL_BSDF_BOTH, u, &out, &weight, &pdf));
                sums[order][b] += out.x + out.y + out.z + pdf + weight.g;
            }
            orl_bsdf_unref(bsdfs[b]);
        }
    }
    assert_memory_equal(sums[0], sums[1], sizeof sums[0]);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_numbers_its_children_by_axis),
        cmocka_unit_test(a_grid_runs_its_last_axis_fastest),
        cmocka_unit_test(a_missing_transmission_is_the_transpose),
        cmocka_unit_test(a_tree_of_rank_3_turns_with_the_light),
        cmocka_unit_test(a_tree_of_rank_3_is_not_reversed),
        cmocka_unit_test(values_are_radiances),
        cmocka_unit_test(the_klems_fixture_describes_itself),
        cmocka_unit_test(the_full_klems_basis_has_its_cells_in_place),
        cmocka_unit_test(only_visible_data_are_read),
        cmocka_unit_test(a_uniform_tree_is_all_diffuse_and_a_zero_one_black),
        cmocka_unit_test(negative_values_are_cut_and_counted),
        cmocka_unit_test(the_deepest_tree_keeps_a_tall_peak),
        cmocka_unit_test(threads_may_share_it),
        cmocka_unit_test(the_order_of_loading_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
