#include "base/phrase.h"

#include <stdarg.h>
#include <stdio.h>

void orl_phrase_add(struct orl_phrase *phrase, const char *format, ...)
{
    char *word = phrase->text[phrase->count];
    va_list args;
    va_start(args, format);
    vsnprintf(word, ORL_PHRASE_WORD_BYTES, format, args);
    va_end(args);
    phrase->words[phrase->count++] = word;
}
