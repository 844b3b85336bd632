#include "function/language/definitions.h"

#include <stdbool.h>
#include <string.h>

#include "base/text/words.h"

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

static int report_fault(const struct orl_function_lexer *lexer, int line, struct orl_error *err,
                        const char *message, const char *hint)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "%s", message);
    orl_error_at(err, lexer->file[0] ? lexer->file : NULL, line, NULL);
    orl_error_hint(err, "%s", hint);
    return ORL_ERR_SYNTAX;
}

/* Skips a comment, which may nest; the position is at its opening brace. */
static int skip_comment(struct orl_function_lexer *lexer, struct orl_error *err)
{
    const int began = lexer->line;
    size_t depth = 0;
    do {
        if (lexer->at == lexer->length)
            return report_fault(lexer, began, err, "a comment of a function file is not closed",
                                "end each { with a }");
        const char c = lexer->text[lexer->at++];
        depth += c == '{';
        depth -= c == '}';
        lexer->line += c == '\n';
    } while (depth > 0);
    return 0;
}

static int skip_blanks(struct orl_function_lexer *lexer, struct orl_error *err)
{
    while (lexer->at < lexer->length) {
        const char c = lexer->text[lexer->at];
        if (c == '{') {
            const int code = skip_comment(lexer, err);
            if (code < 0)
                return code;
        } else if (is_blank(c)) {
            lexer->line += c == '\n';
            lexer->at++;
        } else {
            break;
        }
    }
    return 0;
}

static void take_digits(struct orl_function_lexer *lexer)
{
    while (lexer->at < lexer->length && is_digit(lexer->text[lexer->at]))
        lexer->at++;
}

static int take_number(struct orl_function_lexer *lexer, struct orl_error *err)
{
    const size_t begin = lexer->at;
    const char *const text = lexer->text;
    take_digits(lexer);
    if (lexer->at < lexer->length && text[lexer->at] == '.') {
        lexer->at++;
        take_digits(lexer);
    }
    if (lexer->at < lexer->length && (text[lexer->at] == 'e' || text[lexer->at] == 'E')) {
        lexer->at++;
        if (lexer->at < lexer->length && (text[lexer->at] == '+' || text[lexer->at] == '-'))
            lexer->at++;
        take_digits(lexer);
    }
    lexer->kind = ORL_FUNCTION_TOKEN_NUMBER;
    lexer->word = text + begin;
    lexer->word_length = lexer->at - begin;
    if (orl_number_read(lexer->word, lexer->word_length, &lexer->number) != ORL_NUMBER_OK)
        return report_fault(lexer, lexer->line, err, "a number of a function file is invalid",
                            "write numbers like 12, .5 or 1.5e-3");
    return 0;
}

int orl_function_lexer_next(struct orl_function_lexer *lexer, struct orl_error *err)
{
    const int code = skip_blanks(lexer, err);
    if (code < 0)
        return code;
    const char *const text = lexer->text;
    const size_t begin = lexer->at;
    lexer->word = text + begin;
    lexer->word_length = 0;
    if (begin == lexer->length) {
        lexer->kind = ORL_FUNCTION_TOKEN_END;
        return 0;
    }
    if (is_digit(text[begin]) || text[begin] == '.')
        return take_number(lexer, err);
    if (is_letter(text[begin]) || text[begin] == '`' || text[begin] == '$') {
        lexer->at++;
        while (lexer->at < lexer->length && is_of_name(text[lexer->at]))
            lexer->at++;
        lexer->kind = ORL_FUNCTION_TOKEN_NAME;
    } else {
        lexer->at++;
        lexer->kind = ORL_FUNCTION_TOKEN_SIGN;
    }
    lexer->word_length = lexer->at - begin;
    return 0;
}

int orl_function_lexer_begin(struct orl_function_lexer *lexer, const char *file, int line,
                             const char *text, size_t length, struct orl_error *err)
{
    memset(lexer, 0, sizeof *lexer);
    lexer->text = text;
    lexer->length = length;
    lexer->file = file ? file : "";
    lexer->line = line;
    return orl_function_lexer_next(lexer, err);
}

int orl_function_lexer_expected(const struct orl_function_lexer *lexer, const char *what,
                                struct orl_error *err)
{
    const int length = lexer->word_length < 64 ? (int)lexer->word_length : 64;
    if (lexer->kind == ORL_FUNCTION_TOKEN_END)
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not the end of the text", what);
    else if (lexer->word[0] < ' ' || lexer->word[0] > '~') /* errors must be UTF-8 */
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not an invalid character", what);
    else
        orl_error_set(err, ORL_ERR_SYNTAX, "%s is expected, not '%.*s'", what, length, lexer->word);
    orl_error_at(err, lexer->file[0] ? lexer->file : NULL, lexer->line, NULL);
    orl_error_hint(err, "write definitions as NAME = EXPRESSION; or NAME(A, B) = EXPRESSION;");
    return ORL_ERR_SYNTAX;
}
