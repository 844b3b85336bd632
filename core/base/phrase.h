/*
 * The words of a command in the making, as those who read commands take them.
 *
 * Errors: none; who makes a phrase knows how many words it gets at most, and that none is longer
 * than a number.
 */
#ifndef ORL_BASE_PHRASE_H
#define ORL_BASE_PHRASE_H

#include <stddef.h>

enum { ORL_PHRASE_WORDS = 32, ORL_PHRASE_WORD_BYTES = 40 };

struct orl_phrase {
    char text[ORL_PHRASE_WORDS][ORL_PHRASE_WORD_BYTES];
    const char *words[ORL_PHRASE_WORDS]; /* in text */
    size_t count;
};

/* Adds one word, printed. */
void orl_phrase_add(struct orl_phrase *phrase, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
