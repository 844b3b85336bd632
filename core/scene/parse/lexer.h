/*
 * Splits Radiance scene text into words: blanks separate, quotes (' or ") join, '#' starts a
 * comment and '!' a command where a primitive could start. The text is a buffer with a size, need
 * not end in NUL, and is not changed. Line numbers are 1-based.
 *
 * Ownership: a word points into the text, or into the lexer's scratch if it was quoted; it is valid
 * until the next word is read. Errors have file and line set.
 * Reference: "The RADIANCE 6.0 Synthetic Imaging System", section 2, Scene Description.
 */
#ifndef ORL_SCENE_PARSE_LEXER_H
#define ORL_SCENE_PARSE_LEXER_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/limits.h>

struct orl_lexer {
    const char *at, *end;
    const char *file; /* for messages; borrowed */
    int line;         /* line of the next word */
    bool frozen;      /* text from a command: every word has the command's line */
    char scratch[ORL_LIMIT_WORD_BYTES + 1];
};

struct orl_word {
    const char *text;
    size_t length;
    int line;
};

enum orl_next { ORL_NEXT_END, ORL_NEXT_COMMAND, ORL_NEXT_PRIMITIVE };

void orl_lexer_init(struct orl_lexer *lexer, const char *file, const char *text, size_t size);

/* Skips blanks and comments between primitives and returns what follows. */
enum orl_next orl_lexer_next(struct orl_lexer *lexer);

/*
 * After ORL_NEXT_COMMAND: returns the command without its '!', to the end of the line, with lines
 * that end in a backslash joined. Returns an owned string, or NULL with err filled.
 */
char *orl_lexer_command(struct orl_lexer *lexer, struct orl_error *err);

/* Reads the next word. Returns 1, 0 at the end of the text, or a negative orl_err. */
int orl_lexer_word(struct orl_lexer *lexer, struct orl_word *ret_word, struct orl_error *err);

#endif
