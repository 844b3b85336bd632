#include <oriel/base/scanner.h>

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/text/words.h"

#define BLANK ORL_BYTE_BLANK
#define LINE_END ORL_BYTE_LINE_END

const unsigned char orl_byte_kinds[256] = {[' '] = BLANK,  ['\t'] = BLANK,    ['\v'] = BLANK,
                                           ['\f'] = BLANK, ['\n'] = LINE_END, ['\r'] = LINE_END};

enum { CTRL_Z = 0x1a, ESCAPE = 0x1b, LOOKED_AT = 4096, NEAR = 16, STRETCH = 4096, SHOWN = 40 };

static bool is_blank(char c)
{
    return orl_byte_kind_of(c) == ORL_BYTE_BLANK;
}

static bool is_line_end(char c)
{
    return orl_byte_kind_of(c) == ORL_BYTE_LINE_END;
}

/* ---- Encoding -------------------------------------------------------------------------------- */

static int refuse_file(const char *name, struct orl_error *err, const char *what,
                       const char *remedy)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "%s", what);
    orl_error_hint(err, "%s", remedy);
    orl_error_at(err, name, 1, NULL);
    return ORL_ERR_SYNTAX;
}

/* Recognises UTF-16 by its byte order mark; without one, by a zero in every other byte of the first
 * two letters. */
static bool is_utf16(const unsigned char *b, size_t size)
{
    if (size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff)))
        return true;
    return size >= 4 && ((b[0] == 0 && b[1] != 0 && b[2] == 0 && b[3] != 0) ||
                         (b[0] != 0 && b[1] == 0 && b[2] != 0 && b[3] == 0));
}

static bool is_control(unsigned char c)
{
    return (c < ' ' && orl_byte_kinds[c] == ORL_BYTE_WORD && c != ESCAPE && c != CTRL_Z);
}

static int check_text(const char *name, struct orl_slice text, struct orl_error *err)
{
    const unsigned char *const bytes = (const unsigned char *)text.text;
    const size_t size = text.length < LOOKED_AT ? text.length : LOOKED_AT;
    if (is_utf16(bytes, size))
        return refuse_file(name, err, "the file is UTF-16 text, but only UTF-8 is supported",
                           "save it as UTF-8");
    for (size_t i = 0; i < size; i++)
        if (is_control(bytes[i])) {
            orl_error_set(err, ORL_ERR_SYNTAX, "this is not text: byte %zu is 0x%02x", i + 1,
                          (unsigned)bytes[i]);
            orl_error_hint(err, "save it as plain text, in UTF-8");
            orl_error_at(err, name, 1, NULL);
            return ORL_ERR_SYNTAX;
        }
    return 0;
}

static void skip_mark(struct orl_slice *text)
{
    if (text->length >= 3 && memcmp(text->text, "\xef\xbb\xbf", 3) == 0) {
        text->text += 3;
        text->length -= 3;
    }
}

/* Removes Ctrl-Z and the blanks after it. Blanks at the end of a text without Ctrl-Z stay. */
static void cut_ctrl_z(struct orl_slice *text)
{
    size_t length = text->length;
    for (size_t i = length; i > 0; i--) {
        const char c = text->text[i - 1];
        if (c == CTRL_Z)
            length = i - 1;
        else if (orl_byte_kind_of(c) == ORL_BYTE_WORD)
            break;
    }
    text->length = length;
}

int orl_text_trim(const char *name, struct orl_slice *text, struct orl_error *err)
{
    struct orl_slice rest = *text;
    skip_mark(&rest);
    cut_ctrl_z(&rest);
    const int code = check_text(name, rest, err);
    if (code == 0)
        *text = rest;
    return code;
}

int orl_scanner_init(struct orl_scanner *scanner, const char *name, const char *text, size_t size,
                     unsigned options, struct orl_error *err)
{
    struct orl_slice whole = {text ? text : "", text ? size : 0};
    int code = 0;
    if (options & ORL_SCANNER_TEXT_HEADER) {
        skip_mark(&whole);
        if (is_utf16((const unsigned char *)whole.text, whole.length))
            code = check_text(name, whole, err);
    } else {
        code = orl_text_trim(name, &whole, err);
    }
    if (code < 0)
        return code;
    *scanner = (struct orl_scanner){.at = whole.text,
                                    .end = whole.text + whole.length,
                                    .begin = whole.text,
                                    .name = name,
                                    .line = 1,
                                    .options = options,
                                    .fresh = true};
    return 0;
}

int orl_scanner_rest_is_text(struct orl_scanner *scanner, struct orl_error *err)
{
    struct orl_slice rest = {scanner->at, (size_t)(scanner->end - scanner->at)};
    cut_ctrl_z(&rest);
    const int code = check_text(scanner->name, rest, err);
    if (code < 0)
        return code;
    scanner->end = rest.text + rest.length;
    return 0;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

/* Most lines are too short for a call of memchr to pay off. Longer ones are searched in chunks of
 * STRETCH bytes. Otherwise a file whose lines end in "\r" alone would be searched to its end for
 * each line. */
const char *orl_line_end(const char *at, const char *end)
{
    const char *const near = end - at < NEAR ? end : at + NEAR;
    for (; at < near; at++)
        if (is_line_end(*at))
            return at;
    while (at < end) {
        const size_t stretch = end - at < STRETCH ? (size_t)(end - at) : STRETCH;
        const char *const feed = memchr(at, '\n', stretch);
        const char *const carriage = memchr(at, '\r', feed ? (size_t)(feed - at) : stretch);
        if (carriage || feed)
            return carriage ? carriage : feed;
        at += stretch;
    }
    return end;
}

/* Goes to the start of the next line; `at` is at a line's end. */
static void pass_line_end(struct orl_scanner *scanner, const char *at)
{
    const bool both = *at == '\r' && scanner->end - at > 1 && at[1] == '\n';
    scanner->at = scanner->begin = at + 1 + both;
    scanner->line++;
}

/* Returns the line's end if only a backslash and blanks stand before it, else NULL. */
static const char *continuation_end(const struct orl_scanner *scanner, const char *at)
{
    if (*at++ != '\\')
        return NULL;
    while (at < scanner->end && is_blank(*at))
        at++;
    return at == scanner->end || is_line_end(*at) ? at : NULL;
}

bool orl_scanner_skip_comment(struct orl_scanner *scanner)
{
    if (*scanner->at == '#') {
        if (!(scanner->options & ORL_SCANNER_COMMENTS))
            return false;
        scanner->at = orl_line_end(scanner->at, scanner->end);
        return true;
    }
    if (!(scanner->options & ORL_SCANNER_CONTINUATIONS))
        return false;
    const char *const end = continuation_end(scanner, scanner->at);
    if (!end)
        return false;
    if (end == scanner->end)
        scanner->at = end;
    else
        pass_line_end(scanner, end);
    return true;
}

const char *orl_scanner_word_end(struct orl_scanner *scanner, const char *word)
{
    const char *end = scanner->at;
    if (scanner->options & ORL_SCANNER_COMMENTS_IN_WORDS) {
        const char *const cut = memchr(word + 1, '#', (size_t)(end - word - 1));
        end = cut ? cut : end;
    }
    if ((scanner->options & ORL_SCANNER_CONTINUATIONS) && end - word > 1 && end[-1] == '\\' &&
        continuation_end(scanner, end - 1))
        end--;
    scanner->at = end;
    return end;
}

bool orl_scanner_next_line(struct orl_scanner *scanner)
{
    if (scanner->fresh) {
        scanner->fresh = false;
        return scanner->at < scanner->end;
    }
    const bool at_end = scanner->at < scanner->end && is_line_end(*scanner->at);
    const char *const end = at_end ? scanner->at : orl_line_end(scanner->at, scanner->end);
    if (end == scanner->end) {
        scanner->at = end;
        return false;
    }
    pass_line_end(scanner, end);
    return scanner->at < scanner->end;
}

bool orl_scanner_line(struct orl_scanner *scanner, struct orl_slice *ret_line)
{
    if (!scanner->fresh && scanner->end - scanner->at > 1 && *scanner->at == '\n')
        pass_line_end(scanner, scanner->at); /* the usual case */
    else if (!orl_scanner_next_line(scanner))
        return false;
    const char *const end = orl_line_end(scanner->at, scanner->end);
    *ret_line = (struct orl_slice){scanner->at, (size_t)(end - scanner->at)};
    scanner->at = end;
    return true;
}

size_t orl_scanner_count_words(const struct orl_scanner *scanner)
{
    size_t n = 0;
    bool within = false;
    for (const char *at = scanner->at; at < scanner->end; at++) {
        const bool is_word = orl_byte_kind_of(*at) == ORL_BYTE_WORD;
        n += is_word && !within;
        within = is_word;
    }
    return n;
}

/* ---- Parts of a line ------------------------------------------------------------------------- */

bool orl_slice_is_nocase(struct orl_slice slice, const char *text)
{
    return slice.length == strlen(text) && strncasecmp(slice.text, text, slice.length) == 0;
}

bool orl_slice_begins_nocase(struct orl_slice slice, const char *text)
{
    const size_t length = strlen(text);
    return slice.length >= length && strncasecmp(slice.text, text, length) == 0;
}

static void drop_front(struct orl_slice *slice, size_t n)
{
    slice->text += n;
    slice->length -= n;
}

static void skip_blanks(struct orl_slice *slice)
{
    while (slice->length > 0 && orl_byte_kind_of(*slice->text) != ORL_BYTE_WORD)
        drop_front(slice, 1);
}

struct orl_slice orl_slice_trim(struct orl_slice slice)
{
    skip_blanks(&slice);
    while (slice.length > 0 && orl_byte_kind_of(slice.text[slice.length - 1]) != ORL_BYTE_WORD)
        slice.length--;
    return slice;
}

struct orl_slice orl_slice_before(struct orl_slice slice, char byte)
{
    const char *const at = slice.length > 0 ? memchr(slice.text, byte, slice.length) : NULL;
    return (struct orl_slice){slice.text, at ? (size_t)(at - slice.text) : slice.length};
}

struct orl_slice orl_slice_take_word(struct orl_slice *rest)
{
    skip_blanks(rest);
    struct orl_slice word = {rest->text, 0};
    while (word.length < rest->length && orl_byte_kind_of(word.text[word.length]) == ORL_BYTE_WORD)
        word.length++;
    drop_front(rest, word.length);
    return word;
}

int orl_slice_take_quoted(struct orl_slice *rest, struct orl_slice *ret_word)
{
    skip_blanks(rest);
    if (rest->length == 0)
        return 0;
    const char quote = *rest->text;
    if (quote != '"' && quote != '\'') {
        *ret_word = orl_slice_take_word(rest);
        return 1;
    }
    drop_front(rest, 1);
    *ret_word = orl_slice_before(*rest, quote);
    if (ret_word->length == rest->length)
        return -1;
    drop_front(rest, ret_word->length + 1);
    return 1;
}

/* Takes a text between double quotes, which may hold separators, off the start of a cell. Returns
 * false if the cell does not begin with a double quote. */
static bool take_quotes(struct orl_slice *rest, struct orl_slice *ret_text)
{
    struct orl_slice ahead = *rest;
    if (ahead.length < 2 || *ahead.text != '"')
        return false;
    drop_front(&ahead, 1);
    *ret_text = orl_slice_before(ahead, '"');
    if (ret_text->length == ahead.length)
        return false;
    drop_front(&ahead, ret_text->length + 1);
    *rest = ahead;
    return true;
}

bool orl_slice_take_cell(struct orl_slice *rest, char separator, struct orl_slice *ret_cell)
{
    if (!rest->text)
        return false;
    struct orl_slice text = {NULL, 0};
    while (rest->length > 0 && *rest->text != separator && is_blank(*rest->text))
        drop_front(rest, 1);
    const bool quoted = take_quotes(rest, &text);
    const char *at = rest->text, *const end = at + rest->length;
    while (at < end && *at != separator)
        at++;
    if (!quoted)
        text = (struct orl_slice){rest->text, (size_t)(at - rest->text)};
    *ret_cell = orl_slice_trim(text);
    *rest = at == end ? (struct orl_slice){NULL, 0}
                      : (struct orl_slice){at + 1, (size_t)(end - at - 1)};
    return true;
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static bool is_mark(char c)
{
    return c == ',' || c == ';';
}

/* Returns true if some of the words are separated only by blanks, or by semicolons. */
static bool is_spaced(struct orl_slice line)
{
    char before = ',';
    for (size_t i = 0; i < line.length; i++) {
        const char c = line.text[i];
        if (c == ';')
            return true;
        if (is_blank(c))
            continue;
        if (i > 0 && is_blank(line.text[i - 1]) && before != ',' && c != ',')
            return true;
        before = c;
    }
    return false;
}

void orl_cells_init(struct orl_cells *cells, struct orl_slice line)
{
    *cells = (struct orl_cells){line, line.text, line.text + line.length, '\0'};
}

/* Returns the end of the word that begins at `at`. */
static const char *skip_word(const char *at, const char *end)
{
    while (at < end && !is_blank(*at) && !is_mark(*at))
        at++;
    return at;
}

static const char *skip_blanks_to(const char *at, const char *end)
{
    while (at < end && is_blank(*at))
        at++;
    return at;
}

/* Returns the end of a cell: behind the digits after the comma if the cell is a number with a
 * decimal comma, else the comma. */
static const char *pass_decimal_comma(const struct orl_cells *cells, const char *cell,
                                      const char *comma)
{
    const char *const end = skip_word(comma + 1, cells->end);
    const struct orl_slice whole = {cell, (size_t)(end - cell)};
    const bool alone = cells->before != ',' && (end == cells->end || *end != ',');
    return alone && orl_slice_is_decimal_comma(whole) && is_spaced(cells->line) ? end : comma;
}

bool orl_cells_next(struct orl_cells *cells, struct orl_slice *ret_cell)
{
    const char *const cell = skip_blanks_to(cells->at, cells->end);
    if (cell == cells->end && !cells->before)
        return false;
    const char *at = skip_word(cell, cells->end);
    if (at < cells->end && *at == ',')
        at = pass_decimal_comma(cells, cell, at);
    *ret_cell = (struct orl_slice){cell, (size_t)(at - cell)};
    at = skip_blanks_to(at, cells->end);
    cells->before = at < cells->end && is_mark(*at) ? *at++ : '\0';
    cells->at = at;
    return true;
}

/* ---- Numbers --------------------------------------------------------------------------------- */

static const char *skip_digits(const char *at, const char *end)
{
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    return at;
}

bool orl_slice_is_decimal_comma(struct orl_slice slice)
{
    const char *at = slice.text, *const end = at + slice.length;
    at += at < end && (*at == '-' || *at == '+');
    const char *const comma = skip_digits(at, end);
    if (comma == end || *comma != ',')
        return false;
    const char *const last = skip_digits(comma + 1, end);
    if (last == comma + 1)
        return false;
    if (last == end)
        return true;
    if (*last != 'e' && *last != 'E')
        return false;
    at = last + 1;
    at += at < end && (*at == '-' || *at == '+');
    return at < end && skip_digits(at, end) == end;
}

static int refuse_number(const struct orl_scanner *scanner, struct orl_slice slice,
                         const char *what, enum orl_number_fault fault, struct orl_error *err)
{
    const int shown = slice.length < SHOWN ? (int)slice.length : SHOWN;
    const char *const colon = what ? ": " : "";
    char place[32] = "";
    const size_t column = orl_scanner_column(scanner, slice);
    what = what ? what : "";
    if (column > 0)
        snprintf(place, sizeof place, "column %zu: ", column);
    if (slice.length == 0)
        return orl_scanner_fail(scanner, ORL_ERR_SYNTAX, err,
                                "%s%s%san empty cell; write its number", place, what,
                                *what ? " is missing: " : "");
    if (orl_slice_is_decimal_comma(slice)) {
        char point[SHOWN + 1];
        snprintf(point, sizeof point, "%.*s", shown, slice.text);
        char *const comma = strchr(point, ',');
        if (comma)
            *comma = '.';
        return orl_scanner_fail(scanner, ORL_ERR_SYNTAX, err,
                                "%s%s%s%.*s: a decimal comma; write %s", place, what, colon, shown,
                                slice.text, point);
    }
    return orl_scanner_fail(scanner, fault == ORL_NUMBER_INFINITE ? ORL_ERR_RANGE : ORL_ERR_SYNTAX,
                            err, "%s%s%s'%.*s' is not a %snumber", place, what, colon, shown,
                            slice.text, fault == ORL_NUMBER_INFINITE ? "finite " : "");
}

int orl_scanner_number(const struct orl_scanner *scanner, struct orl_slice slice, const char *what,
                       double *ret_value, struct orl_error *err)
{
    const enum orl_number_fault fault = slice.length > 0
                                            ? orl_number_read(slice.text, slice.length, ret_value)
                                            : ORL_NUMBER_INVALID;
    return fault == ORL_NUMBER_OK ? 0 : refuse_number(scanner, slice, what, fault, err);
}

/* ---- Messages -------------------------------------------------------------------------------- */

size_t orl_scanner_column(const struct orl_scanner *scanner, struct orl_slice slice)
{
    size_t column = 1;
    if (!slice.text || slice.text < scanner->begin || slice.text > scanner->end)
        return 0;
    for (const char *at = scanner->begin; at < slice.text; at++) {
        if (is_line_end(*at))
            return 0;
        column += ((unsigned char)*at & 0xc0) != 0x80; /* counts the first byte of a letter */
    }
    return column;
}

int orl_scanner_fail(const struct orl_scanner *scanner, int code, struct orl_error *err,
                     const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    orl_error_vset(err, code, format, arguments);
    va_end(arguments);
    orl_error_at(err, scanner->name, scanner->line, NULL);
    return code;
}
