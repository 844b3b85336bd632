/* The scanner of text files: lines, words, cells and numbers, and refusals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/scanner.h>

static struct orl_scanner scanner_of(const char *text, unsigned options)
{
    struct orl_scanner scanner;
    struct orl_error err = {0};
    if (orl_scanner_init(&scanner, "a.txt", text, strlen(text), options, &err) < 0)
        fail_msg("%s", err.message);
    return scanner;
}

static void assert_span(struct orl_slice span, const char *wanted)
{
    if (!orl_slice_is(span, wanted))
        fail_msg("'%.*s' is not '%s'", (int)span.length, span.text, wanted);
}

/* Checks lines in the form "1:first 2:second ..." */
static void assert_lines(const char *text, const char *wanted)
{
    struct orl_scanner scanner = scanner_of(text, 0);
    struct orl_slice line;
    char found[256] = "";
    while (orl_scanner_line(&scanner, &line)) {
        const size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "%d:%.*s ", scanner.line, (int)line.length,
                 line.text);
    }
    assert_string_equal(found, wanted);
}

static void test_lines_end_in_three_ways(void **state)
{
    (void)state;
    assert_lines("a\nb\n", "1:a 2:b ");
    assert_lines("a\r\nb\r\n", "1:a 2:b ");
    assert_lines("a\rb\r", "1:a 2:b ");
    assert_lines("a\r\r\nb\n\rc", "1:a 2: 3:b 4: 5:c ");
    assert_lines("a\nb", "1:a 2:b ");
    assert_lines("\n\na", "1: 2: 3:a ");
    assert_lines("", "");
}

static void test_marks_at_both_ends_are_cut(void **state)
{
    (void)state;
    assert_lines("\xef\xbb\xbf"
                 "a\nb\n",
                 "1:a 2:b ");
    assert_lines("a\nb\n\x1a", "1:a 2:b ");
    assert_lines("a\nb\x1a\x1a\r\n \n", "1:a 2:b ");
    assert_lines("a\nb\n \n", "1:a 2:b 3:  ");
    assert_lines("a\x1a"
                 "b\n",
                 "1:a\x1a"
                 "b ");
}

static void test_what_is_no_text_is_refused(void **state)
{
    static const struct {
        const char *bytes;
        size_t size;
        const char *message;
    } refused[] = {{"\xff\xfe"
                    "a\0",
                    4, "UTF-16"},
                   {"\xfe\xff\0a", 4, "UTF-16"},
                   {"a\0b\0c\0", 6, "UTF-16"},
                   {"\0a\0b", 4, "UTF-16"},
                   {"\x89PNG\r\n\x1a\n\0\0\0\r", 12, "byte 9 is 0x00"},
                   {"PK\x03\x04", 4, "byte 3 is 0x03"}};
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        struct orl_scanner scanner;
        struct orl_error err = {0};
        assert_int_equal(
            orl_scanner_init(&scanner, "a.txt", refused[i].bytes, refused[i].size, 0, &err),
            ORL_ERR_SYNTAX);
        assert_non_null(strstr(err.message, refused[i].message));
        assert_non_null(strstr(err.hint, "UTF-8"));
        assert_string_equal(err.file, "a.txt");
        assert_int_equal(err.line, 1);
    }
}

/* A file with a text header may have any bytes after it. */
static void test_a_head_is_followed_by_bytes(void **state)
{
    static const char bytes[] = "head\n\n\0\x01\x02\x1a";
    struct orl_scanner scanner;
    struct orl_error err = {0};
    struct orl_slice line;
    (void)state;
    assert_int_equal(
        orl_scanner_init(&scanner, "m", bytes, sizeof bytes - 1, ORL_SCANNER_TEXT_HEADER, &err), 0);
    assert_true(orl_scanner_line(&scanner, &line));
    assert_span(line, "head");
    assert_true(orl_scanner_next_line(&scanner));
    assert_true(orl_scanner_next_line(&scanner));
    assert_int_equal(scanner.end - scanner.at, 4);
    assert_int_equal(orl_scanner_rest_is_text(&scanner, &err), ORL_ERR_SYNTAX);
    assert_int_equal(
        orl_scanner_init(&scanner, "m", "head\n1 2\n\x1a", 10, ORL_SCANNER_TEXT_HEADER, &err), 0);
    assert_true(orl_scanner_line(&scanner, &line));
    assert_int_equal(orl_scanner_rest_is_text(&scanner, &err), 0);
    assert_true(orl_scanner_line(&scanner, &line));
    assert_span(line, "1 2");
    assert_false(orl_scanner_line(&scanner, &line));
}

/* Checks words in the form "line:word line:word ..." */
static void assert_words(const char *text, unsigned options, const char *wanted)
{
    struct orl_scanner scanner = scanner_of(text, options);
    struct orl_slice word;
    char found[256] = "";
    while (orl_scanner_word(&scanner, &word)) {
        const size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "%d:%.*s ", scanner.line, (int)word.length,
                 word.text);
    }
    assert_string_equal(found, wanted);
}

static void test_words(void **state)
{
    (void)state;
    assert_words(" a\tb \n\n c", 0, "1:a 1:b 3:c ");
    assert_words("a # b\nc#d", 0, "1:a 1:# 1:b 2:c#d ");
    assert_words("a # b\nc#d\n#e", ORL_SCANNER_COMMENTS, "1:a 2:c#d ");
    assert_words("a#b c\rd", ORL_SCANNER_COMMENTS | ORL_SCANNER_COMMENTS_IN_WORDS, "1:a 2:d ");
    assert_words("# \xe4 \xff\na", ORL_SCANNER_COMMENTS, "2:a ");
    assert_words("a \\\nb\\\r\nc \\d \\  \r e\\", ORL_SCANNER_CONTINUATIONS,
                 "1:a 2:b 3:c 3:\\d 4:e ");
    assert_words("a \\\nb", 0, "1:a 1:\\ 2:b ");
}

/* Joined lines are one line: its words continue, and the next line follows the last of them. */
static void test_words_of_a_line(void **state)
{
    struct orl_scanner scanner = scanner_of("a \\\n b # c\n\nd", 3);
    struct orl_slice word;
    (void)state;
    assert_true(orl_scanner_next_line(&scanner));
    assert_true(orl_scanner_word_of_line(&scanner, &word));
    assert_true(orl_scanner_word_of_line(&scanner, &word));
    assert_span(word, "b");
    assert_int_equal(scanner.line, 2);
    assert_false(orl_scanner_word_of_line(&scanner, &word));
    assert_true(orl_scanner_next_line(&scanner));
    assert_false(orl_scanner_word_of_line(&scanner, &word));
    assert_true(orl_scanner_next_line(&scanner));
    assert_int_equal(scanner.line, 4);
    assert_true(orl_scanner_word_of_line(&scanner, &word));
    assert_false(orl_scanner_next_line(&scanner));
}

static void test_quoted_words(void **state)
{
    static const char text[] = " a \"b c\" 'd' \"e";
    struct orl_slice rest = {text, sizeof text - 1}, word;
    (void)state;
    assert_int_equal(orl_slice_take_quoted(&rest, &word), 1);
    assert_span(word, "a");
    assert_int_equal(orl_slice_take_quoted(&rest, &word), 1);
    assert_span(word, "b c");
    assert_int_equal(orl_slice_take_quoted(&rest, &word), 1);
    assert_span(word, "d");
    assert_int_equal(orl_slice_take_quoted(&rest, &word), -1);
    rest.length = 0;
    assert_int_equal(orl_slice_take_quoted(&rest, &word), 0);
}

/* Checks cells in the form "[a][b]..." */
static void assert_table(const char *line, char separator, const char *wanted)
{
    struct orl_slice rest = {line, strlen(line)}, cell;
    char found[256] = "";
    while (orl_slice_take_cell(&rest, separator, &cell)) {
        const size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "[%.*s]", (int)cell.length, cell.text);
    }
    assert_string_equal(found, wanted);
}

static void test_cells_of_tables(void **state)
{
    (void)state;
    assert_table("a, b ,,c", ',', "[a][b][][c]");
    assert_table("", ',', "[]");
    assert_table("a,", ',', "[a][]");
    assert_table(" \"a,b\" ,c\"d", ',', "[a,b][c\"d]");
    assert_table("\"a,b", ',', "[\"a][b]");
    assert_table("0,5;1\t2;3", ';', "[0,5][1\t2][3]");
    assert_table("0\t\t1", '\t', "[0][][1]");
}

static void assert_cells(const char *line, const char *wanted)
{
    struct orl_cells cells;
    struct orl_slice cell;
    char found[256] = "";
    orl_cells_init(&cells, (struct orl_slice){line, strlen(line)});
    while (orl_cells_next(&cells, &cell)) {
        const size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "[%.*s]", (int)cell.length, cell.text);
    }
    assert_string_equal(found, wanted);
}

static void test_cells_of_numbers(void **state)
{
    (void)state;
    assert_cells(" 0 0.5\t1 ", "[0][0.5][1]");
    assert_cells("0,0.5 , 1", "[0][0.5][1]");
    assert_cells("0,,1", "[0][][1]");
    assert_cells(",1,", "[][1][]");
    assert_cells("0,5 0,8 0,0", "[0,5][0,8][0,0]");
    assert_cells("0,5;0,8;1", "[0,5][0,8][1]");
    assert_cells("0,5e-1 -1", "[0,5e-1][-1]");
    assert_cells("0,90", "[0][90]");
    assert_cells("0,0,1 0,0,1", "[0][0][1][0][0][1]");
    assert_cells("0 0 0.8,0 0 1", "[0][0][0.8][0][0][1]");
    assert_cells("", "");
}

/* Checks the error of the first number that is refused. */
static void assert_refused(const char *text, int code, const char *message)
{
    struct orl_scanner scanner = scanner_of(text, 0);
    struct orl_error err = {0};
    struct orl_cells cells;
    struct orl_slice line, cell;
    double value = 7;
    int found = 0;
    while (found == 0 && orl_scanner_line(&scanner, &line)) {
        orl_cells_init(&cells, line);
        while (found == 0 && orl_cells_next(&cells, &cell))
            found = orl_scanner_number(&scanner, cell, NULL, &value, &err);
    }
    assert_int_equal(found, code);
    assert_string_equal(err.message, message);
    assert_int_equal(err.line, 2);
}

static void test_numbers(void **state)
{
    static const char *const same[] = {"1", "+1", "1.", "1e0", "10E-1", "0.1e+1", "001"};
    struct orl_scanner scanner = scanner_of("x", 0);
    struct orl_error err = {0};
    (void)state;
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        double value = 0;
        const struct orl_slice span = {same[i], strlen(same[i])};
        assert_int_equal(orl_scanner_number(&scanner, span, NULL, &value, &err), 0);
        assert_true(value == 1);
    }
    assert_refused("0\n1 0,5\n", ORL_ERR_SYNTAX, "column 3: 0,5: a decimal comma; write 0.5");
    assert_refused("0\n0,,0\n", ORL_ERR_SYNTAX, "column 3: an empty cell; write its number");
    assert_refused("0\n\xc3\xa4\n", ORL_ERR_SYNTAX, "column 1: '\xc3\xa4' is not a number");
    assert_refused("0\n1 0x1p4\n", ORL_ERR_SYNTAX, "column 3: '0x1p4' is not a number");
    assert_refused("0\n1 nan\n", ORL_ERR_RANGE, "column 3: 'nan' is not a finite number");
    assert_refused("0\n1 1e999\n", ORL_ERR_RANGE, "column 3: '1e999' is not a finite number");
}

static void test_columns_count_letters(void **state)
{
    struct orl_scanner scanner = scanner_of("a\n\xc3\xa4\tb c\n", 0);
    struct orl_slice line, word;
    (void)state;
    assert_true(orl_scanner_line(&scanner, &line));
    assert_true(orl_scanner_line(&scanner, &line));
    orl_slice_take_word(&line);
    word = orl_slice_take_word(&line);
    assert_span(word, "b");
    assert_int_equal(orl_scanner_column(&scanner, word), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lines_end_in_three_ways),
                                       cmocka_unit_test(test_marks_at_both_ends_are_cut),
                                       cmocka_unit_test(test_what_is_no_text_is_refused),
                                       cmocka_unit_test(test_a_head_is_followed_by_bytes),
                                       cmocka_unit_test(test_words),
                                       cmocka_unit_test(test_words_of_a_line),
                                       cmocka_unit_test(test_quoted_words),
                                       cmocka_unit_test(test_cells_of_tables),
                                       cmocka_unit_test(test_cells_of_numbers),
                                       cmocka_unit_test(test_numbers),
                                       cmocka_unit_test(test_columns_count_letters)};
    return cmocka_run_group_tests_name("scanner", tests, NULL, NULL);
}
