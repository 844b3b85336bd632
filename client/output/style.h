/*
 * Colours on terminals.
 *
 * A stream gets colours if it is a terminal, $TERM is set and is not "dumb", and $NO_COLOR is unset
 * or empty (no-color.org). Pipes and files get no escape codes.
 */
#ifndef ORL_CLIENT_OUTPUT_STYLE_H
#define ORL_CLIENT_OUTPUT_STYLE_H

#include <stdbool.h>
#include <stdio.h>

enum orl_style {
    ORL_STYLE_PLAIN,
    ORL_STYLE_HEADING, /* bold */
    ORL_STYLE_GOOD,    /* green */
    ORL_STYLE_WARNING, /* yellow */
    ORL_STYLE_BAD,     /* red */
    ORL_STYLE_ASIDE    /* dim */
};

/* Returns true if a line of the stream can be rewritten: a terminal that knows escape codes. */
bool orl_terminal_can_rewrite(FILE *to);
/* Returns the code that begins the style on the stream, or "". */
const char *orl_style_begin(FILE *to, enum orl_style style);
/* Returns the code that ends all styles on the stream, or "". */
const char *orl_style_end(FILE *to);
/* Returns the stream's width in columns: of its window, or 80. */
int orl_terminal_columns(FILE *to);

/* Returns the style of a verdict or state: "pass" and "succeeded" are good, "fail" and "failed" are
 * bad, "undecided" and "cancelled" are warnings. */
enum orl_style orl_style_of_word(const char *word);

#endif
