/*
 * What a client calls its job by, of any kind: "name", 1 to 100 characters, and "tags", up to 16
 * different ones of 1 to 64. They say nothing of what is computed. No control characters; a tag has
 * no quotation mark, backslash or comma either, so that it stands in lists as it is.
 *
 * Rules and errors as in decode.h.
 */
#ifndef ORL_API_LABELS_JSON_H
#define ORL_API_LABELS_JSON_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/error.h>

enum { ORL_LABEL_NAME = 100, ORL_LABEL_TAGS = 16, ORL_LABEL_TAG = 64 };

struct orl_labels {
    char *name; /* owned; NULL: none */
    char *tags; /* a JSON array as text, owned; NULL: none */
};

void orl_labels_done(struct orl_labels *labels); /* NULL is fine */

/* From the document of a job, the members "name" and "tags" of it. */
int orl_labels_from_json(const json_t *doc, struct orl_labels *ret_labels, struct orl_error *err);

/* Is it a tag? Characters are those of UTF-8. */
bool orl_label_is_tag(const char *text);
/* Is it one of those (of orl_labels; NULL: none)? */
bool orl_labels_have(const char *tags, const char *tag);

#endif
