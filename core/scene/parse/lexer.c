#include "scene/parse/primitive.h"

#include <stdlib.h>

#include <oriel/base/scanner.h>

void orl_lexer_init(struct orl_lexer *lexer, const char *file, const char *text, size_t size)
{
    struct orl_slice whole = {text ? text : "", size}; /* a command may write nothing */
    /* bytes that are not text are refused at the first of them */
    orl_text_trim(file, &whole, NULL);
    lexer->at = whole.text;
    lexer->end = whole.text + whole.length;
    lexer->file = file;
    lexer->line = 1;
    lexer->frozen = false;
}

static bool is_blank(char c)
{
    return orl_byte_kind_of(c) != ORL_BYTE_WORD;
}

static bool is_quote(char c)
{
    return c == '"' || c == '\'';
}

/* Steps over one character and counts lines. */
static void step(struct orl_lexer *lexer)
{
    const char c = *lexer->at++;
    const bool is_end = c == '\n' || (c == '\r' && (lexer->at == lexer->end || *lexer->at != '\n'));
    if (is_end && !lexer->frozen)
        lexer->line++;
}

static void skip_blanks(struct orl_lexer *lexer)
{
    while (lexer->at < lexer->end && is_blank(*lexer->at))
        step(lexer);
}

enum orl_next orl_lexer_next(struct orl_lexer *lexer)
{
    for (;;) {
        skip_blanks(lexer);
        if (lexer->at >= lexer->end)
            return ORL_NEXT_END;
        if (*lexer->at == '!')
            return ORL_NEXT_COMMAND;
        if (*lexer->at != '#')
            return ORL_NEXT_PRIMITIVE;
        lexer->at = orl_line_end(lexer->at, lexer->end);
    }
}

/* Returns true if `at`, after a command's '!', is the end of a line that no backslash continues. */
static bool ends_line(const struct orl_lexer *lexer, const char *at)
{
    if (*at == '\r') /* CR without LF */
        return (at + 1 == lexer->end || at[1] != '\n') && at[-1] != '\\';
    return *at == '\n' && at[-1] != '\\' &&
           !(at[-1] == '\r' && at - lexer->at > 1 && at[-2] == '\\');
}

static const char *command_end(const struct orl_lexer *lexer)
{
    const char *at = lexer->at;
    while (at < lexer->end && !ends_line(lexer, at))
        at++;
    return at;
}

char *orl_lexer_command(struct orl_lexer *lexer, struct orl_error *err)
{
    enum { COMMAND_BYTES = 1 << 16 };
    const char *end = command_end(lexer);
    const size_t size = (size_t)(end - lexer->at);
    char *copy;
    if (size > COMMAND_BYTES || !(copy = malloc(size + 1))) {
        orl_error_set(err, size > COMMAND_BYTES ? ORL_ERR_LIMIT : ORL_ERR_NOMEM,
                      "the command line is longer than %d bytes", COMMAND_BYTES);
        orl_error_at(err, lexer->file, lexer->line, NULL);
        return NULL;
    }
    char *to = copy;
    for (lexer->at++; lexer->at < end; step(lexer)) {
        const char c = *lexer->at;
        const bool joins =
            c == '\\' && end - lexer->at > 1 && (lexer->at[1] == '\n' || lexer->at[1] == '\r');
        *to++ = joins || is_blank(c) ? ' ' : c;
    }
    *to = '\0';
    return copy;
}

static int bad_word(const struct orl_lexer *lexer, int code, int line, struct orl_error *err,
                    const char *what)
{
    orl_error_set(err, code, "%s", what);
    orl_error_at(err, lexer->file, line, NULL);
    return code;
}

static int bad_byte(const struct orl_lexer *lexer, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "this is not text: it contains a byte 0x%02x",
                  (unsigned)(unsigned char)*lexer->at);
    orl_error_at(err, lexer->file, lexer->line, NULL);
    orl_error_hint(
        err, "scene files are plain text: save it as UTF-8; octrees and archives cannot be read");
    return ORL_ERR_SYNTAX;
}

/* Reads a word with quotes in it: drops them; blanks between them stay. */
static int quoted_word(struct orl_lexer *lexer, struct orl_word *word, struct orl_error *err)
{
    char quote = '\0';
    word->length = 0;
    for (; lexer->at < lexer->end; step(lexer)) {
        const char c = *lexer->at;
        if (quote ? c == quote : is_quote(c)) {
            quote = quote ? '\0' : c;
            continue;
        }
        if (!quote && is_blank(c))
            break;
        if (((unsigned char)c < ' ' && !is_blank(c)) || c == 0x7f)
            return bad_byte(lexer, err);
        if (word->length >= ORL_LIMIT_WORD_BYTES)
            return bad_word(lexer, ORL_ERR_LIMIT, word->line, err, "a quoted word is too long");
        lexer->scratch[word->length++] = c;
    }
    if (quote)
        return bad_word(lexer, ORL_ERR_SYNTAX, word->line, err, "a quote is never closed");
    word->text = lexer->scratch;
    return 1;
}

int orl_lexer_word(struct orl_lexer *lexer, struct orl_word *ret_word, struct orl_error *err)
{
    skip_blanks(lexer);
    struct orl_word word = {.line = lexer->line};
    const char *const start = lexer->at;
    for (; lexer->at < lexer->end && !is_blank(*lexer->at); lexer->at++) {
        const char c = *lexer->at;
        if (is_quote(c)) {
            lexer->at = start;
            const int result = quoted_word(lexer, &word, err);
            if (result == 1)
                *ret_word = word;
            return result;
        }
        if ((unsigned char)c < ' ' || c == 0x7f)
            return bad_byte(lexer, err);
    }
    word.text = start;
    word.length = (size_t)(lexer->at - start);
    if (word.length > ORL_LIMIT_WORD_BYTES)
        return bad_word(lexer, ORL_ERR_LIMIT, word.line, err, "a word is too long");
    if (word.length == 0)
        return 0;
    *ret_word = word;
    return 1;
}
