/* BSDF files: what they mean, and what is wrong with those that mean nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "fixtures/bsdf_make.h"

#define assert_close(value, expected, tolerance)                                                   \
    check_close(value, expected, tolerance, __FILE__, __LINE__)

static void check_close(double value, double expected, double tolerance, const char *file, int line)
{
    if (!(fabs(value - expected) <= tolerance)) {
        print_error("%.17g is not %.17g within %g\n", value, expected, tolerance);
        _fail(file, line);
    }
}

static struct orl_vec3 direction(double x, double y, double sign)
{
    return orl_v3(x, y, sign * sqrt(1 - x * x - y * y));
}

static double eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out)
{
    return orl_bsdf_eval(bsdf, in, out).g;
}

/* ---- Meaning -----------------------------------------------------------------------------------
 */

/*
 * In the quadrants of the square: child bit i is axis i, A (the first two) is where the light
 * travels, B where it leaves.
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

/* Light from the interior is the file's Transmission Back; the other way follows by reciprocity. */
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
 * Of rank 3: bit 0 is A (1: near the normal is never reached, as sines end at the middle), bits 1
 * and 2 are B once A travels along +x. Whatever the two are turned by, the value stays.
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

/* Values by Radiance 6.1a (SDevalBSDF, SDdirectHemi); it perturbs each by up to 3e-4 on purpose. */
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

/* One cell of a full Klems matrix is 1, found from inside the cell and missed from outside. */
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

/* A leaf of 2e4 1/sr in a tree of 2^8: the integral is exact however small the cell. */
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

/* ---- Text --------------------------------------------------------------------------------------
 */

/* Numbers in every form, and cut anywhere: expat hands out character references one by one. */
static void numbers_read_the_same_in_every_form(void **state)
{
    static const char *const forms[] = {"{0.125}",
                                        "{ +.125, }",
                                        "{1.25e-1}",
                                        "{125E-3}",
                                        "{\n\t0.1250000000000000000000000000\r\n}",
                                        "{1&#50;5e-3}",
                                        "{0&#46;&#49;25}",
                                        "&#123;.125&#125;",
                                        "{<!-- -->.1<!-- -->25<!-- -->}",
                                        "{<![CDATA[.12]]>5}",
                                        "{0.000000000000000000000000000125e27}"};
    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        struct orl_bsdf *bsdf =
            load_text(make_file("TensorTree4", "Reflection Front", NULL, forms[i]));
        assert_non_null(bsdf);
        assert_close(eval(bsdf, direction(0, 0, -1), direction(0.1, 0, -1)), 0.125, 0);
        orl_bsdf_unref(bsdf);
    }
}

/* A file is read in slices of 1 MB; padding moves the border over every byte of the data. */
static void a_number_may_lie_across_a_slice(void **state)
{
    const char *data = "{1.25e-1 .2 .3 .4 .5 .1 .2 .3 .4 .1 .2 .3 .1 .1 .1 0.0625e1}";
    (void)state;
    for (size_t shift = 0; shift < 60; shift++) {
        struct text plain = make_file("TensorTree4", "Reflection Front", NULL, data);
        struct text padded;
        const size_t at = (size_t)(strstr(plain.data, "{1.25") - plain.data) + shift;
        struct orl_bsdf *bsdf;
        const char *body = strstr(plain.data, "<WindowElement>");
        text_open(&padded);
        fwrite(plain.data, 1, (size_t)(body - plain.data), padded.stream);
        for (size_t i = at; i < 1 << 20; i++)
            putc(' ', padded.stream);
        fputs(body, padded.stream);
        text_close(&padded);
        free(plain.data);
        bsdf = load_text(padded);
        assert_non_null(bsdf);
        assert_close(eval(bsdf, direction(0.3, 0.2, -1), direction(-0.3, -0.2, -1)), 0.125, 0);
        assert_close(eval(bsdf, direction(-0.3, -0.2, -1), direction(0.3, 0.2, -1)), 0.625, 0);
        orl_bsdf_unref(bsdf);
    }
}

/* ---- Errors ------------------------------------------------------------------------------------
 */

#define HEAD "<WindowElement>\n<Optical>\n<Layer>\n"
#define TREE                                                                                       \
    HEAD "<DataDefinition>\n<IncidentDataStructure>TensorTree4</IncidentDataStructure>\n"          \
         "</DataDefinition>\n"
#define TREE3                                                                                      \
    HEAD "<DataDefinition>\n<IncidentDataStructure>TensorTree3</IncidentDataStructure>\n"          \
         "</DataDefinition>\n" BLOCK_HEAD
#define BLOCK_HEAD                                                                                 \
    "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"                    \
    "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>\n"                       \
    "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n<ScatteringData>\n"
#define BLOCK                                                                                      \
    TREE "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"               \
         "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>\n"                  \
         "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n<ScatteringData>\n"
#define TAIL "</Layer>\n</Optical>\n</WindowElement>\n"
#define END "</ScatteringData></WavelengthDataBlock></WavelengthData>" TAIL
#define MATRIX(basis)                                                                              \
    HEAD "<DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>\n"              \
         "</DataDefinition>\n<WavelengthData><Wavelength>Visible</Wavelength>\n"                   \
         "<WavelengthDataBlock>\n"                                                                 \
         "<WavelengthDataDirection>Reflection Front</WavelengthDataDirection>\n"                   \
         "<ColumnAngleBasis>" basis "</ColumnAngleBasis>"                                          \
         "<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>\n<ScatteringData>\n"

static const struct bad_file {
    const char *text;
    int code, line;
    const char *primitive, *message; /* part of them */
} bad_files[] = {
    {"", ORL_ERR_SYNTAX, 1, "", "XML"},
    {"no xml", ORL_ERR_SYNTAX, 1, "", "XML"},
    {"<scene/>", ORL_ERR_SYNTAX, 1, "", "WindowElement"},
    {HEAD, ORL_ERR_SYNTAX, 4, "Layer", "XML"},
    {HEAD TAIL, ORL_ERR_SYNTAX, 0, "WindowElement", "IncidentDataStructure"},
    {TREE TAIL, ORL_ERR_SYNTAX, 0, "WindowElement", "Visible"},
    {"<WindowElement>\n<FileType>Glass</FileType></WindowElement>", ORL_ERR_SYNTAX, 2, "FileType",
     "Glass"},
    {"<!DOCTYPE x [<!ENTITY a \"b\">]>\n<WindowElement/>", ORL_ERR_UNSUPPORTED, 1, "",
     "document type"},
    {HEAD "<DataDefinition>\n<IncidentDataStructure>TensorTree5</IncidentDataStructure>",
     ORL_ERR_UNSUPPORTED, 5, "IncidentDataStructure", "TensorTree5"},
    {TREE3 "{0 1 2 3}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "rank 3 has 1, 8, 64"},
    {TREE3 "{{0}{0}{0}{0}{0}{0}{0}}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "where 8"},
    {TREE3 "{{0}{0}{0}{0}{0}{0}{0}{0}{0}}" END, ORL_ERR_SYNTAX, 12, "Transmission Back",
     "more than 8"},
    {TREE3 "{{{{{{{{{0 0 0 0 0 0 0 0}" END, ORL_ERR_LIMIT, 12, "Transmission Back", "deeper"},
    {TREE3 "{0 0 0 0 nan" END, ORL_ERR_RANGE, 12, "Transmission Back", "'nan'"},
    {HEAD "<Material><Thickness>-1</Thickness>", ORL_ERR_RANGE, 4, "Thickness", "'-1'"},
    {BLOCK "{0 1 nan}" END, ORL_ERR_RANGE, 12, "WavelengthDataBlock Transmission Back", "'nan'"},
    {BLOCK "{0}\n{1}" END, ORL_ERR_SYNTAX, 13, "Transmission Back", "after the end"},
    {BLOCK "\n{1e400}" END, ORL_ERR_RANGE, 13, "Transmission Back", "too large"},
    {BLOCK "{-inf}" END, ORL_ERR_RANGE, 12, "Transmission Back", "not a finite"},
    {BLOCK "{1e31}" END, ORL_ERR_RANGE, 12, "Transmission Back", "too large"},
    {BLOCK "{0x10}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "'0x10'"},
    {BLOCK "{1.2.3}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "'1.2.3'"},
    {BLOCK "{1e}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "'1e'"},
    {BLOCK "{-}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "'-'"},
    {BLOCK "{0 1 2}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "a grid of 3"},
    {BLOCK "{{0}{0}}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "2 children"},
    {BLOCK "{}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "0 children"},
    {BLOCK "{{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}{0}}" END, ORL_ERR_SYNTAX, 12,
     "Transmission Back", "more than 16"},
    {BLOCK "{{0} 1}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "among the children"},
    {BLOCK "{1 {0}}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "among the values"},
    {BLOCK "1 2 3" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "outside the braces"},
    {BLOCK "}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "without its"},
    {BLOCK "{0" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "1 braces open"},
    {BLOCK "\n\n" END, ORL_ERR_SYNTAX, 14, "Transmission Back", "empty"},
    {BLOCK "{0\n0", ORL_ERR_SYNTAX, 13, "Transmission Back", "XML"},
    {BLOCK "{{{{{{{{{{0}", ORL_ERR_LIMIT, 12, "Transmission Back", "deeper"},
    {BLOCK "{{{{{{{{{0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0}", ORL_ERR_LIMIT, 12, "Transmission Back",
     "deeper"},
    {BLOCK "{&a;}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "entity"},
    {TREE "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"
          "<ScatteringData>{0}",
     ORL_ERR_SYNTAX, 9, "ScatteringData", "before its"},
    {TREE "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"
          "<WavelengthDataDirection>Sideways</WavelengthDataDirection>",
     ORL_ERR_SYNTAX, 9, "WavelengthDataDirection", "Sideways"},
    {BLOCK "{0}</ScatteringData></WavelengthDataBlock><WavelengthDataBlock>\n"
           "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>",
     ORL_ERR_SYNTAX, 13, "Transmission Back", "twice"},
    {MATRIX("LBNL/Klems Full") "0 1 2" END, ORL_ERR_SYNTAX, 12, "Reflection Front",
     "3 values where the matrix has 21025"},
    {MATRIX("LBNL/Klems Full") "{0}" END, ORL_ERR_SYNTAX, 12, "Reflection Front", "brace"},
    {MATRIX("My Own"), ORL_ERR_UNSUPPORTED, 10, "Reflection Front", "My Own"},
};

static void a_bad_file_says_what_and_where(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bad_files / sizeof *bad_files; i++) {
        const struct bad_file *bad = &bad_files[i];
        struct orl_bsdf *bsdf = NULL;
        struct orl_error err = {0};
        const int code = orl_bsdf_load_xml("bad.xml", bad->text, strlen(bad->text), &bsdf, &err);
        if (code != bad->code || err.line != bad->line || !strstr(err.message, bad->message) ||
            !strstr(err.primitive, bad->primitive))
            fail_msg("file %zu gave %d, line %d, '%s', '%s'", i, code, err.line, err.primitive,
                     err.message);
        assert_int_equal(err.code, code);
        assert_string_equal(err.file, "bad.xml");
        assert_null(bsdf);
        /* The detail is optional. */
        assert_int_equal(orl_bsdf_load_xml("x", bad->text, strlen(bad->text), &bsdf, NULL), code);
    }
}

static void elements_may_not_nest_without_end(void **state)
{
    struct text t;
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err;
    (void)state;
    text_open(&t);
    fputs("<WindowElement>", t.stream);
    for (int i = 0; i < 100000; i++)
        fputs("<a>\n", t.stream);
    text_close(&t);
    assert_int_equal(orl_bsdf_load_xml("deep.xml", t.data, t.size, &bsdf, &err), ORL_ERR_LIMIT);
    assert_int_equal(err.line, 64);
    free(t.data);
}

/* Cut short anywhere, a file is refused; it never half loads. */
static void a_cut_file_is_refused(void **state)
{
    struct text t = make_tree_file(2);
    (void)state;
    for (size_t size = 0; size < t.size - 1; size += 97) {
        struct orl_bsdf *bsdf = NULL;
        assert_int_equal(orl_bsdf_load_xml("cut.xml", t.data, size, &bsdf, NULL), ORL_ERR_SYNTAX);
        assert_null(bsdf);
    }
    free(t.data);
}

/* Bytes changed at random: whatever loads can be asked anything and answers finite numbers. */
static void a_spoilt_file_never_does_harm(void **state)
{
    static const char bytes[] = "012345678901234567890-e.{} \n<n&";
    struct text whole = read_fixture("tests/fixtures/bsdf_lcp8.xml");
    uint32_t random = 12345;
    int loaded = 0;
    (void)state;
    assert_true(whole.size > 1000);
    for (int round = 0; round < 300; round++) {
        char *copy = malloc(whole.size);
        struct orl_bsdf *bsdf = NULL;
        memcpy(copy, whole.data, whole.size);
        for (int k = 0; k <= round % 3; k++) {
            random = random * 1664525 + 1013904223;
            copy[(size_t)(random >> 4) % whole.size] = bytes[random % (sizeof bytes - 1)];
        }
        if (orl_bsdf_load_xml("spoilt.xml", copy, whole.size, &bsdf, NULL) == 0) {
            const struct orl_vec3 in = direction(0.2, 0.5, -1);
            const double u[3] = {0.999, 0.5, 0.001};
            struct orl_vec3 out = {0, 0, 1};
            struct orl_rgb weight;
            double pdf;
            loaded++;
            if (orl_bsdf_sample(bsdf, in, ORL_BSDF_BOTH, u, &out, &weight, &pdf))
                assert_true(pdf > 0 && isfinite(weight.g));
            assert_true(isfinite(eval(bsdf, in, out)) && eval(bsdf, in, out) >= 0);
            orl_bsdf_unref(bsdf);
        }
        free(copy);
    }
    assert_in_range(loaded, 30, 299);
    free(whole.data);
}

/* NaN and unnormalised directions are answered, by whatever number, without a fault. */
static void strange_directions_do_no_harm(void **state)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY, 0, -0.0, 1e300, 1};
    struct orl_bsdf *bsdfs[2] = {load_text(read_fixture("tests/fixtures/bsdf_lcp8.xml")),
                                 load_text(read_fixture("tests/fixtures/bsdf_klems41.xml"))};
    (void)state;
    for (int b = 0; b < 2; b++) {
        assert_non_null(bsdfs[b]);
        for (int i = 0; i < 343; i++) {
            const struct orl_vec3 d = {odd[i % 7], odd[i / 7 % 7], odd[i / 49]};
            const double value = eval(bsdfs[b], d, direction(0.1, 0.2, 1));
            assert_true(value >= 0 && value < 1e3);
            assert_true(orl_bsdf_albedo(bsdfs[b], d, ORL_BSDF_BOTH).g >= 0);
        }
        orl_bsdf_unref(bsdfs[b]);
    }
}

/* What a BSDF is does not depend on which others are loaded, or when. */
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
        cmocka_unit_test(numbers_read_the_same_in_every_form),
        cmocka_unit_test(a_number_may_lie_across_a_slice),
        cmocka_unit_test(a_bad_file_says_what_and_where),
        cmocka_unit_test(elements_may_not_nest_without_end),
        cmocka_unit_test(a_cut_file_is_refused),
        cmocka_unit_test(a_spoilt_file_never_does_harm),
        cmocka_unit_test(strange_directions_do_no_harm),
        cmocka_unit_test(the_order_of_loading_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
