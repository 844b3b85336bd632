/*
 * Builds the words of a command, in the form that command readers take.
 *
 * Errors: none. The caller ensures that there are at most ORL_SHELL_WORDS_MAX words, each no longer
 * than a number.
 */
#ifndef ORL_BASE_TEXT_SHELL_WORDS_H
#define ORL_BASE_TEXT_SHELL_WORDS_H

#include <stddef.h>

enum { ORL_SHELL_WORDS_MAX = 32, ORL_SHELL_WORD_BYTES = 40 };

struct orl_shell_words {
    char text[ORL_SHELL_WORDS_MAX][ORL_SHELL_WORD_BYTES];
    const char *words[ORL_SHELL_WORDS_MAX]; /* pointers into text */
    size_t count;
};

/* Adds one word, formatted as by printf. */
void orl_shell_words_add(struct orl_shell_words *shell_words, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
