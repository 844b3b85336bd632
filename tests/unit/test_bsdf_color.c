/* Colour of BSDFs: RGB by Radiance's primaries, luminance equal to Visible's, grey exactly grey. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"

/*
 * Radiance's matrix from XYZ to RGB for primaries (.640 .330), (.290 .600), (.150 .060) and
 * equal-energy white. It is derived independently of the code: the inverse of the columns x/y, 1,
 * z/y of the primaries, each times its luminance of white. Those luminances are ORL_LUMA_R and so
 * on.
 */
static const double to_rgb[3][3] = {{2.5653125, -1.1668497, -0.3984628},
                                    {-1.0220951, 1.9782618, 0.0438333},
                                    {0.0747252, -0.2519390, 1.1772138}};

static struct orl_rgb rgb_of(double x, double y, double z)
{
    double c[3];
    for (int i = 0; i < 3; i++)
        c[i] = to_rgb[i][0] * x + to_rgb[i][1] * y + to_rgb[i][2] * z;
    return (struct orl_rgb){c[0], c[1], c[2]};
}

static void assert_rgb(struct orl_rgb a, struct orl_rgb b, double tolerance)
{
    if (fabs(a.r - b.r) > tolerance || fabs(a.g - b.g) > tolerance || fabs(a.b - b.b) > tolerance)
        fail_msg("(%.7g %.7g %.7g) is not (%.7g %.7g %.7g)", a.r, a.g, a.b, b.r, b.g, b.b);
}

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

/* Returns the luminance of cell pair (in, out) of a quarter basis, asymmetric; X and Z differ by
 * out. */
static double luminance(int in, int out)
{
    return 0.02 + 0.2 * ((in * 7 + out * 3) % 11 == 0);
}

static double tristimulus(int channel, int in, int out)
{
    const double y = luminance(in, out), bent = 0.3 * sin(out * 0.7 + in);
    return channel == 1 ? y : channel == 0 ? y * (1 + bent) : y * (1 - bent);
}

/* channels: 1 for Visible alone, 3 for colour, 4 for colour that is grey. */
static struct text matrix_file(int channels, const char *direction)
{
    static const char *const names[] = {"Visible", "CIE-X", "CIE-Z"};
    static const int channel[] = {1, 0, 2};
    struct text t;
    text_open(&t);
    make_head(t.stream, "Columns");
    for (int k = 0; k < (channels > 1 ? 3 : 1); k++) {
        make_block_head(t.stream, names[k], direction, "LBNL/Klems Quarter");
        for (int out = 0; out < 41; out++)
            for (int in = 0; in < 41; in++)
                fprintf(t.stream, "%.9g ", tristimulus(channels == 4 ? 1 : channel[k], in, out));
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

static void gray_in_colour_is_gray(void **state)
{
    static const char *const data[] = {"{{.1}{.2}{.3}{.1}{.2}{.3}{.1}{.2}{.3}{.1}{.2}{.3}{.1}{.2}"
                                       "{.3}{0}}"};
    struct orl_bsdf *bsdf[4];
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 2);
    struct text t;
    (void)state;
    bsdf[0] = load_text(matrix_file(1, "Transmission Front"));
    bsdf[1] = load_text(matrix_file(4, "Transmission Front"));
    bsdf[2] = load_text(make_file("TensorTree4", "Transmission Front", NULL, data[0]));
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "CIE-u", "Transmission Front", NULL);
    fputs("{.2105263}", t.stream); /* 4/19 and 9/19: equal energy */
    make_block_tail(t.stream);
    make_block_head(t.stream, "Visible", "Transmission Front", NULL);
    fputs(data[0], t.stream);
    make_block_tail(t.stream);
    make_block_head(t.stream, "CIE-v", "Transmission Front", NULL);
    fputs("{.4736842}", t.stream);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    bsdf[3] = load_text(t);
    for (int i = 0; i < 5000; i++) {
        const struct orl_vec3 in = any_direction(&random), out = any_direction(&random);
        for (int k = 0; k < 4; k += 2) {
            const struct orl_rgb gray = orl_bsdf_eval(bsdf[k], in, out);
            const struct orl_rgb both = orl_bsdf_eval(bsdf[k + 1], in, out);
            assert_true(gray.r == both.r && gray.g == both.g && gray.b == both.b);
            assert_true(gray.r == gray.g && gray.g == gray.b);
            assert_rgb(orl_bsdf_albedo(bsdf[k], in, ORL_BSDF_BOTH),
                       orl_bsdf_albedo(bsdf[k + 1], in, ORL_BSDF_BOTH), 1e-12);
        }
    }
    for (int k = 0; k < 4; k++)
        orl_bsdf_unref(bsdf[k]);
}

/* Values against the matrix; luminance to the last digits. Tints are stored to 1/65535. */
static void values_are_radiances_rgb(void **state)
{
    struct orl_bsdf *bsdf = load_text(matrix_file(3, "Reflection Back"));
    struct orl_bsdf *gray = load_text(matrix_file(1, "Reflection Back"));
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 2);
    struct orl_bsdf_info info;
    int colored = 0;
    (void)state;
    orl_bsdf_describe(bsdf, &info);
    assert_true(info.colored && !info.color_left_out);
    for (int i = 0; i < 5000; i++) {
        struct orl_vec3 in = any_direction(&random), out = any_direction(&random);
        in.z = fabs(in.z);
        out.z = fabs(out.z);
        const struct orl_rgb f = orl_bsdf_eval(bsdf, in, out);
        const double y = orl_luma(orl_bsdf_eval(gray, in, out));
        assert_true(fabs(orl_luma(f) - y) < 1e-12);
        colored += fabs(f.r - f.b) > 0.1 * y;
    }
    assert_true(colored > 1000);
    /* The pole's cell, in both directions. */
    const struct orl_vec3 up = orl_v3(0, 0, 1);
    assert_rgb(orl_bsdf_eval(bsdf, up, up),
               rgb_of(tristimulus(0, 0, 0), tristimulus(1, 0, 0), tristimulus(2, 0, 0)),
               1e-3 * luminance(0, 0));
    const struct orl_vec3 side = orl_v3(sin(0.3), 0, cos(0.3)); /* ring 1, cell 0 */
    assert_rgb(orl_bsdf_eval(bsdf, up, side),
               rgb_of(tristimulus(0, 0, 1), tristimulus(1, 0, 1), tristimulus(2, 0, 1)),
               1e-3 * luminance(0, 1));
    orl_bsdf_unref(bsdf);
    orl_bsdf_unref(gray);
}

/*
 * The albedo in colour is the integral of f in colour, and the mean weight of samples. In the rank
 * 4 file u' varies by outgoing and incident direction, in other cells than luminance.
 */
static void albedo_is_the_integral_in_every_channel(void **state)
{
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 2);
    struct orl_bsdf *bsdf[3];
    struct text t;
    (void)state;
    bsdf[0] = load_text(matrix_file(3, "Transmission Front"));
    for (int rank = 3; rank <= 4; rank++) {
        text_open(&t);
        make_head(t.stream, rank == 3 ? "TensorTree3" : "TensorTree4");
        for (int k = 0; k < 3; k++) {
            static const char *const names[] = {"Visible", "CIE-u", "CIE-v"};
            const int count = k == 2 ? 1 : k == 1 ? 1 << 2 * rank : 1 << rank;
            make_block_head(t.stream, names[k], "Reflection Front", NULL);
            fputs("{", t.stream);
            for (int i = 0; i < count; i++)
                fprintf(t.stream, " %.6g",
                        k == 0   ? 0.01 + 0.02 * (i * 5 % 7)
                        : k == 1 ? 0.17 + 0.1 * (i * 3 % 13) / 13
                                 : 0.48);
            fputs("}", t.stream);
            make_block_tail(t.stream);
        }
        make_tail(t.stream);
        text_close(&t);
        bsdf[rank - 2] = load_text(t);
    }
    for (int k = 0; k < 3; k++) {
        assert_non_null(bsdf[k]);
        for (int i = 0; i < 4; i++) {
            enum { SIDE = 512 };
            struct orl_vec3 in = any_direction(&random);
            struct orl_rgb sum = orl_gray(0), drawn = orl_gray(0);
            in.z = -fabs(in.z);
            for (int c = 0; c < SIDE * SIDE; c++) {
                const double u = (c / SIDE + uniform(&random)) / SIDE;
                const double v = 2 * ORL_PI * (c % SIDE + uniform(&random)) / SIDE;
                const double z = sqrt(1 - u), s = sqrt(u);
                sum = orl_rgb_add(
                    sum,
                    orl_bsdf_eval(bsdf[k], in, orl_v3(s * cos(v), s * sin(v), k == 0 ? z : -z)));
            }
            for (int c = 0; c < 20000; c++) {
                const double w[3] = {uniform(&random), uniform(&random), uniform(&random)};
                struct orl_vec3 out;
                struct orl_rgb weight;
                double pdf;
                assert_true(orl_bsdf_sample(bsdf[k], in, ORL_BSDF_BOTH, w, &out, &weight, &pdf));
                drawn = orl_rgb_add(drawn, weight);
            }
            const struct orl_rgb albedo = orl_bsdf_albedo(bsdf[k], in, ORL_BSDF_BOTH);
            /* 512 x 512 jittered points: the borders of a few cells are wrong by 1/512 each. */
            assert_rgb(orl_rgb_scale(sum, ORL_PI / (SIDE * SIDE)), albedo, 2e-3 * albedo.g);
            /* A tint varies by half at most: 4 sigma of 20000 samples. */
            assert_rgb(orl_rgb_scale(drawn, 1.0 / 20000), albedo, 0.015 * albedo.g);
        }
        orl_bsdf_unref(bsdf[k]);
    }
}

/* Green and blue of red light are exactly 0; colours outside the RGB gamut are counted and keep Y.
 */
static void a_dark_channel_is_exactly_dark(void **state)
{
    /* u', v' of the red primary: 4x / (-2x + 12y + 3), 9y / the same. */
    const double d = -2 * 0.64 + 12 * 0.33 + 3, red_u = 4 * 0.64 / d, red_v = 9 * 0.33 / d;
    struct orl_bsdf *red = load_text(make_tinted_file(3, 0.1, 0.05, red_u, red_v));
    struct orl_bsdf *beyond = load_text(make_tinted_file(3, 0.1, 0.05, 0.6, 0.5));
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 2);
    struct orl_bsdf_info info;
    (void)state;
    orl_bsdf_describe(red, &info);
    assert_int_equal(info.out_of_gamut, 0);
    orl_bsdf_describe(beyond, &info);
    assert_true(info.out_of_gamut > 0);
    for (int i = 0; i < 2000; i++) {
        const struct orl_vec3 in = any_direction(&random), out = any_direction(&random);
        const struct orl_rgb f = orl_bsdf_eval(red, in, out), g = orl_bsdf_eval(beyond, in, out);
        const struct orl_rgb a = orl_bsdf_albedo(red, in, ORL_BSDF_BOTH);
        assert_true(fabs(orl_luma(f) - orl_luma(g)) < 1e-9 * (1 + orl_luma(f)));
        assert_true(g.r >= 0 && g.g == 0 && g.b >= 0);
        assert_true(f.g < 1e-4 * f.r + 1e-30 && f.b < 1e-3 * f.r + 1e-30 && a.r > 0.5);
    }
    orl_bsdf_unref(red);
    orl_bsdf_unref(beyond);
}

/* A luminance below 1 may still give more red than arrived: no channel may gain energy. */
static void no_channel_gains(void **state)
{
    const double d = -2 * 0.64 + 12 * 0.33 + 3;
    struct orl_bsdf *bsdf = load_text(make_tinted_file(3, 0.4, 0.1, 4 * 0.64 / d, 9 * 0.33 / d));
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 2);
    (void)state;
    for (int i = 0; i < 500; i++) {
        const struct orl_rgb a = orl_bsdf_albedo(bsdf, any_direction(&random), ORL_BSDF_BOTH);
        assert_true(fabs(a.r - 1) < 1e-12);
        assert_true(fabs(orl_luma(a) - ORL_LUMA_R) < 1e-3);
    }
    orl_bsdf_unref(bsdf);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(gray_in_colour_is_gray),
        cmocka_unit_test(values_are_radiances_rgb),
        cmocka_unit_test(albedo_is_the_integral_in_every_channel),
        cmocka_unit_test(a_dark_channel_is_exactly_dark),
        cmocka_unit_test(no_channel_gains),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
