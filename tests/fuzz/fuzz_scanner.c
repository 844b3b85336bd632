/*
 * The scanner of text files. The first byte chooses the options; the rest is the text, read by
 * lines, by words and by cells.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "fuzz/fuzz.h"

/* Checks that the span lies within the text. */
static void check_span(const struct orl_scanner *scanner, struct orl_slice text,
                       struct orl_slice span)
{
    FUZZ_PROMISE(span.text >= text.text && span.length <= text.length);
    FUZZ_PROMISE(span.text + span.length <= scanner->end);
    FUZZ_PROMISE(scanner->at <= scanner->end && scanner->line >= 1);
}

static void check_number(const struct orl_scanner *scanner, struct orl_slice span)
{
    struct orl_error err = {0};
    double value = NAN;
    const int code = orl_scanner_number(scanner, span, "it", &value, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        FUZZ_PROMISE(isfinite(value) && !orl_slice_is_decimal_comma(span));
}

static void check_parts(const struct orl_scanner *scanner, struct orl_slice line)
{
    struct orl_slice rest = line, part;
    struct orl_cells cells;
    size_t n = 0;
    orl_cells_init(&cells, line);
    for (; orl_cells_next(&cells, &part); n++) {
        check_span(scanner, line, part);
        check_number(scanner, part);
    }
    FUZZ_PROMISE(n <= line.length + 1);
    for (n = 0; orl_slice_take_cell(&rest, ',', &part); n++)
        check_span(scanner, line, part);
    FUZZ_PROMISE(n >= 1 && n <= line.length + 1);
    rest = line;
    while (orl_slice_take_quoted(&rest, &part) == 1)
        check_span(scanner, line, part);
}

static bool read_all(const char *text, size_t size, unsigned options)
{
    struct orl_scanner scanner, words;
    struct orl_error err = {0};
    struct orl_slice part;
    int line = 0;
    const int code = orl_scanner_init(&scanner, "text", text, size, options, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return false;
    }
    words = scanner;
    for (; orl_scanner_line(&scanner, &part); line++) {
        FUZZ_PROMISE(scanner.line == line + 1);
        check_span(&scanner, (struct orl_slice){text, size}, part);
        check_parts(&scanner, part);
    }
    for (size_t n = 0; orl_scanner_word(&words, &part); n++) {
        FUZZ_PROMISE(n < size && part.length > 0 && words.line <= line);
        check_span(&words, (struct orl_slice){text, size}, part);
    }
    FUZZ_PROMISE(words.at == words.end && scanner.at == scanner.end);
    return true;
}

bool fuzz_scanner(const uint8_t *data, size_t size)
{
    if (size == 0)
        return false;
    char *exact = malloc(size);
    FUZZ_PROMISE(exact != NULL);
    memcpy(exact, data + 1, size - 1);
    const bool accepted = read_all(exact, size - 1, *data & 0xfu);
    free(exact);
    return accepted;
}
