/*
 * Words of scene files and commands: numbers are read, and commands are built.
 *
 * Numbers have the form [+-]digits[.digits][e[+-]digits]. They are correctly rounded. Reading is
 * independent of the locale in the common case, and several times faster than strtod.
 */
#ifndef ORL_BASE_TEXT_WORDS_H
#define ORL_BASE_TEXT_WORDS_H

#include <stddef.h>

enum orl_number_fault {
    ORL_NUMBER_OK = 0,
    ORL_NUMBER_INVALID,  /* not of that form */
    ORL_NUMBER_INFINITE, /* "nan", "inf", or too large for a double */
};

/* Reads the whole word. ret_value is untouched unless the result is ORL_NUMBER_OK. */
enum orl_number_fault orl_number_read(const char *text, size_t length, double *ret_value);

/* Reads a decimal integer in [-2000000000, 2000000000]; larger ones give ORL_NUMBER_INFINITE. */
enum orl_number_fault orl_number_read_int(const char *text, size_t length, int *ret_value);

/*
 * Words of a command, in the form that command readers take. Errors: none. The caller ensures that
 * there are at most ORL_SHELL_WORDS_MAX words, each no longer than a number.
 */

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
