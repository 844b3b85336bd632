/*
 * A scanner for text files: lines, words, cells of tables, and numbers.
 *
 * Encoding. UTF-8, or any encoding that is a superset of ASCII: bytes above 0x7f are parts of words
 * and comments. A UTF-8 byte order mark at the head is skipped. Lines end in "\n", "\r\n" or "\r";
 * the last line may end with the file. A Ctrl-Z (0x1a) that marks the end of the file is cut off,
 * as are blanks after it. UTF-16 and binary files are refused with a hint.
 *
 * Numbers are decimal, [+-]digits[.digits][e[+-]digits], correctly rounded and independent of the
 * locale; hexadecimal numbers, "nan" and "inf" are refused. "0,5" is refused as a decimal comma
 * wherever a comma cannot separate two cells.
 *
 * Positions. Lines and columns count from 1. Columns are characters of UTF-8; a tab is one.
 *
 * Ownership: a scanner and its slices borrow the text, which need not end in NUL, and own nothing.
 * Threads: a scanner is used by one thread at a time. Time: each byte is looked at a bounded number
 * of times. Errors have the file's name and line filled in, the column in the message.
 */
#ifndef ORIEL_BASE_SCANNER_H
#define ORIEL_BASE_SCANNER_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <oriel/base/error.h>

/* Part of a text; borrowed. */
struct orl_slice {
    const char *text;
    size_t length;
};

enum orl_scanner_option {
    /* '#' where a word may begin starts a comment, up to the line's end. */
    ORL_SCANNER_COMMENTS = 1,
    ORL_SCANNER_CONTINUATIONS = 2, /* a backslash at a line's end continues it on the next line */
    ORL_SCANNER_TEXT_HEADER = 4,   /* only the header is text: see orl_scanner_rest_is_text */
    /* With ORL_SCANNER_COMMENTS: '#' within a word starts a comment as well. */
    ORL_SCANNER_COMMENTS_IN_WORDS = 8,
};

struct orl_scanner {
    const char *at, *end;
    const char *begin; /* start of the current line */
    const char *name;  /* file name for messages; borrowed */
    int line;          /* number of the current line */
    unsigned options;  /* bits of enum orl_scanner_option */
    bool fresh;        /* true: nothing was read yet */
};

/* Starts a scanner. Returns 0, or ORL_ERR_SYNTAX for UTF-16 and binary files. */
int orl_scanner_init(struct orl_scanner *scanner, const char *name, const char *text, size_t size,
                     unsigned options, struct orl_error *err);

/* After a header read with ORL_SCANNER_TEXT_HEADER: checks that the rest is text as well, and cuts
 * Ctrl-Z off its end. */
int orl_scanner_rest_is_text(struct orl_scanner *scanner, struct orl_error *err);

/* Cuts the byte order mark and Ctrl-Z off a text for a reader with a tokenizer of its own. Errors
 * are those of orl_scanner_init. */
int orl_text_trim(const char *name, struct orl_slice *text, struct orl_error *err);

/* ---- Lines ----------------------------------------------------------------------------------- */

/* Goes to the next line; the first call goes to the first line. Returns false at the end. */
bool orl_scanner_next_line(struct orl_scanner *scanner);

/* Goes to the next line and returns all of it, without its end. Returns false at the end. */
bool orl_scanner_line(struct orl_scanner *scanner, struct orl_slice *ret_line);

/* Returns the end of the line that `at` lies in: its "\n" or "\r", or `end`. */
const char *orl_line_end(const char *at, const char *end);

/* ---- Words ----------------------------------------------------------------------------------- */

enum orl_byte_kind { ORL_BYTE_WORD, ORL_BYTE_BLANK, ORL_BYTE_LINE_END };
extern const unsigned char orl_byte_kinds[256]; /* an enum orl_byte_kind for each byte */

static inline enum orl_byte_kind orl_byte_kind_of(char c)
{
    return (enum orl_byte_kind)orl_byte_kinds[(unsigned char)c];
}

/* Skips a comment or a continuation where a word may begin; returns false if there is neither. For
 * the functions below. */
bool orl_scanner_skip_comment(struct orl_scanner *scanner);
/* Returns the end of the word that begins at `word`, in front of a comment within it and of a
 * backslash that continues the line. */
const char *orl_scanner_word_end(struct orl_scanner *scanner, const char *word);

/* Takes the next word of the current line and its continuations. Returns false if there is none. */
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
        if ((*at != '#' && *at != '\\') || !orl_scanner_skip_comment(scanner))
            break;
        at = scanner->at;
    }
    const char *const word = at;
    while (at < end && orl_byte_kind_of(*at) == ORL_BYTE_WORD)
        at++;
    scanner->at = at;
    if (at[-1] == '\\' || (scanner->options & ORL_SCANNER_COMMENTS_IN_WORDS))
        at = orl_scanner_word_end(scanner, word);
    *ret_word = (struct orl_slice){word, (size_t)(at - word)};
    return true;
}

/* Takes the next word of this line or a later one. Returns false if there is none. */
static inline bool orl_scanner_word(struct orl_scanner *scanner, struct orl_slice *ret_word)
{
    while (!orl_scanner_word_of_line(scanner, ret_word))
        if (!orl_scanner_next_line(scanner))
            return false;
    return true;
}

/* Counts the words that are left, those of comments included. */
size_t orl_scanner_count_words(const struct orl_scanner *scanner);

/* ---- Parts of a line ------------------------------------------------------------------------- */

static inline bool orl_slice_is(struct orl_slice slice, const char *text)
{
    return slice.length == strlen(text) && memcmp(slice.text, text, slice.length) == 0;
}

static inline bool orl_slice_begins(struct orl_slice slice, const char *text)
{
    return slice.length >= strlen(text) && memcmp(slice.text, text, strlen(text)) == 0;
}

bool orl_slice_is_nocase(struct orl_slice slice, const char *text);
bool orl_slice_begins_nocase(struct orl_slice slice, const char *text);
/* Returns the slice without blanks at both ends. */
struct orl_slice orl_slice_trim(struct orl_slice slice);
/* Returns the part before the first such byte, or the whole slice if it has none. */
struct orl_slice orl_slice_before(struct orl_slice slice, char byte);

/* Takes the first word off rest. A word in quotes (' or ") may hold blanks: ret_word is without
 * them. Returns 1, 0 when there is none, or -1 when a quote is not closed, with the rest in
 * *ret_word. */
int orl_slice_take_quoted(struct orl_slice *rest, struct orl_slice *ret_word);
/* Takes the first word off rest; quotes are ordinary letters. The word is empty if there is none.
 */
struct orl_slice orl_slice_take_word(struct orl_slice *rest);

/*
 * Takes the first cell off a line of a table whose cells one character separates, without the
 * blanks and double quotes around it. Empty cells count. Returns false if no cell is left; then
 * rest->text is NULL.
 */
bool orl_slice_take_cell(struct orl_slice *rest, char separator, struct orl_slice *ret_cell);

/*
 * Iterator over numbers that are separated by blanks, commas or semicolons. Two commas or
 * semicolons with nothing between them enclose an empty cell; one at either end of the line has an
 * empty cell beside it. If only blanks or semicolons separate the other words of the line, "0,5" is
 * one cell, which orl_scanner_number rejects.
 */
struct orl_cells {
    struct orl_slice line;
    const char *at, *end;
    char before; /* the comma or semicolon in front of the next cell, or NUL */
};
void orl_cells_init(struct orl_cells *cells, struct orl_slice line);
bool orl_cells_next(struct orl_cells *cells, struct orl_slice *ret_cell);

/* ---- Numbers --------------------------------------------------------------------------------- */

/* Returns true for a number with a decimal comma, as "0,5" or "1,5e3". */
bool orl_slice_is_decimal_comma(struct orl_slice slice);

/* Reads a slice as a finite number. `what` names it in messages ("the hour"), or is NULL. Errors:
 * ORL_ERR_SYNTAX for other text, a decimal comma and an empty slice; ORL_ERR_RANGE for "nan", "inf"
 * and numbers beyond a double's range. */
int orl_scanner_number(const struct orl_scanner *scanner, struct orl_slice slice, const char *what,
                       double *ret_value, struct orl_error *err);

/* ---- Messages -------------------------------------------------------------------------------- */

/* Returns the column of a slice that begins in the current line, 0 for one in another line. */
size_t orl_scanner_column(const struct orl_scanner *scanner, struct orl_slice slice);

/* Fills err with a message about the current line; returns code. */
int orl_scanner_fail(const struct orl_scanner *scanner, int code, struct orl_error *err,
                     const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
