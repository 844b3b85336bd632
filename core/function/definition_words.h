/* Tokenizer of definitions: numbers, names and single characters; comments are skipped. */
#ifndef ORL_FUNCTION_DEFINITION_WORDS_H
#define ORL_FUNCTION_DEFINITION_WORDS_H

#include <stddef.h>

#include <oriel/error.h>

enum orl_word_kind { ORL_WORD_END, ORL_WORD_NUMBER, ORL_WORD_NAME, ORL_WORD_SIGN };

/* Tokenizer state; borrows the text. One word is read ahead, in kind, word and number. */
struct orl_function_words {
    const char *text;
    size_t length, at;
    const char *file; /* for errors; "" if there is none */
    int line;
    enum orl_word_kind kind;
    const char *word; /* not NUL-terminated */
    size_t word_length;
    double number;
};

/* Starts a text and reads its first word. */
int orl_words_begin(struct orl_function_words *words, const char *file, int line, const char *text,
                    size_t length, struct orl_error *err);
int orl_words_next(struct orl_function_words *words, struct orl_error *err);

/* Returns ORL_ERR_SYNTAX at the current word: "A is expected, not B". */
int orl_words_expected(const struct orl_function_words *words, const char *what,
                       struct orl_error *err);

#endif
