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
 * A row names a member and where its value goes, which says of what kind it is; a row without such
 * a place is of a member that is read elsewhere. No other members than the table's may be there.
 * Rows are decoded in their order. What is absent leaves its place alone, or is an error as a value
 * of a wrong type is. After a failure places may be filled in part: what they own is the caller's.
 *
 * Errors as in decode.h.
 */
#ifndef ORL_API_MEMBERS_H
#define ORL_API_MEMBERS_H

#include "decode.h"

/* Decodes a value (NULL: absent) into what the row or list is about. */
typedef int orl_json_decoder(const json_t *value, const char *path, void *into,
                             struct orl_error *err);

/* An array of elements of one kind, each decoded by itself with the path "<path>[<index>]". */
struct orl_json_list {
    void *items;   /* the address of a pointer to them: zeroed, owned, never NULL on success */
    size_t *count; /* of those begun: a half-filled one is to be freed, too */
    size_t size;   /* of one */
    size_t most;
    orl_json_decoder *each;
    const char *empty; /* the error of a list of none; NULL: it is none */
};

struct orl_json_member {
    const char *name; /* NULL ends the table */
    bool required;
    double *real;
    double least, most; /* of a number; equal: any. Past them is an error, and so is ... */
    bool above, below;  /* ... the least, or the most, itself */
    const char *bounds; /* the words of that error; NULL: "it is from <least> to <most>" */
    uint64_t *whole;
    uint32_t *whole_32;
    int *whole_int;
    uint64_t from, to; /* of a whole number */
    bool *flag;
    char **text; /* owned; not empty */
    size_t longest;
    void *word; /* of an enumeration: the place among words, which end with NULL */
    const char *const *words;
    const struct orl_json_member *members; /* of an object */
    const struct orl_json_list *list;
    orl_json_decoder *decode; /* whatever else; called for one that is absent where required */
    void *into;
};

int orl_json_members(const json_t *value, const char *path, const struct orl_json_member *members,
                     struct orl_error *err);
/* A value by what a row says of its kind; the name is not looked at. */
int orl_json_value(const json_t *value, const char *path, const struct orl_json_member *member,
                   struct orl_error *err);
int orl_json_list(const json_t *value, const char *path, const struct orl_json_list *list,
                  struct orl_error *err);
/* At most so many elements, all into the same. */
int orl_json_each(const json_t *value, const char *path, size_t most, orl_json_decoder *each,
                  void *into, struct orl_error *err);

/* The path of a member: "views[0]" and "width" give "views[0].width". Returns ret_path. */
const char *orl_json_path(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX]);

#endif
