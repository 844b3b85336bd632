/* Written BSDF files: reading returns the written data to the last bit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "bsdf/bsdf_internal.h"
#include "bsdf/xml/bsdf_xml.h"

static const char *const bases[] = {"LBNL/Klems Full", "LBNL/Klems Half", "LBNL/Klems Quarter"};

/* Fills in values over twelve decades, with some zeros. */
static void fill_matrix(struct orl_matrix *matrix, const char *name, uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0);
    struct orl_basis basis;
    assert_int_equal(orl_basis_standard(name, &basis), 0);
    assert_int_equal(orl_matrix_init(matrix, &basis, &basis, NULL), 0);
    for (int i = 0; i < basis.n_cells * basis.n_cells; i++) {
        const double u = orl_random_uniform(&random);
        matrix->values[i] = u < 0.1 ? 0 : (float)pow(10, -8 + 8 * u) / 100;
    }
}

static struct orl_bsdf *write_and_read(const struct orl_document *document, const char *comment)
{
    const struct orl_bsdf_labels labels = {
        .manufacturer = "nobody & sons", .width_m = 2, .height_m = 1.5, .comment = comment};
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    orl_document_write(document, &labels, out);
    assert_int_equal(fclose(out), 0);
    if (orl_bsdf_load_xml("written.xml", text, size, &bsdf, &err) < 0)
        fail_msg("line %d: %s", err.line, err.message);
    free(text);
    return bsdf;
}

static void matrices_come_back_bit_for_bit(void **state)
{
    (void)state;
    for (size_t b = 0; b < sizeof bases / sizeof *bases; b++) {
        struct orl_document d = {.structure = ORL_STRUCTURE_MATRIX, .thickness_m = 0.012};
        strcpy(d.name, "a <panel> of \"mine\"");
        for (int part = 0; part < ORL_COMPONENT_COUNT; part++) {
            fill_matrix(&d.parts[part].matrix, bases[b], 10 * b + (uint64_t)part);
            d.parts[part].present = true;
        }
        struct orl_bsdf *bsdf = write_and_read(&d, "x -- y --> z <--\n---\nend");
        assert_string_equal(bsdf->info.name, d.name);
        assert_true(bsdf->info.thickness_m == 0.012);
        for (int part = 0; part < ORL_COMPONENT_COUNT; part++)
            assert_true(
                orl_matrix_equal(&bsdf->document.parts[part].matrix, &d.parts[part].matrix));
        orl_bsdf_unref(bsdf);
        orl_document_done(&d);
    }
}

/* Colours within the gamut are read back as their tints, which are shares in 16 bits. */
static void colours_come_back_as_their_tints(void **state)
{
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, 0);
    (void)state;
    for (int i = 0; i < 10000; i++) {
        const double r = orl_random_uniform(&random), g = orl_random_uniform(&random);
        const struct orl_rgb color = {r, i % 3 == 0 ? 0 : g, orl_random_uniform(&random)};
        const struct orl_rgb gray = orl_gray(r);
        double x, z;
        size_t outside = 0;
        orl_color_xz(color, &x, &z);
        const struct orl_rgb back =
            orl_tinted(orl_tint_of_xyz(x, orl_luma(color), z, &outside), orl_luma(color));
        const double step = orl_luma(color) / 65535 / ORL_LUMA_B;
        assert_int_equal(outside, 0);
        assert_true(fabs(back.r - color.r) <= step && fabs(back.g - color.g) <= step &&
                    fabs(back.b - color.b) <= step);
        orl_color_xz(gray, &x, &z);
        assert_true(fabs(x - r) <= 1e-12 * r && fabs(z - r) <= 1e-12 * r);
    }
}

static void values_are_the_shortest_that_read_the_same(void **state)
{
    static const struct {
        float value;
        const char *text;
    } cases[] = {
        {0, "0"}, {0.25F, "0.25"}, {0.1F, "0.1"}, {1.0F / 3, "0.33333334"}, {1e-20F, "1e-20"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        orl_write_value(out, cases[i].value);
        fclose(out);
        assert_string_equal(text, cases[i].text);
        free(text);
    }
}

/* Names and comments are untrusted: with any bytes in them the file is valid XML. */
static void texts_are_characters(void **state)
{
    static const struct {
        const char *text, *read;
    } cases[] = {{"gr\xc3\xbc n", "gr\xc3\xbc n"},
                 {"\xe2\x82\xac \xf0\x9f\x8c\x9e", "\xe2\x82\xac \xf0\x9f\x8c\x9e"},
                 {"a\xff\xfe z", "a?? z"},
                 {"cut \xe2\x82", "cut ??"},
                 {"over\xc0\xaflong \xe0\x80\xaf.", "over??long ???."},
                 {"half \xed\xa0\x80.", "half ???."},
                 {"far \xf4\x90\x80\x80.", "far ????."},
                 {"last \xef\xbf\xbf.", "last ???."},
                 {"bell\a", "bell?"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_document d = {.structure = ORL_STRUCTURE_MATRIX};
        snprintf(d.name, sizeof d.name, "%s", cases[i].text);
        fill_matrix(&d.parts[0].matrix, bases[2], 7);
        d.parts[0].present = true;
        struct orl_bsdf *bsdf = write_and_read(&d, cases[i].text);
        assert_string_equal(bsdf->info.name, cases[i].read);
        orl_bsdf_unref(bsdf);
        orl_document_done(&d);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(matrices_come_back_bit_for_bit),
        cmocka_unit_test(colours_come_back_as_their_tints),
        cmocka_unit_test(values_are_the_shortest_that_read_the_same),
        cmocka_unit_test(texts_are_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
