/* BSDF files as text: numbers in every form, and error messages for invalid ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bsdf/xml/data_text.h"
#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"

/* ---- Text --------------------------------------------------------------------------------------
 */

/* Numbers in every form, split anywhere: expat passes character references one by one. */
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

/* The scanner, a faster reader for blocks of data, finds the same numbers, or none. */
static void numbers_are_the_same_to_the_scanner(void **state)
{
    static const char *const numbers[] = {
        "0",          "7",          "12345678",    "123456789", "1234567890123456789",
        "1.12345678", "1.25",       "1.123456789", ".5",        "5.",
        "1.5E+03",    "1.5e-3",     "3.100e+01",   "0.000e+00", "99999999.99999999",
        "00000001.5", "1e-05",      "1e-100",      "1e5",       "1e22",
        "1e23",       "12345678e9", "1e99",        "1e31",      "1e30",
        "1.5e",       ".",          "e5",          "1.5x",      "1..2",
        "1.2.3",      "1e+",        "1e1e1",       "-1.5",      "+.5",
        "nan",        "1.5e1.5",    "1:5",         "1/5",       "1,5"};
    (void)state;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[64];
        double quick = -7, slow = -7;
        struct orl_scan scan;
        const size_t length = strcspn(numbers[i], ",");
        const int size = snprintf(text, sizeof text, "%-60s", numbers[i]);
        orl_scan_init(&scan);
        orl_scan_feed(&scan, text, (size_t)size);
        const int code = orl_scan_next(&scan, &quick, NULL);
        const int wanted = orl_number_parse(numbers[i], length, &slow, NULL);
        assert_int_equal(code, wanted == 0 ? ORL_TOKEN_NUMBER : wanted);
        assert_memory_equal(&quick, &slow, sizeof quick);
        if (code >= 0)
            assert_ptr_equal(scan.next, text + length);
    }
}

enum { FAR = 100000 }; /* lines of data before the place in question: beyond the first slice */

/* Data far into the file mostly bypass expat and are read the same, with any markup between them.
 */
static void data_far_in_read_the_same(void **state)
{
    static const char *const forms[] = {
        ".125}",        "1&#50;5e-3}", "1<!-- 5 -->25e-3}", "125e-3<!--}}-->}", "<![CDATA[.125}]]>",
        "125e-3 &#125;"};
    (void)state;
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        struct text data;
        text_open(&data);
        putc('{', data.stream);
        for (int k = 0; k < FAR; k++)
            putc('\n', data.stream);
        fputs(forms[i], data.stream);
        text_close(&data);
        struct orl_bsdf *bsdf =
            load_text(make_file("TensorTree4", "Reflection Front", NULL, data.data));
        free(data.data);
        assert_non_null(bsdf);
        assert_close(eval(bsdf, direction(0, 0, -1), direction(0.1, 0, -1)), 0.125, 0);
        orl_bsdf_unref(bsdf);
    }
}

/* A file is read in slices of 64 KiB or more; padding moves the slice border over every byte of
 * the data. */
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
        for (size_t i = at; i < 1 << 16; i++)
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
    const char *primitive, *message; /* parts of the error */
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
    {TREE3 "{{0}{0}{0}{0}{0}{0}{0}}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "instead of 8"},
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
    {BLOCK "}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "without a matching"},
    {BLOCK "{0" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "1 braces open"},
    {BLOCK "\n\n" END, ORL_ERR_SYNTAX, 14, "Transmission Back", "empty"},
    {BLOCK "{0\n0", ORL_ERR_SYNTAX, 13, "Transmission Back", "XML"},
    {BLOCK "{{{{{{{{{{0}", ORL_ERR_LIMIT, 12, "Transmission Back", "deeper"},
    {BLOCK "{{{{{{{{{0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0}", ORL_ERR_LIMIT, 12, "Transmission Back",
     "deeper"},
    {BLOCK "{&a;}" END, ORL_ERR_SYNTAX, 12, "Transmission Back", "entity"},
    {TREE "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"
          "<ScatteringData>{0}",
     ORL_ERR_SYNTAX, 9, "ScatteringData", "before WavelengthDataDirection"},
    {TREE "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"
          "<WavelengthDataDirection>Sideways</WavelengthDataDirection>",
     ORL_ERR_SYNTAX, 9, "WavelengthDataDirection", "Sideways"},
    {BLOCK "{0}</ScatteringData></WavelengthDataBlock><WavelengthDataBlock>\n"
           "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>",
     ORL_ERR_SYNTAX, 13, "Transmission Back", "twice"},
    {MATRIX("LBNL/Klems Full") "0 1 2" END, ORL_ERR_SYNTAX, 12, "Reflection Front",
     "3 values instead of the matrix's 21025"},
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
        /* The err argument is optional. */
        assert_int_equal(orl_bsdf_load_xml("x", bad->text, strlen(bad->text), &bsdf, NULL), code);
    }
}

/* Expat does not see all lines, but errors count them: amid the data and after it. */
static void errors_far_in_have_their_line(void **state)
{
    static const struct {
        const char *text;
        int line;
    } ends[] = {{"{0.5x}" END, 0},      {"{0.5 " END, 0},           {"{0.5\n\n0.5}" END, 2},
                {"{0.5}\n</Wrong>", 1}, {"{0.5}\n</Scattering", 1}, {"{0.5\n&no;}" END, 1},
                {"{0.5\n<b>", 1}};
    const char *head = BLOCK;
    int lines = 1;
    (void)state;
    for (const char *at = head; *at; at++)
        lines += *at == '\n';
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        struct orl_bsdf *bsdf = NULL;
        struct orl_error err = {0};
        struct text t;
        text_open(&t);
        fputs(head, t.stream);
        for (int k = 0; k < FAR; k++)
            putc('\n', t.stream);
        fputs(ends[i].text, t.stream);
        text_close(&t);
        assert_int_equal(orl_bsdf_load_xml("far.xml", t.data, t.size, &bsdf, &err), ORL_ERR_SYNTAX);
        assert_int_equal(err.line, lines + FAR + ends[i].line);
        free(t.data);
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

/* A file cut short anywhere is refused; it never loads in part. */
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

/* Bytes changed at random: every BSDF that loads evaluates to finite numbers. */
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

/* NaN and unnormalised directions return some number, without a fault. */
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

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_read_the_same_in_every_form),
        cmocka_unit_test(numbers_are_the_same_to_the_scanner),
        cmocka_unit_test(data_far_in_read_the_same),
        cmocka_unit_test(a_number_may_lie_across_a_slice),
        cmocka_unit_test(a_bad_file_says_what_and_where),
        cmocka_unit_test(errors_far_in_have_their_line),
        cmocka_unit_test(elements_may_not_nest_without_end),
        cmocka_unit_test(a_cut_file_is_refused),
        cmocka_unit_test(a_spoilt_file_never_does_harm),
        cmocka_unit_test(strange_directions_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
