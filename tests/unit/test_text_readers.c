/*
 * Text files in the forms that users have, for every reader of text: a byte order mark, line ends
 * of Windows or old Macs, UTF-16, Latin-1, a decimal comma, an empty cell, no end of the last
 * line, a trailing Ctrl-Z. Each form gives the values of the plain file, or is refused by line
 * with a remedy.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf/bsdf.h>

#include "support/text_readers.h"

enum { TEXT_BYTES = 4096 };

/* ---- Files ----------------------------------------------------------------------------------- */

/* Reads bytes from a block of exact size, so that AddressSanitizer detects reads beyond its end. */
static int read_bytes(const struct text_reader *reader, const char *bytes, size_t size,
                      struct text_values *ret_values, struct orl_error *err)
{
    char *const exact = malloc(size ? size : 1);
    assert_non_null(exact);
    memcpy(exact, bytes, size);
    *ret_values = (struct text_values){.length = 0};
    memset(err, 0, sizeof *err);
    const int code = reader->read(exact, size, ret_values, err);
    free(exact);
    return code;
}

static void assert_same(const struct text_reader *reader, const char *what, const char *bytes,
                        size_t size)
{
    struct text_values plain, values;
    struct orl_error err;
    if (read_bytes(reader, reader->text, strlen(reader->text), &plain, &err) < 0)
        fail_msg("%s: line %d: %s", reader->name, err.line, err.message);
    assert_true(plain.length > 0);
    if (read_bytes(reader, bytes, size, &values, &err) < 0)
        fail_msg("%s, %s: line %d: %s", reader->name, what, err.line, err.message);
    if (strcmp(plain.text, values.text) != 0)
        fail_msg("%s, %s: %s, not %s", reader->name, what, values.text, plain.text);
}

static void assert_refused(const struct text_reader *reader, const char *what, const char *bytes,
                           size_t size, int line, const char *message)
{
    struct text_values values;
    struct orl_error err;
    char said[1200];
    const int code = read_bytes(reader, bytes, size, &values, &err);
    snprintf(said, sizeof said, "%s (%s)", err.message, err.hint);
    if (code >= 0 || err.line != line || !strstr(said, message))
        fail_msg("%s, %s: code %d, line %d: %s; not line %d: %s", reader->name, what, code,
                 err.line, said, line, message);
}

/*
 * Returns the size of the text with each "
 * " replaced.
 */
static size_t with_line_ends(const char *text, const char *line_end, char ret_text[TEXT_BYTES])
{
    size_t size = 0;
    for (; *text; text++) {
        assert_true(size + 2 < TEXT_BYTES);
        if (*text == '\n')
            size += (size_t)snprintf(ret_text + size, TEXT_BYTES - size, "%s", line_end);
        else
            ret_text[size++] = *text;
    }
    return size;
}

static size_t as_utf16(const char *text, bool marked, char ret_text[TEXT_BYTES])
{
    size_t size = 0;
    if (marked) {
        memcpy(ret_text, "\xff\xfe", 2);
        size = 2;
    }
    for (; *text; text++) {
        assert_true(size + 2 < TEXT_BYTES);
        ret_text[size++] = *text;
        ret_text[size++] = '\0';
    }
    return size;
}

#define EACH_READER(reader)                                                                        \
    for (const struct text_reader *reader = text_readers; reader < text_readers + n_text_readers;  \
         reader++)

static void test_a_byte_order_mark_is_skipped(void **state)
{
    char bytes[TEXT_BYTES];
    (void)state;
    EACH_READER(reader)
    {
        const int n = snprintf(bytes, sizeof bytes, "\xef\xbb\xbf%s", reader->text);
        assert_same(reader, "byte order mark", bytes, (size_t)n);
    }
}

static void test_lines_end_in_any_way(void **state)
{
    char bytes[TEXT_BYTES];
    (void)state;
    EACH_READER(reader)
    {
        assert_same(reader, "CRLF", bytes, with_line_ends(reader->text, "\r\n", bytes));
        assert_same(reader, "CR alone", bytes, with_line_ends(reader->text, "\r", bytes));
        assert_same(reader, "no last line end", reader->text, strlen(reader->text) - 1);
    }
}

static void test_ctrl_z_ends_a_file(void **state)
{
    char bytes[TEXT_BYTES];
    (void)state;
    EACH_READER(reader)
    {
        int n = snprintf(bytes, sizeof bytes, "%s\x1a", reader->text);
        assert_same(reader, "Ctrl-Z", bytes, (size_t)n);
        n = snprintf(bytes, sizeof bytes, "%s\x1a\r\n", reader->text);
        assert_same(reader, "Ctrl-Z on a line", bytes, (size_t)n);
    }
}

static void test_latin1_is_read_where_text_is_free(void **state)
{
    (void)state;
    EACH_READER(reader)
    if (reader->latin1)
        assert_same(reader, "Latin-1", reader->latin1, strlen(reader->latin1));
}

static void test_utf16_is_refused_with_the_remedy_or_read(void **state)
{
    char bytes[TEXT_BYTES];
    (void)state;
    EACH_READER(reader)
    {
        size_t n = as_utf16(reader->text, true, bytes);
        if (text_reader_takes_utf16(reader)) {
            assert_same(reader, "UTF-16", bytes, n);
            continue;
        }
        assert_refused(reader, "UTF-16", bytes, n, 1, "save it as UTF-8");
        n = as_utf16(reader->text, false, bytes);
        assert_refused(reader, "UTF-16 without mark", bytes, n, 1, "save it as UTF-8");
    }
}

static void test_bad_numbers_are_refused_by_line(void **state)
{
    (void)state;
    EACH_READER(reader)
    {
        const struct text_fault *fault = &reader->decimal_comma;
        if (fault->text)
            assert_refused(reader, "decimal comma", fault->text, strlen(fault->text), fault->line,
                           fault->message);
        fault = &reader->empty_cell;
        if (fault->text)
            assert_refused(reader, "empty cell", fault->text, strlen(fault->text), fault->line,
                           fault->message);
    }
}

/* XML in Latin-1 that does not name its encoding, and in one that the parser does not know. */
static void test_xml_in_other_encodings(void **state)
{
    static const char *const heads[] = {"", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>",
                                        "<?xml version=\"1.0\" encoding=\"windows-1252\"?>"};
    (void)state;
    EACH_READER(reader)
    for (size_t i = 0; text_reader_takes_utf16(reader) && i < sizeof heads / sizeof *heads; i++) {
        char bytes[TEXT_BYTES];
        const int n = snprintf(bytes, sizeof bytes, "%s%s", heads[i],
                               TWO_CELL_XML("f\xfcr", "0.5", "0.1 0.2 0.1 0.05"));
        assert_refused(reader, heads[i], bytes, (size_t)n, 1, "as UTF-8");
    }
}

/* ---- Table ----------------------------------------------------------------------------------- */

/* Writes "read" or the line of the error into the cell. Returns false if values were read that are
 * not those of the plain file. */
static bool fill_cell(const struct text_reader *reader, const char *bytes, size_t size,
                      char ret_cell[16])
{
    struct text_values plain, values;
    struct orl_error err;
    assert_int_equal(read_bytes(reader, reader->text, strlen(reader->text), &plain, &err), 0);
    const int code = read_bytes(reader, bytes, size, &values, &err);
    if (code < 0)
        snprintf(ret_cell, 16, "line %d", err.line);
    else
        snprintf(ret_cell, 16, "read");
    return code == 0 ? strcmp(plain.text, values.text) == 0 : err.line > 0;
}

static void print_row(const struct text_reader *reader)
{
    enum { VARIANTS = 9 };
    static const char *const faulty[] = {"decimal comma", "empty cell"};
    const struct text_fault *const faults[] = {&reader->decimal_comma, &reader->empty_cell};
    char bytes[VARIANTS][TEXT_BYTES], row[200] = "";
    size_t sizes[VARIANTS] = {0}, at = 0;
    sizes[0] = (size_t)snprintf(bytes[0], TEXT_BYTES, "\xef\xbb\xbf%s", reader->text);
    sizes[1] = with_line_ends(reader->text, "\r\n", bytes[1]);
    sizes[2] = with_line_ends(reader->text, "\r", bytes[2]);
    sizes[3] = as_utf16(reader->text, true, bytes[3]);
    sizes[4] = (size_t)snprintf(bytes[4], TEXT_BYTES, "%s", reader->latin1 ? reader->latin1 : "");
    for (int i = 0; i < 2; i++)
        sizes[5 + i] = (size_t)snprintf(bytes[5 + i], TEXT_BYTES, "%s",
                                        faults[i]->text ? faults[i]->text : "");
    sizes[7] = (size_t)snprintf(bytes[7], TEXT_BYTES, "%s", reader->text) - 1;
    sizes[8] = (size_t)snprintf(bytes[8], TEXT_BYTES, "%s\x1a", reader->text);
    for (int i = 0; i < VARIANTS; i++) {
        char cell[16] = "-";
        if (sizes[i] > 0 && !fill_cell(reader, bytes[i], sizes[i], cell))
            fail_msg("%s, %s: %s", reader->name, i == 5 || i == 6 ? faulty[i - 5] : "form", cell);
        at += (size_t)snprintf(row + at, sizeof row - at, " | %7s", cell);
    }
    print_message("# %-26s%s\n", reader->name, row);
}

/* Prints a line for each reader with the outcome of each form: read, refused at a line, or - if
 * there is no such form. */
static void test_table(void **state)
{
    (void)state;
    print_message(
        "# %-26s |     BOM |    CRLF |      CR |  UTF-16 | Latin-1 |     0,5 |   empty | no "
        "end |  Ctrl-Z\n",
        "");
    EACH_READER(reader)
    print_row(reader);
}

/* A message of the program that wrote the XML, before the XML, is skipped. */
static void test_text_before_xml_is_passed_over(void **state)
{
    static const char message[] = "genBSDF: 145 rays\nand more\n",
                      xml[] =
                          "<?xml version=\"1.0\"?>\n" TWO_CELL_XML("a", "0.5", "0.1 0.2 0.1 0.05");
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_check check;
    struct orl_error err = {0};
    char text[TEXT_BYTES];
    (void)state;
    const int n = snprintf(text, sizeof text, "%s%s", message, xml);
    if (orl_bsdf_load_xml("a.xml", text, (size_t)n, &bsdf, &err) < 0)
        fail_msg("line %d: %s", err.line, err.message);
    orl_bsdf_examine(bsdf, &check);
    orl_bsdf_unref(bsdf);
    assert_int_equal(check.info.skipped_bytes, sizeof message - 1);
    bool warned = false;
    for (size_t i = 0; i < check.n_verdicts; i++)
        warned = warned || (check.verdicts[i].level == ORL_BSDF_WARNING &&
                            strstr(check.verdicts[i].text, "27 bytes of text before the XML"));
    assert_true(warned);
    /* Lines are still counted from the file's first. */
    snprintf(text, sizeof text, "%s%s", message, TWO_CELL_XML("a", "x", "0.1 0.2 0.1 0.05"));
    assert_true(orl_bsdf_load_xml("a.xml", text, strlen(text), &bsdf, &err) < 0);
    assert_int_equal(err.line, 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_byte_order_mark_is_skipped),
        cmocka_unit_test(test_lines_end_in_any_way),
        cmocka_unit_test(test_ctrl_z_ends_a_file),
        cmocka_unit_test(test_latin1_is_read_where_text_is_free),
        cmocka_unit_test(test_utf16_is_refused_with_the_remedy_or_read),
        cmocka_unit_test(test_bad_numbers_are_refused_by_line),
        cmocka_unit_test(test_xml_in_other_encodings),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_text_before_xml_is_passed_over)};
    return cmocka_run_group_tests_name("text_readers", tests, NULL, NULL);
}
