/*
 * Splits a '!' line into words and pipeline stages, by a shell's rules for plain words: blanks
 * separate, quotes join, a backslash keeps the next character. Anything that would need a shell
 * (redirection, ';', '&', '$', '`', wildcards) is refused: no program is ever started. In the
 * arguments of generators (gen...) '*' is multiplication, not a wildcard.
 */
#ifndef ORL_SCENE_GENERATE_COMMAND_H
#define ORL_SCENE_GENERATE_COMMAND_H

#include <stddef.h>

#include <oriel/base/error.h>

enum { ORL_COMMAND_STAGES = 6 };

/* Stage s has words[start[s]] up to, not including, words[start[s + 1]]. */
struct orl_command {
    char **words;
    size_t n_words;
    size_t start[ORL_COMMAND_STAGES + 1];
    size_t n_stages;
    char *text; /* storage of the words, each NUL-terminated */
};

/* Fills command, which the caller passes to orl_command_done. Returns 0, ORL_ERR_SYNTAX,
 * _UNSUPPORTED or _LIMIT. */
int orl_command_split(struct orl_command *command, const char *line, struct orl_error *err);
void orl_command_done(struct orl_command *command);

#endif
