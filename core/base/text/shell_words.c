#include "base/text/shell_words.h"

#include <stdarg.h>
#include <stdio.h>

void orl_shell_words_add(struct orl_shell_words *shell_words, const char *format, ...)
{
    char *word = shell_words->text[shell_words->count];
    va_list args;
    va_start(args, format);
    vsnprintf(word, ORL_SHELL_WORD_BYTES, format, args);
    va_end(args);
    shell_words->words[shell_words->count++] = word;
}
