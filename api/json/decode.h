/*
 * Decodes JSON: single values, with errors that name the JSON path, and objects by tables of their
 * members.
 *
 * Every function takes the value (NULL if the member is absent) and its path, such as
 * "views[2].width", for messages. It returns 0 or a negative orl_err with err filled in;
 * orl_error.primitive is the path. Outputs are untouched on failure.
 */
#ifndef ORL_API_JSON_DECODE_H
#define ORL_API_JSON_DECODE_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "json/json_schema.h"

enum { ORL_JSON_PATH_MAX = 192 };

/*
 * Parses text and refuses duplicate members. An error is ORL_ERR_SYNTAX with the line and name
 * (the file's, or NULL). *ret_doc is a new reference.
 */
int orl_json_parse(const char *name, const char *text, size_t size, json_t **ret_doc,
                   struct orl_error *err);

/*
 * Sets the flag that cancels JSON reading in this thread: parsing and decoding of lists end with
 * ORL_ERR_CANCELLED soon after *cancel is set. NULL, the default, disables this. Borrows cancel
 * until the next call.
 */
void orl_json_set_cancel(const atomic_bool *cancel);

/* Fails unless value is an array of at most max elements. */
int orl_json_array(const json_t *value, const char *path, size_t max, struct orl_error *err);
/* Decodes a whole number in [min, max]; 2e6 counts as whole. */
int orl_json_whole(const json_t *value, const char *path, uint64_t min, uint64_t max,
                   uint64_t *ret_value, struct orl_error *err);
int orl_json_real(const json_t *value, const char *path, double *ret_value, struct orl_error *err);
/* Decodes a non-empty string of at most max bytes without NUL; *ret_text is owned (free()). */
int orl_json_string(const json_t *value, const char *path, size_t max, char **ret_text,
                    struct orl_error *err);
/* Hands an owned text over to *ret_text if rc is 0; otherwise, or if ret_text is NULL, frees it.
 * Returns rc. */
int orl_json_return_text(char *text, char **ret_text, int rc);
/* Decodes one of the words; words ends with NULL. ret_index points to an enum, which is set to the
 * word's index. */
int orl_json_word(const json_t *value, const char *path, const char *const *words, void *ret_index,
                  struct orl_error *err);

/* Fails with "<wanted> is expected here, not <what value is>". */
int orl_json_wrong_type(const json_t *value, const char *path, const char *wanted,
                        struct orl_error *err);
/* Fails with code at path; the message is "<path>: <what>". */
int orl_json_fail(struct orl_error *err, int code, const char *path, const char *what, ...)
    __attribute__((format(printf, 4, 5)));

/*
 * Objects decoded by tables of their members, in the manner of GNU Taler's JSON specifications. The
 * tables name the destinations; bounds, words and required members are those of the description
 * (json/json_schema.h).
 *
 *     const struct orl_json_member members[] = {
 *         {"name", .text = &name},
 *         {"seconds", .real = &seconds},
 *         {"tone", .word = &tone},
 *         {"reference", .members = reference},
 *         {.name = "priority"},
 *         {0}};
 *     rc = orl_json_members(value, path, &orl_schema_display, members, err);
 *
 * A row names a member and the destination of its value, whose field gives the type. A row without
 * a destination allows a member that is read elsewhere. Other members are errors. Rows are decoded
 * in order. An absent member leaves its destination unchanged, or is an error if required. A value
 * of a wrong type is an error. After a failure destinations may be partly filled in; the caller
 * owns them. A row that the description lacks is ORL_ERR_INTERNAL, whatever the value.
 */

/* Decodes a value (NULL: absent) into the destination of its row or list. */
typedef int orl_json_decoder(const json_t *value, const char *path, void *into,
                             struct orl_error *err);

/* An array of elements of one kind; the path of each is "<path>[<index>]". */
struct orl_json_list {
    void *items;   /* address of a pointer to the elements: zeroed, owned, never NULL on success */
    size_t *count; /* elements begun; the caller also frees a half-filled last one */
    size_t size;   /* bytes per element */
    orl_json_decoder *each;
};

struct orl_json_member {
    const char *name; /* NULL ends the table */
    bool required;    /* true for a member that the description requires in some cases only */
    double *real;
    uint64_t *whole;
    uint32_t *whole_32;
    int *whole_int;
    bool *flag;
    char **text; /* owned; not empty */
    void *word;  /* an enum; set to the index in the description's words */
    const struct orl_json_member *members; /* members of an object */
    const struct orl_json_list *list;
    orl_json_decoder *decode; /* other types; called with NULL if absent and required */
    void *into;
};

int orl_json_members(const json_t *value, const char *path, const struct orl_json_schema *schema,
                     const struct orl_json_member *members, struct orl_error *err);
/* Decodes one member of an object, by one row; the other members are not looked at. */
int orl_json_member(const json_t *object, const char *path, const struct orl_json_schema *schema,
                    const struct orl_json_member *row, struct orl_error *err);
/* Decodes a value into the row's destination; the row's name is ignored. */
int orl_json_value(const json_t *value, const char *path, const struct orl_json_schema *schema,
                   const struct orl_json_member *member, struct orl_error *err);
/* Decodes an array, whose number of elements the description bounds. */
int orl_json_list(const json_t *value, const char *path, const struct orl_json_schema *schema,
                  const struct orl_json_list *list, struct orl_error *err);
/* Decodes all elements into the same destination. */
int orl_json_each(const json_t *value, const char *path, const struct orl_json_schema *schema,
                  orl_json_decoder *each, void *into, struct orl_error *err);
/* Fails unless value is an array with as many elements as the description allows. */
int orl_json_array_of(const json_t *value, const char *path, const struct orl_json_schema *schema,
                      struct orl_error *err);
/* Decodes a text that the description bounds; *ret_text is owned (free()). */
int orl_json_text_of(const json_t *value, const char *path, const struct orl_json_schema *schema,
                     char **ret_text, struct orl_error *err);

/* The path of a member: "views[0]" and "width" give "views[0].width". Returns ret_path. */
const char *orl_json_path(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX]);

#endif
