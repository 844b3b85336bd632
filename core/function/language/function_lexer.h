/* Tokenizer of definitions: numbers, names and single characters; comments are skipped. */
#ifndef ORL_FUNCTION_LANGUAGE_FUNCTION_LEXER_H
#define ORL_FUNCTION_LANGUAGE_FUNCTION_LEXER_H

#include <stddef.h>

#include <oriel/base/error.h>

enum orl_function_token {
    ORL_FUNCTION_TOKEN_END,
    ORL_FUNCTION_TOKEN_NUMBER,
    ORL_FUNCTION_TOKEN_NAME,
    ORL_FUNCTION_TOKEN_SIGN
};

/* Tokenizer state; borrows the text. One word is read ahead, in kind, word and number. */
struct orl_function_lexer {
    const char *text;
    size_t length, at;
    const char *file; /* for errors; "" if there is none */
    int line;
    enum orl_function_token kind;
    const char *word; /* not NUL-terminated */
    size_t word_length;
    double number;
};

/* Starts a text and reads its first word. */
int orl_function_lexer_begin(struct orl_function_lexer *lexer, const char *file, int line,
                             const char *text, size_t length, struct orl_error *err);
int orl_function_lexer_next(struct orl_function_lexer *lexer, struct orl_error *err);

/* Returns ORL_ERR_SYNTAX at the current word: "A is expected, not B". */
int orl_function_lexer_expected(const struct orl_function_lexer *lexer, const char *what,
                                struct orl_error *err);

#endif
