/*
 * Options that are members of a document. A command that accepts either a document or options
 * turns the options into a document first, so that both are checked by the same code.
 */
#ifndef ORL_CLIENT_OPTIONS_DOCUMENT_OPTIONS_H
#define ORL_CLIENT_OPTIONS_DOCUMENT_OPTIONS_H

#include <jansson.h>

#include "options/command.h"

enum { ORL_MEMBER_OPTIONS_MAX = 8 };

/* A member of the document, set by an option of its name. */
struct orl_member_option {
    const char *name, *metavar, *help;
    bool is_text; /* true: a string; false: a number, if it is one */
};

/* Members of a command, and their values on the line, NULL if absent. Borrowed. */
struct orl_member_options {
    const struct orl_member_option *items;
    size_t count; /* at most ORL_MEMBER_OPTIONS_MAX */
    const char *texts[ORL_MEMBER_OPTIONS_MAX];
};

/* Fills in one option per member. */
void orl_member_options_fill(struct orl_member_options *member_options,
                             struct orl_option *ret_options);
/* Sets the members in doc. Returns nonzero when out of memory or if text is not UTF-8. A value
 * that should be a number but is none is added as text, so that the decoder refuses it by name. */
int orl_member_options_apply(const struct orl_member_options *member_options, json_t *doc);
bool orl_member_options_any(const struct orl_member_options *member_options);

/* Returns true if an operand is a document: FILE.json. */
bool orl_is_document_name(const char *operand);

#endif
