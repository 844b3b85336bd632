/*
 * Options that are members of a document. A command that accepts either a document or options
 * turns the options into a document first, so that both are checked by the same code.
 */
#ifndef ORL_CLIENT_DOCUMENT_OPTIONS_H
#define ORL_CLIENT_DOCUMENT_OPTIONS_H

#include <jansson.h>

#include "command.h"

enum { ORL_WORDS_MOST = 8 };

/* A member of the document, set by an option of its name. */
struct orl_choice {
    const char *name, *metavar, *help;
    bool is_text; /* true: a string; false: a number, if it is one */
};

/* Members of a command, and their values on the line, NULL if absent. Borrowed. */
struct orl_choices {
    const struct orl_choice *items;
    size_t count; /* at most ORL_WORDS_MOST */
    const char *texts[ORL_WORDS_MOST];
};

/* Fills in one option per member. */
void orl_words_options(struct orl_choices *words, struct orl_option *ret_options);
/* Sets the members in doc. Returns nonzero when out of memory or if text is not UTF-8. A value
 * that should be a number but is none is added as text, so that the decoder refuses it by name. */
int orl_words_into(const struct orl_choices *words, json_t *doc);
bool orl_words_any(const struct orl_choices *words);

/* Returns true if an operand is a document: FILE.json. */
bool orl_names_document(const char *operand);

#endif
