#include "scene/generate/generate.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

void orl_command_done(struct orl_command *command)
{
    free(command->words);
    free(command->text);
    memset(command, 0, sizeof *command);
}

static bool is_blank(char c)
{
    return orl_byte_kind_of(c) != ORL_BYTE_WORD;
}

/* Returns true for characters that are never escaped: a backslash before one of them belongs to a
 * Windows path. */
static bool is_name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.';
}

static int refuse_character(struct orl_error *err, char c)
{
    return orl_error_refuse(
        err, ORL_ERR_UNSUPPORTED,
        "run it beforehand and include its output, or put quotes around the word",
        "the command needs a shell ('%c'), but shells are not supported", c);
}

/* Copies one word to *to without its quotes, and moves *line behind it. In a formula '*' is
 * allowed: a shell leaves it unchanged, because no file has such a name. */
static int copy_word(const char **line, char **to, bool formula, struct orl_error *err)
{
    const char *at = *line;
    char quote = '\0', *start = *to;
    for (; *at && (quote || (!is_blank(*at) && *at != '|')); at++) {
        if (quote ? *at == quote : *at == '"' || *at == '\'') {
            quote = quote ? '\0' : *at;
            continue;
        }
        if (quote != '\'' && strchr("$`", *at))
            return refuse_character(err, *at);
        if (!quote && !(formula && *at == '*') &&
            (strchr(";&<>*?[]{}()", *at) || (*to == start && *at == '~')))
            return refuse_character(err, *at);
        if (*at == '\\' && quote != '\'' && at[1] && !is_name_character(at[1]))
            at++;
        *(*to)++ = *at;
    }
    *(*to)++ = '\0';
    *line = at;
    if (quote)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a quote in the command is never closed");
    if (*to - start > (long)ORL_LIMIT_WORD_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "a word of the command is too long");
    return 0;
}

static int end_stage(struct orl_command *command, struct orl_error *err)
{
    if (command->n_words == command->start[command->n_stages])
        return orl_error_set(err, ORL_ERR_SYNTAX, "a command is missing");
    if (++command->n_stages >= ORL_COMMAND_STAGES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the pipeline has too many commands");
    command->start[command->n_stages] = command->n_words;
    return 0;
}

/* Generators take formulas; other commands take files. */
static bool is_generator(const struct orl_command *command)
{
    const size_t first = command->start[command->n_stages];
    return first < command->n_words && strncmp(command->words[first], "gen", 3) == 0;
}

int orl_command_split(struct orl_command *command, const char *line, struct orl_error *err)
{
    const size_t length = strlen(line);
    int code = 0;
    memset(command, 0, sizeof *command);
    /* Every word takes at least one character and a separator, "|" included. */
    command->text = malloc(2 * length + 2);
    command->words = malloc((length + 1) * sizeof *command->words);
    if (!command->text || !command->words) {
        orl_command_done(command);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    char *to = command->text;
    for (const char *at = line; code == 0;) {
        while (is_blank(*at))
            at++;
        if (*at == '\0' || *at == '#') /* a shell's comment: up to the end of the line */
            break;
        if (*at == '|') {
            code = end_stage(command, err);
            at++;
            continue;
        }
        const bool formula = is_generator(command);
        command->words[command->n_words++] = to;
        code = copy_word(&at, &to, formula, err);
    }
    if (code == 0)
        code = end_stage(command, err);
    if (code < 0)
        orl_command_done(command);
    return code;
}
