/*
 * Builds the words of a command, in the form that command readers take.
 *
 * Errors: none. The caller ensures that there are at most ORL_PHRASE_WORDS words, each no longer
 * than a number.
 */
#ifndef ORL_BASE_PHRASE_H
#define ORL_BASE_PHRASE_H

#include <stddef.h>

enum { ORL_PHRASE_WORDS = 32, ORL_PHRASE_WORD_BYTES = 40 };

struct orl_phrase {
    char text[ORL_PHRASE_WORDS][ORL_PHRASE_WORD_BYTES];
    const char *words[ORL_PHRASE_WORDS]; /* pointers into text */
    size_t count;
};

/* Adds one word, formatted as by printf. */
void orl_phrase_add(struct orl_phrase *phrase, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
