/*
 * A '!' line cut into words and pipeline stages, by the rules a shell would use for plain words:
 * blanks separate, quotes join, a backslash keeps the next character. Anything that would need a
 * shell (redirection, ';', '&', '$', '`', wildcards) is refused: nothing is ever started. In what
 * generators (gen...) are told '*' is no wildcard, but multiplies.
 */
#ifndef ORL_SCENE_GENERATE_COMMAND_H
#define ORL_SCENE_GENERATE_COMMAND_H

#include <stddef.h>

#include <oriel/error.h>

enum { ORL_COMMAND_STAGES = 6 };

/* Stage s has words[start[s]] up to words[start[s + 1]]. */
struct orl_command {
    char **words;
    size_t n_words;
    size_t start[ORL_COMMAND_STAGES + 1];
    size_t n_stages;
    char *text; /* the words themselves, each NUL-terminated */
};

/* Fills command, which the caller passes to orl_command_done; ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT.
 */
int orl_command_split(struct orl_command *command, const char *line, struct orl_error *err);
void orl_command_done(struct orl_command *command);

#endif
