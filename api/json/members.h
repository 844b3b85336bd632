/*
 * Objects decoded by tables of their members, in the manner of GNU Taler's JSON specifications.
 *
 *     const struct orl_json_member members[] = {
 *         {"name", .text = &name, .longest = 60, .required = true},
 *         {"seconds", .real = &seconds, .least = 0, .most = INFINITY, .above = true},
 *         {"tone", .word = &tone, .words = tones},
 *         {"reference", .members = reference},
 *         {.name = "priority"},
 *         {0}};
 *     rc = orl_json_members(value, path, members, err);
 *
 * A row names a member and the destination of its value, whose field gives the type. A row without
 * a destination allows a member that is read elsewhere. Other members are errors. Rows are decoded
 * in order. An absent member leaves its destination unchanged, or is an error if required. A value
 * of a wrong type is an error. After a failure destinations may be partly filled in; the caller
 * owns them.
 *
 * Errors as in decode.h.
 */
#ifndef ORL_API_JSON_MEMBERS_H
#define ORL_API_JSON_MEMBERS_H

#include "json/decode.h"

/* Decodes a value (NULL: absent) into the destination of its row or list. */
typedef int orl_json_decoder(const json_t *value, const char *path, void *into,
                             struct orl_error *err);

/* An array of elements of one kind; the path of each is "<path>[<index>]". */
struct orl_json_list {
    void *items;   /* address of a pointer to the elements: zeroed, owned, never NULL on success */
    size_t *count; /* elements begun; the caller also frees a half-filled last one */
    size_t size;   /* bytes per element */
    size_t most;
    orl_json_decoder *each;
    const char *empty; /* error message for an empty list; NULL: empty lists are allowed */
};

struct orl_json_member {
    const char *name; /* NULL ends the table */
    bool required;
    double *real;
    double least, most; /* bounds of a number, inclusive; no bounds if both are equal */
    bool above, below;  /* true to exclude the least, or the most, itself */
    const char *bounds; /* message for values out of bounds; NULL: "it is from <least> to <most>" */
    uint64_t *whole;
    uint32_t *whole_32;
    int *whole_int;
    uint64_t from, to; /* inclusive bounds of a whole number */
    bool *flag;
    char **text; /* owned; not empty */
    size_t longest;
    void *word; /* an enum; set to the index in words, which end with NULL */
    const char *const *words;
    const struct orl_json_member *members; /* members of an object */
    const struct orl_json_list *list;
    orl_json_decoder *decode; /* other types; called with NULL if absent and required */
    void *into;
};

int orl_json_members(const json_t *value, const char *path, const struct orl_json_member *members,
                     struct orl_error *err);
/* Decodes a value into the row's destination; the row's name is ignored. */
int orl_json_value(const json_t *value, const char *path, const struct orl_json_member *member,
                   struct orl_error *err);
int orl_json_list(const json_t *value, const char *path, const struct orl_json_list *list,
                  struct orl_error *err);
/* Decodes at most `most` elements, all into the same destination. */
int orl_json_each(const json_t *value, const char *path, size_t most, orl_json_decoder *each,
                  void *into, struct orl_error *err);

/* The path of a member: "views[0]" and "width" give "views[0].width". Returns ret_path. */
const char *orl_json_path(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX]);

#endif
