#include "function/definition_words.h"

#include <stdbool.h>
#include <string.h>

#include "base/number.h"

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_of_name(char c)
{
    return is_letter(c) || is_digit(c) || c == '_' || c == '.' || c == '`';
}

static int report_fault(const struct orl_function_words *words, int line, struct orl_error *err,
                        const char *message, const char *hint)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "%s", message);
    orl_error_at(err, words->file[0] ? words->file : NULL, line, NULL);
    orl_error_hint(err, "%s", hint);
    return ORL_ERR_SYNTAX;
}

/* Skips a comment, which may nest; the position is at its opening brace. */
static int skip_comment(struct orl_function_words *words, struct orl_error *err)
{
    const int began = words->line;
    size_t depth = 0;
    do {
        if (words->at == words->length)
            return report_fault(words, began, err, "a comment of a function file does not end",
                                "each { needs a }");
        const char c = words->text[words->at++];
        depth += c == '{';
        depth -= c == '}';
        words->line += c == '\n';
    } while (depth > 0);
    return 0;
}

static int skip_blanks(struct orl_function_words *words, struct orl_error *err)
{
    while (words->at < words->length) {
        const char c = words->text[words->at];
        if (c == '{') {
            const int code = skip_comment(words, err);
            if (code < 0)
                return code;
        } else if (is_blank(c)) {
            words->line += c == '\n';
            words->at++;
        } else {
            break;
        }
    }
    return 0;
}

static void take_digits(struct orl_function_words *words)
{
    while (words->at < words->length && is_digit(words->text[words->at]))
        words->at++;
}

static int take_number(struct orl_function_words *words, struct orl_error *err)
{
    const size_t begin = words->at;
    const char *const text = words->text;
    take_digits(words);
    if (words->at < words->length && text[words->at] == '.') {
        words->at++;
        take_digits(words);
    }
    if (words->at < words->length && (text[words->at] == 'e' || text[words->at] == 'E')) {
        words->at++;
        if (words->at < words->length && (text[words->at] == '+' || text[words->at] == '-'))
            words->at++;
        take_digits(words);
    }
    words->kind = ORL_WORD_NUMBER;
    words->word = text + begin;
    words->word_length = words->at - begin;
    if (orl_number_read(words->word, words->word_length, &words->number) != ORL_NUMBER_OK)
        return report_fault(words, words->line, err, "a number of a function file is not one",
                            "numbers are written like 12, .5 or 1.5e-3");
    return 0;
}

int orl_words_next(struct orl_function_words *words, struct orl_error *err)
{
    const int code = skip_blanks(words, err);
    if (code < 0)
        return code;
    const char *const text = words->text;
    const size_t begin = words->at;
    words->word = text + begin;
    words->word_length = 0;
    if (begin == words->length) {
        words->kind = ORL_WORD_END;
        return 0;
    }
    if (is_digit(text[begin]) || text[begin] == '.')
        return take_number(words, err);
    if (is_letter(text[begin]) || text[begin] == '`' || text[begin] == '$') {
        words->at++;
        while (words->at < words->length && is_of_name(text[words->at]))
            words->at++;
        words->kind = ORL_WORD_NAME;
    } else {
        words->at++;
        words->kind = ORL_WORD_SIGN;
    }
    words->word_length = words->at - begin;
    return 0;
}

int orl_words_begin(struct orl_function_words *words, const char *file, int line, const char *text,
                    size_t length, struct orl_error *err)
{
    memset(words, 0, sizeof *words);
    words->text = text;
    words->length = length;
    words->file = file ? file : "";
    words->line = line;
    return orl_words_next(words, err);
}

int orl_words_expected(const struct orl_function_words *words, const char *what,
                       struct orl_error *err)
{
    const int length = words->word_length < 64 ? (int)words->word_length : 64;
    if (words->kind == ORL_WORD_END)
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not the end of the text", what);
    else if (words->word[0] < ' ' || words->word[0] > '~') /* errors must be UTF-8 */
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not a byte of no meaning", what);
    else
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not '%.*s'", what, length, words->word);
    orl_error_at(err, words->file[0] ? words->file : NULL, words->line, NULL);
    orl_error_hint(err, "definitions are NAME = EXPRESSION; or NAME(A, B) = EXPRESSION;");
    return ORL_ERR_SYNTAX;
}
