/*
 * Options that are members of a document: a command that makes the same of a document and of words
 * on its line turns the words into the document first, so that both are checked once.
 */
#ifndef ORL_CLIENT_WORDS_H
#define ORL_CLIENT_WORDS_H

#include <jansson.h>

#include "command.h"

enum { ORL_WORDS_MOST = 8 };

/* A member that an option of its name gives as it is. */
struct orl_choice {
    const char *name, *metavar, *help;
    bool is_text; /* else a number, where it is one */
};

/* Those of a command, and what the line says: NULL where it says nothing. Borrowed. */
struct orl_choices {
    const struct orl_choice *items;
    size_t count; /* at most ORL_WORDS_MOST */
    const char *texts[ORL_WORDS_MOST];
};

/* Fills as many options as there are words. */
void orl_words_options(struct orl_choices *words, struct orl_option *ret_options);
/* Into the document; not 0: out of memory, or text that is not UTF-8. What should be a number, and
 * is none, goes in as text, which is then refused by its member's name. */
int orl_words_into(const struct orl_choices *words, json_t *doc);
bool orl_words_any(const struct orl_choices *words);

/* Whether an operand is a document rather than what it would name: FILE.json. */
bool orl_names_document(const char *operand);

#endif
