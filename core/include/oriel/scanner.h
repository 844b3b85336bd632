/*
 * Reads text files that people and other programs wrote: lines, words, cells and numbers.
 *
 * The text. UTF-8, or any encoding that has ASCII's bytes for ASCII: bytes above 0x7f are part of
 * words and remarks, whatever they mean. A byte order mark of UTF-8 at the head is skipped. Lines
 * end in "\n", "\r\n" or "\r"; the last one may end with the file. Old programs mark the end by
 * Ctrl-Z (0x1a): such a mark is cut off, with what is blank behind it. UTF-16 and files that are
 * not text are refused, with what to do about it.
 *
 * Numbers are decimal, [+-]digits[.digits][e[+-]digits], correctly rounded and independent of the
 * locale; hexadecimal numbers, "nan" and "inf" are refused. "0,5" is refused as a decimal comma
 * wherever a comma cannot separate two cells.
 *
 * Places. Lines and columns count from 1. Columns are characters of UTF-8; a tab is one.
 *
 * Ownership: a scanner and its spans borrow the text, which need not end in NUL, and own nothing.
 * Threads: a scanner is used by one thread at a time. Time: each byte is looked at a bounded number
 * of times. Errors have the file's name and line filled in, the column in the message.
 */
#ifndef ORIEL_SCANNER_H
#define ORIEL_SCANNER_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <oriel/error.h>

/* A part of the text. */
struct orl_slice {
    const char *text;
    size_t length;
};

enum orl_scanner_option {
    ORL_SCANNER_REMARKS = 1, /* '#' where a word may begin starts a remark, up to the line's end */
    ORL_SCANNER_JOINS = 2,   /* a backslash at the end of a line joins the next line to it */
    ORL_SCANNER_HEAD = 4,    /* only the head is text: see orl_scanner_rest_is_text */
    ORL_SCANNER_CUTS = 8,    /* with REMARKS: '#' within a word starts a remark as well */
};

struct orl_scanner {
    const char *at, *end;
    const char *begin; /* of the line at hand */
    const char *name;  /* of the file, for messages; borrowed */
    int line;          /* the line at hand */
    unsigned options;  /* of enum orl_scanner_option */
    bool fresh;        /* nothing has been read */
};

/* ORL_ERR_SYNTAX: UTF-16, or no text. */
int orl_scanner_init(struct orl_scanner *scanner, const char *name, const char *text, size_t size,
                     unsigned options, struct orl_error *err);

/* With ORL_SCANNER_HEAD: the rest is text too. Checks it, and cuts Ctrl-Z off its end. */
int orl_scanner_rest_is_text(struct orl_scanner *scanner, struct orl_error *err);

/* Cuts the byte order mark and Ctrl-Z off a text that is read by other means. Errors: as
 * orl_scanner_init. */
int orl_text_trim(const char *name, struct orl_slice *text, struct orl_error *err);

/* ---- Lines ----------------------------------------------------------------------------------- */

/* Goes to the next line, the first time to the first; false: there is none. */
bool orl_scanner_next_line(struct orl_scanner *scanner);

/* Goes to the next line and takes all of it, without its end; false: there is none. */
bool orl_scanner_line(struct orl_scanner *scanner, struct orl_slice *ret_line);

/* Where the line ends that `at` lies in: at its "\n" or "\r", or at end. */
const char *orl_line_end(const char *at, const char *end);

/* ---- Words ----------------------------------------------------------------------------------- */

enum orl_byte_kind { ORL_BYTE_INK, ORL_BYTE_BLANK, ORL_BYTE_LINE_END };
extern const unsigned char orl_byte_kinds[256]; /* an enum orl_byte_kind for each byte */

static inline enum orl_byte_kind orl_byte_kind_of(char c)
{
    return (enum orl_byte_kind)orl_byte_kinds[(unsigned char)c];
}

/* Passes a joint, or a remark, that stands where a word may begin; false: there is neither. For the
 * functions below. */
bool orl_scanner_pass(struct orl_scanner *scanner);
/* Where the word that ends at scanner->at ends if '#' cuts and a backslash joins lines. */
const char *orl_scanner_word_end(struct orl_scanner *scanner, const char *word);

/* The next word of the line at hand, and of those that are joined to it; false: there is none. */
static inline bool orl_scanner_word_of_line(struct orl_scanner *scanner, struct orl_slice *ret_word)
{
    const char *at = scanner->at, *const end = scanner->end;
    scanner->fresh = false;
    for (;;) {
        while (at < end && orl_byte_kind_of(*at) == ORL_BYTE_BLANK)
            at++;
        scanner->at = at;
        if (at == end || orl_byte_kind_of(*at) == ORL_BYTE_LINE_END)
            return false;
        if ((*at != '#' && *at != '\\') || !orl_scanner_pass(scanner))
            break;
        at = scanner->at;
    }
    const char *const word = at;
    while (at < end && orl_byte_kind_of(*at) == ORL_BYTE_INK)
        at++;
    scanner->at = at;
    if (at[-1] == '\\' || (scanner->options & ORL_SCANNER_CUTS))
        at = orl_scanner_word_end(scanner, word);
    *ret_word = (struct orl_slice){word, (size_t)(at - word)};
    return true;
}

/* The next word of this line or a later one; false: there is none. */
static inline bool orl_scanner_word(struct orl_scanner *scanner, struct orl_slice *ret_word)
{
    while (!orl_scanner_word_of_line(scanner, ret_word))
        if (!orl_scanner_next_line(scanner))
            return false;
    return true;
}

/* How many words are left, remarks and joints not heeded. */
size_t orl_scanner_count_words(const struct orl_scanner *scanner);

/* ---- Parts of a line ------------------------------------------------------------------------- */

static inline bool orl_slice_is(struct orl_slice span, const char *text)
{
    return span.length == strlen(text) && memcmp(span.text, text, span.length) == 0;
}

static inline bool orl_slice_begins(struct orl_slice span, const char *text)
{
    return span.length >= strlen(text) && memcmp(span.text, text, strlen(text)) == 0;
}

bool orl_slice_is_nocase(struct orl_slice span, const char *text);
bool orl_slice_begins_nocase(struct orl_slice span, const char *text);
/* Without blanks at both ends. */
struct orl_slice orl_slice_trim(struct orl_slice span);
/* What stands before the first such byte, or all of it. */
struct orl_slice orl_slice_before(struct orl_slice span, char byte);

/* Takes the first word off rest. A word in quotes (' or ") may hold blanks: ret_word is without
 * them. Returns 1, 0 when there is none, or -1 when a quote is not closed, with the rest in
 * *ret_word. */
int orl_slice_take_quoted(struct orl_slice *rest, struct orl_slice *ret_word);
/* The same without regard to quotes; the span is empty when there is no word. */
struct orl_slice orl_slice_take_word(struct orl_slice *rest);

/*
 * Takes the first cell off a line of a table whose cells one character separates, without the
 * blanks and double quotes around it. Empty cells count. False: none is left, and rest->text is
 * NULL then.
 */
bool orl_slice_take_cell(struct orl_slice *rest, char separator, struct orl_slice *ret_cell);

/*
 * Numbers that blanks, commas or semicolons separate. Two commas or semicolons with nothing between
 * them, and one at either end of the line, have an empty cell beside them. Where blanks or
 * semicolons alone separate other words of the line, "0,5" is one cell, for orl_scanner_number to
 * refuse.
 */
struct orl_cells {
    struct orl_slice line;
    const char *at, *end;
    char before; /* the comma or semicolon in front of the next cell, or NUL */
};
void orl_cells_init(struct orl_cells *cells, struct orl_slice line);
bool orl_cells_next(struct orl_cells *cells, struct orl_slice *ret_cell);

/* ---- Numbers --------------------------------------------------------------------------------- */

/* The forms of numbers that are refused by name: "0,5"; and an empty span. */
bool orl_slice_is_decimal_comma(struct orl_slice span);

/* A part of the text as a finite number. what names it in messages ("the hour"), or is NULL.
 * Errors: ORL_ERR_SYNTAX for what is no number, ORL_ERR_RANGE for "nan", "inf" and what no double
 * holds. */
int orl_scanner_number(const struct orl_scanner *scanner, struct orl_slice span, const char *what,
                       double *ret_value, struct orl_error *err);

/* ---- Messages -------------------------------------------------------------------------------- */

/* The column of a span that begins in the line at hand; of one in another line, 0. */
size_t orl_scanner_column(const struct orl_scanner *scanner, struct orl_slice span);

/* Fills err with a message about the line at hand; returns code. */
int orl_scanner_fail(const struct orl_scanner *scanner, int code, struct orl_error *err,
                     const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
