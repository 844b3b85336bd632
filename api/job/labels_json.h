/*
 * Labels that a client gives a job of any kind: "name", 1 to 100 characters, and "tags", up to 16
 * different ones of 1 to 64 characters. They do not affect the computation. Neither has control
 * characters. A tag has no quotation mark, backslash or comma, so that lists need no escapes.
 *
 * Rules and errors as in decode.h.
 */
#ifndef ORL_API_JOB_LABELS_JSON_H
#define ORL_API_JOB_LABELS_JSON_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/base/error.h>

enum { ORL_LABEL_NAME = 100, ORL_LABEL_TAGS = 16, ORL_LABEL_TAG = 64 };

struct orl_labels {
    char *name; /* owned; NULL: none */
    char *tags; /* a JSON array as text, owned; NULL: none */
};

void orl_labels_done(struct orl_labels *labels); /* NULL is fine */

/* Decodes "name" and "tags" of a job's document. */
int orl_labels_from_json(const json_t *doc, struct orl_labels *ret_labels, struct orl_error *err);

/* Returns true if text is a valid tag. Length is counted in UTF-8 characters. */
bool orl_label_is_tag(const char *text);
/* Returns true if tags (of struct orl_labels; NULL: none) contains tag. */
bool orl_labels_have(const char *tags, const char *tag);

#endif
