#include "scene/parse/primitive.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "base/memory/memory.h"
#include "base/text/words.h"

enum { HEAD_WORDS = 3 };

void orl_primitive_done(struct orl_primitive *primitive)
{
    free(primitive->reals);
    free(primitive->text);
    free(primitive->at);
    memset(primitive, 0, sizeof *primitive);
}

const char *orl_primitive_string(const struct orl_primitive *primitive, size_t i)
{
    return primitive->text + primitive->at[HEAD_WORDS + i];
}

/* Sets err with place and primitive; the head may be incomplete. */
static int fail(const struct orl_primitive *primitive, const struct orl_lexer *lexer, int line,
                struct orl_error *err, int code, const char *message, const char *word)
{
    char name[ORL_ERROR_NAME_MAX];
    snprintf(name, sizeof name, "%.100s %.100s", primitive->type, primitive->id);
    orl_error_set(err, code, "%s%s%.80s%s", message, word ? " '" : "", word ? word : "",
                  word ? "'" : "");
    orl_error_at(err, lexer->file, line, *primitive->type ? name : NULL);
    return code;
}

/* Updates the head's pointers, because text may have moved. */
static void update_head(struct orl_primitive *primitive)
{
    primitive->modifier = primitive->text + primitive->at[0];
    primitive->type = primitive->text + primitive->at[1];
    primitive->id = primitive->text + primitive->at[2];
}

/* Appends the word to the primitive's text as string number index. */
static int keep_string(struct orl_primitive *primitive, size_t index, const struct orl_word *word)
{
    if (!orl_array_reserve(&primitive->at, &primitive->at_room, index, sizeof *primitive->at) ||
        !orl_array_reserve_more(&primitive->text, &primitive->text_room, primitive->text_size,
                                word->length + 1, 1))
        return ORL_ERR_NOMEM;
    primitive->at[index] = primitive->text_size;
    memcpy(primitive->text + primitive->text_size, word->text, word->length);
    primitive->text_size += word->length;
    primitive->text[primitive->text_size++] = '\0';
    return 0;
}

int orl_primitive_read_head(struct orl_primitive *primitive, struct orl_lexer *lexer,
                            struct orl_error *err)
{
    static const char *const missing[HEAD_WORDS] = {
        "the text ends where a primitive should start",
        "the text ends after a modifier; a type and an identifier must follow",
        "the text ends after a type; an identifier must follow"};
    struct orl_word word;
    primitive->modifier = primitive->type = primitive->id = "";
    primitive->text_size = primitive->n_strings = primitive->n_reals = 0;
    for (size_t i = 0; i < HEAD_WORDS; i++) {
        const int result = orl_lexer_word(lexer, &word, err);
        if (result < 0)
            return result;
        if (result == 0)
            return fail(primitive, lexer, lexer->line, err, ORL_ERR_SYNTAX, missing[i], NULL);
        if (i == 0)
            primitive->line = word.line;
        if (keep_string(primitive, i, &word) < 0)
            return fail(primitive, lexer, word.line, err, ORL_ERR_NOMEM, "out of memory", NULL);
    }
    update_head(primitive);
    return 0;
}

static int next_word(struct orl_primitive *primitive, struct orl_lexer *lexer, const char *what,
                     struct orl_word *ret_word, struct orl_error *err)
{
    const int result = orl_lexer_word(lexer, ret_word, err);
    if (result == 1)
        return 0;
    if (result < 0) {
        struct orl_error cause = err ? *err : (struct orl_error){0};
        fail(primitive, lexer, cause.line, err, result, cause.message, NULL);
        orl_error_hint(err, "%s", cause.hint);
        return result;
    }
    return fail(primitive, lexer, lexer->line, err, ORL_ERR_SYNTAX, what, NULL);
}

static void copy_word(const struct orl_word *word, char text[81])
{
    snprintf(text, 81, "%.*s", (int)(word->length < 80 ? word->length : 80), word->text);
}

static int read_count(struct orl_primitive *primitive, struct orl_lexer *lexer, const char *what,
                      size_t *ret_count, struct orl_error *err)
{
    struct orl_word word;
    char text[81];
    int value = 0;
    int code = next_word(primitive, lexer, what, &word, err);
    if (code < 0)
        return code;
    copy_word(&word, text);
    const enum orl_number_fault fault = orl_number_read_int(word.text, word.length, &value);
    if (fault == ORL_NUMBER_INVALID || (fault == ORL_NUMBER_OK && value < 0)) {
        code = fail(primitive, lexer, word.line, err, ORL_ERR_SYNTAX, what, NULL);
        orl_error_hint(err,
                       "found '%s'; three counts are expected: of strings, of integers (always 0) "
                       "and of numbers, each before its arguments",
                       text);
        return code;
    }
    if (fault != ORL_NUMBER_OK || value > (int)ORL_LIMIT_ARGUMENTS)
        return fail(primitive, lexer, word.line, err, ORL_ERR_LIMIT, "too many arguments:", text);
    *ret_count = (size_t)value;
    return 0;
}

static int read_strings(struct orl_primitive *primitive, struct orl_lexer *lexer,
                        struct orl_error *err)
{
    struct orl_word word;
    for (size_t i = 0; i < primitive->n_strings; i++) {
        int code =
            next_word(primitive, lexer, "the text ends among the string arguments", &word, err);
        if (code < 0)
            return code;
        code = keep_string(primitive, HEAD_WORDS + i, &word);
        if (code < 0)
            return fail(primitive, lexer, word.line, err, code, "out of memory", NULL);
        update_head(primitive);
    }
    return 0;
}

static int read_reals(struct orl_primitive *primitive, struct orl_lexer *lexer,
                      struct orl_error *err)
{
    struct orl_word word;
    char text[81];
    if (!orl_array_reserve_more(&primitive->reals, &primitive->reals_room, 0, primitive->n_reals,
                                sizeof *primitive->reals))
        return fail(primitive, lexer, lexer->line, err, ORL_ERR_NOMEM, "out of memory", NULL);
    for (size_t i = 0; i < primitive->n_reals; i++) {
        const int code =
            next_word(primitive, lexer, "the text ends among the number arguments", &word, err);
        if (code < 0)
            return code;
        const enum orl_number_fault fault =
            orl_number_read(word.text, word.length, primitive->reals + i);
        if (fault == ORL_NUMBER_OK)
            continue;
        copy_word(&word, text);
        if (fault == ORL_NUMBER_INFINITE)
            return fail(primitive, lexer, word.line, err, ORL_ERR_RANGE,
                        "an argument is not a finite number:", text);
        fail(primitive, lexer, word.line, err, ORL_ERR_SYNTAX,
             "an argument is not a number:", text);
        orl_error_hint(err, "argument %zu of %zu; check the count before the numbers.%s", i + 1,
                       primitive->n_reals,
                       *text == '#' ? " Comments are allowed only between primitives." : "");
        if (orl_slice_is_decimal_comma((struct orl_slice){word.text, word.length}))
            orl_error_hint(err, "this is a decimal comma: write a point");
        return ORL_ERR_SYNTAX;
    }
    return 0;
}

int orl_primitive_read_arguments(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err)
{
    size_t n_integers = 0;
    int code = read_count(primitive, lexer, "the count of string arguments is missing",
                          &primitive->n_strings, err);
    if (code == 0)
        code = read_strings(primitive, lexer, err);
    if (code == 0)
        code = read_count(primitive, lexer, "the count of integer arguments is missing",
                          &n_integers, err);
    if (code == 0 && n_integers != 0)
        code = fail(primitive, lexer, lexer->line, err, ORL_ERR_SYNTAX,
                    "the count of integer arguments must be 0", NULL);
    if (code == 0)
        code = read_count(primitive, lexer, "the count of number arguments is missing",
                          &primitive->n_reals, err);
    if (code == 0)
        code = read_reals(primitive, lexer, err);
    return code;
}

int orl_primitive_read_reference(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err)
{
    primitive->n_strings = 1;
    return read_strings(primitive, lexer, err);
}

bool orl_primitive_set(struct orl_primitive *primitive, const char *const head[3],
                       const double *reals, size_t n_reals)
{
    if (!orl_array_reserve_more(&primitive->reals, &primitive->reals_room, 0, n_reals,
                                sizeof *primitive->reals))
        return false;
    primitive->modifier = head[0];
    primitive->type = head[1];
    primitive->id = head[2];
    primitive->n_strings = 0;
    primitive->n_reals = n_reals;
    memcpy(primitive->reals, reals, n_reals * sizeof *reals);
    return true;
}
