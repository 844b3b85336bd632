/* Radiance's matrix files, and the transmission of a BSDF as such a matrix. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>
#include <oriel/bsdf/bsdf.h>

#include "annual/matrices/imported_matrices.h"
#include "bsdf/matrix/matrix.h"
#include "support/scene_text.h"

#define TOP "#?RADIANCE\nrfluxmtx -I+\n"

struct file {
    char bytes[512];
    size_t size;
};

static void put_bytes(struct file *file, const void *bytes, size_t size)
{
    assert_true(file->size + size <= sizeof file->bytes);
    memcpy(file->bytes + file->size, bytes, size);
    file->size += size;
}

static struct file text(const char *header)
{
    struct file file = {.size = 0};
    put_bytes(&file, header, strlen(header));
    return file;
}

/* Writes a value in this machine's byte order, or swapped. */
static void put_value(struct file *file, double value, bool is_double, bool swapped)
{
    const float single = (float)value;
    unsigned char bytes[8], turned[8];
    const size_t size = is_double ? 8 : 4;
    memcpy(bytes, is_double ? (const void *)&value : (const void *)&single, size);
    for (size_t i = 0; i < size; i++)
        turned[i] = bytes[swapped ? size - 1 - i : i];
    put_bytes(file, turned, size);
}

static void expect(const struct file *file, size_t rows, size_t columns, const float *values)
{
    struct orl_rgb_matrix matrix;
    struct orl_error err = {0};
    if (orl_rgb_matrix_read("m.mtx", file->bytes, file->size, &matrix, &err) < 0)
        fail_msg("%s", err.message);
    assert_int_equal(matrix.rows, rows);
    assert_int_equal(matrix.columns, columns);
    for (size_t i = 0; i < 3 * rows * columns; i++)
        assert_true(matrix.values[i] == values[i]);
    orl_rgb_matrix_done(&matrix);
}

static const float six[6] = {1, 2, 3, 4, 5, 6};

static void test_text(void **state)
{
    const struct file whole =
        text(TOP "NROWS=2\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n1 2 3\n4\t5 6e0\n");
    const struct file open = text(TOP "NCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n1 2 3 4 5 6");
    const struct file dim = text(TOP "EXPOSURE=2\nEXPOSURE= 2\nNCOLS=2\nNCOMP=3\nNROWS=1\n"
                                     "FORMAT=ascii \r\n\r\n4 8 12 16 20 24\n");
    const struct file grey = text(TOP "NCOLS=2\nNROWS=1\nNCOMP=1\nFORMAT=ascii\n\n7 8\n");
    (void)state;
    expect(&whole, 2, 1, six);
    expect(&open, 2, 1, six);
    expect(&dim, 1, 2, six);
    expect(&grey, 1, 2, (const float[6]){7, 7, 7, 8, 8, 8});
}

static void test_binary(void **state)
{
    const bool big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    (void)state;
    for (int i = 0; i < 8; i++) {
        const bool is_double = i & 1, swapped = i & 2, told = i & 4;
        char header[160];
        snprintf(header, sizeof header, TOP "%sNCOLS=2\nNCOMP=3\nBigEndian=%d\nFORMAT=%s   \n\n",
                 told ? "NROWS=1\n" : "", big != swapped, is_double ? "double" : "float");
        struct file file = text(header);
        for (int k = 0; k < 6; k++)
            put_value(&file, six[k], is_double, swapped);
        expect(&file, 1, 2, six);
    }
}

static void test_what_is_wrong(void **state)
{
    static const struct {
        const char *text, *says;
        int code;
    } cases[] = {
        {"hello", "begin with", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\n", "within its header", ORL_ERR_SYNTAX},
        {TOP "NROWS=1\nFORMAT=ascii\n\n1 2 3", "NCOLS", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\n\n1 2 3", "FORMAT", ORL_ERR_SYNTAX},
        {TOP "NCOLS=0\nFORMAT=ascii\n\n1 2 3", "whole numbers", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nFORMAT=32-bit_rle_rgbe\n\n", "ascii, float or double", ORL_ERR_UNSUPPORTED},
        {TOP "NCOLS=1\nNCOMP=4\nFORMAT=ascii\n\n1 2 3 4", "components", ORL_ERR_UNSUPPORTED},
        {TOP "NCOLS=1\nNROWS=2\nFORMAT=ascii\n\n1 2 3", "before its last", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nNROWS=1\nFORMAT=ascii\n\n1 2 3 4 5 6", "goes on", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nFORMAT=ascii\n\n1 2 3 4", "whole number of rows", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nFORMAT=ascii\n\n", "before its last", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nFORMAT=ascii\n\n1 2 x", "'x' is not a number", ORL_ERR_SYNTAX},
        {TOP "NCOLS=1\nFORMAT=ascii\n\n1 2 nan", "finite", ORL_ERR_RANGE},
        {TOP "NCOLS=1\nFORMAT=ascii\n\n1 2 1e39", "too large", ORL_ERR_RANGE},
        {TOP "EXPOSURE=0\nNCOLS=1\nFORMAT=ascii\n\n1 2 3", "above 0", ORL_ERR_RANGE},
        {TOP "NCOLS=999999999\nNROWS=999999999\nFORMAT=ascii\n\n1 2 3", "before its last",
         ORL_ERR_SYNTAX},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_rgb_matrix matrix;
        struct orl_error err = {0};
        assert_int_equal(
            orl_rgb_matrix_read("m.mtx", cases[i].text, strlen(cases[i].text), &matrix, &err),
            cases[i].code);
        assert_string_equal(err.file, "m.mtx");
        if (!strstr(err.message, cases[i].says))
            fail_msg("case %zu: %s", i, err.message);
    }
}

static void test_product(void **state)
{
    float a[12], b[12], expected[12] = {0};
    struct orl_rgb_matrix product;
    struct orl_error err = {0};
    struct orl_thread_pool *pool = orl_thread_pool_start(2);
    (void)state;
    for (int i = 0; i < 12; i++) {
        a[i] = (float)(i + 1);
        b[i] = (float)(12 - 2 * i);
    }
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 2; c++)
            for (int k = 0; k < 2; k++)
                for (int i = 0; i < 3; i++)
                    expected[3 * (2 * r + c) + i] +=
                        a[3 * (2 * r + k) + i] * b[3 * (2 * k + c) + i];
    const struct orl_rgb_matrix left = {2, 2, a}, right = {2, 2, b};
    assert_int_equal(orl_rgb_matrix_multiply(&left, &right, pool, &product, &err), 0);
    for (int i = 0; i < 12; i++)
        assert_true(product.values[i] == expected[i]);
    orl_rgb_matrix_done(&product);
    orl_thread_pool_stop(pool);
}

/* The light of a column is transmitted as by the BSDF's transmittance; a single value is the
 * BSDF's. */
static void test_transmission(void **state)
{
    size_t size, rows, columns;
    char *xml = (char *)scene_read_bytes("tests/fixtures/bsdf_klems41.xml", &size);
    struct orl_basis basis;
    struct orl_bsdf *bsdf;
    struct orl_error err = {0};
    float *values;
    (void)state;
    assert_int_equal(orl_bsdf_load_xml("k.xml", xml, size, &bsdf, &err), 0);
    assert_int_equal(orl_bsdf_transmission(bsdf, &rows, &columns, &values, &err), 0);
    assert_int_equal(orl_basis_standard("LBNL/Klems Quarter", &basis), 0);
    assert_int_equal(rows, 41);
    assert_int_equal(columns, 41);
    for (int c = 0; c < 41; c++) {
        const struct orl_vec3 in = orl_neg(orl_basis_direction(&basis, c, 0.4, 0.6));
        const struct orl_vec3 out = orl_basis_direction(&basis, 40 - c, 0.6, 0.4);
        const double omega = orl_basis_ring(&basis, c)->omega_sr;
        double sum = 0;
        for (int r = 0; r < 41; r++)
            sum += (double)values[3 * (r * 41 + c)] * orl_basis_ring(&basis, r)->omega_sr / omega;
        const double all = orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT).r;
        assert_true(all > 0 && fabs(sum / all - 1) < 1e-6);
        const double one = orl_bsdf_eval(bsdf, in, out).r * omega;
        assert_true(fabs((double)values[3 * ((40 - c) * 41 + c)] - one) <= 1e-6 * one);
    }
    free(values);
    orl_bsdf_unref(bsdf);
    free(xml);
    xml = (char *)scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size);
    assert_int_equal(orl_bsdf_load_xml("t.xml", xml, size, &bsdf, &err), 0);
    assert_int_equal(orl_bsdf_transmission(bsdf, &rows, &columns, &values, &err),
                     ORL_ERR_UNSUPPORTED);
    orl_bsdf_unref(bsdf);
    free(xml);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),         cmocka_unit_test(test_binary),
        cmocka_unit_test(test_product),      cmocka_unit_test(test_what_is_wrong),
        cmocka_unit_test(test_transmission),
    };
    return cmocka_run_group_tests_name("matrix_file", tests, NULL, NULL);
}
